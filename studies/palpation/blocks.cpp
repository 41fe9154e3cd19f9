// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "blocks.h"

#include <cmath>
#include <functional>

#include "palpate/probing/contact_equilibrium.h"
#include "palpate/probing/finite_element_specimen.h"
#include "test_surfaces.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr int kColumns = static_cast<int>(2 * kHalf / kColumn);
// [mm] from the upper side: the inclusion is the second layer.
const std::vector<double> kLayers{kTop, kTop + 4, kTop + 9, kTop + 16};
constexpr double kSoftShear = 0.02, kStiffShear = 0.2, kBulkOverShear = 20;  // [N/mm^2]

bool in_triangle(const Eigen::Vector2d& at) {
  const Eigen::Vector2d corners[] = {{-12, -9}, {12, -9}, {0, 13}};
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d side = corners[(k + 1) % 3] - corners[k], to = at - corners[k];
    if (side.x() * to.y() - side.y() * to.x() < 0) return false;
  }
  return true;
}

bool in_circle(const Eigen::Vector2d& at, double x, double y, double radius) {
  return (at - Eigen::Vector2d(x, y)).norm() <= radius;
}

InclusionBlock make_block(const std::string& name, int parts,
                          const std::function<int(const Eigen::Vector2d&)>& part_of) {
  InclusionBlock block{.name = name, .specimen = {}, .part = {}, .parts = parts};
  block.part.resize(kColumns, kColumns);
  std::vector<double> across;
  for (int i = 0; i <= kColumns; ++i) across.push_back(-kHalf + kColumn * i);
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j < kColumns; ++j)
      block.part(i, j) = part_of({across[static_cast<std::size_t>(i)] + kColumn / 2,
                                  across[static_cast<std::size_t>(j)] + kColumn / 2});
  }
  probing::DeformableBody body;
  body.mesh = probing::box_mesh(across, across, kLayers);
  for (std::size_t e = 0; e < body.mesh.regions.size(); ++e) {
    const auto corners = body.mesh.elements.col(static_cast<Eigen::Index>(e)).head<4>();
    const Vector3d middle = body.mesh.nodes(Eigen::all, Eigen::Vector4i(corners)).rowwise().mean();
    const bool inside = middle.z() > kLayers[1] && middle.z() < kLayers[2];
    body.mesh.regions[e] = inside && block.part_at(middle.x(), middle.y()) > 0 ? 1 : 0;
  }
  body.materials = {{.shear_modulus = kSoftShear, .bulk_modulus = kBulkOverShear * kSoftShear},
                    {.shear_modulus = kStiffShear, .bulk_modulus = kBulkOverShear * kStiffShear}};
  for (Eigen::Index n = 0; n < body.mesh.nodes.cols(); ++n) {
    if (body.mesh.nodes(2, n) == kLayers.back()) body.supported.push_back(static_cast<int>(n));
  }
  probing::FiniteElementSpecimenOptions options;
  options.contact.tip_radius = kTipRadius;
  block.specimen = probing::make_specimen(std::move(body), options);
  return block;
}

}  // namespace

int InclusionBlock::part_at(double x, double y) const {
  const double i = std::floor((x + kHalf) / kColumn), j = std::floor((y + kHalf) / kColumn);
  if (i < 0 || j < 0 || i >= kColumns || j >= kColumns) return 0;
  return part(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
}

Eigen::Matrix2Xd InclusionBlock::outline() const {
  constexpr double kStep = 0.5;
  std::vector<Eigen::Vector2d> points;
  const auto add_side = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& along) {
    for (double at = 0; at <= kColumn; at += kStep) points.emplace_back(from + at * along);
  };
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j < kColumns; ++j) {
      const Eigen::Vector2d corner(-kHalf + kColumn * i, -kHalf + kColumn * j);
      if (i > 0 && part(i, j) != part(i - 1, j)) add_side(corner, Eigen::Vector2d::UnitY());
      if (j > 0 && part(i, j) != part(i, j - 1)) add_side(corner, Eigen::Vector2d::UnitX());
    }
  }
  Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index k = 0; k < result.cols(); ++k)
    result.col(k) = points[static_cast<std::size_t>(k)];
  return result;
}

std::vector<InclusionBlock> inclusion_blocks() {
  std::vector<InclusionBlock> blocks;
  blocks.push_back(
      make_block("triangle", 1, [](const Eigen::Vector2d& at) { return in_triangle(at) ? 1 : 0; }));
  blocks.push_back(make_block("rectangle", 1, [](const Eigen::Vector2d& at) {
    return std::abs(at.x() - 2) <= 10 && std::abs(at.y() + 4) <= 4 ? 1 : 0;
  }));
  blocks.push_back(make_block(
      "circle", 1, [](const Eigen::Vector2d& at) { return in_circle(at, -4, 4, 8) ? 1 : 0; }));
  blocks.push_back(make_block("two circles", 2, [](const Eigen::Vector2d& at) {
    if (in_circle(at, -10, -6, 5)) return 1;
    return in_circle(at, 10, 6, 5) ? 2 : 0;
  }));
  return blocks;
}

geometry::TriangleMesh upper_side() {
  constexpr int kSquares = static_cast<int>(2 * kHalf) - 1;
  geometry::TriangleMesh mesh =
      geometry::test::height_field(kSquares, kSquares, 1, [](double, double) { return kTop; });
  mesh.vertices.topRows<2>().array() -= kHalf - 0.5;
  return mesh;
}

}  // namespace palpate::bench
