// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "specimen/finite_element_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/core/require.h"
#include "palpate/probing/finite_element_specimen.h"

namespace palpate::probing {
namespace {

using documents::DocumentMembers;
using documents::DocumentNode;
using Eigen::Vector3d;

constexpr double kTop = 700;         // [mm] from the camera to a block's upper side, a ball's top
constexpr double kOnSide = 1e-6;     // [of the extent] within which a node is on a side
constexpr int kMostCells = 200'000;  // of a grid: more do not fit into the memory of a computer

struct Extent {
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();
  bool contains(const Vector3d& point) const {
    return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  }
};

std::vector<DocumentNode> items_of(DocumentMembers& members, const char* list) {
  const auto found = members.find(list);
  return found ? found->items() : std::vector<DocumentNode>{};
}

void read_extent(DocumentMembers& members, Extent& extent) {
  const auto low = members.find("low"), high = members.find("high");
  if (!low || !high) members.object().fail("must have 'low' and 'high', corners of a box [mm]");
  extent = {low->vector(), high->vector()};
  if (!((extent.high - extent.low).array() > 0).all())
    high->refuse("a corner above 'low' in x, y and z");
}

void read_material(DocumentMembers& members, Hyperelastic& material) {
  constexpr double kBulkRatio = 20;  // of bulk to shear modulus, if only the latter is stated
  members.take("shear_modulus", material.shear_modulus, above(0).finite(), "N/mm^2");
  if (members.find("shear_modulus")) material.bulk_modulus = kBulkRatio * material.shear_modulus;
  members.take("bulk_modulus", material.bulk_modulus, above(0).finite(), "N/mm^2");
  members.take("mooney_share", material.mooney_share, at_least(0).at_most(1), "");
  members.object().checked([&] { check_hyperelastic(material); });
}

std::vector<double> divided(double from, double to, double cells) {
  std::vector<double> result;
  for (int i = 0; i <= static_cast<int>(cells); ++i)
    result.push_back(from + (to - from) * i / cells);
  return result;
}

FiniteElementMesh read_block(DocumentMembers& members) {
  Vector3d size(60, 60, 20), cells(10, 10, 3);
  members.take("size", size);
  members.take("cells", cells);
  const bool whole = (cells.array() >= 1).all() && (cells.array() == cells.array().floor()).all();
  if (!(size.array() > 0).all() || !size.allFinite())
    members.at("size").refuse("three lengths above 0 [mm]");
  if (!whole || !(cells.prod() <= kMostCells))
    members.at("cells").refuse("three whole numbers above 0, their product at most " +
                               std::to_string(kMostCells));
  return box_mesh(divided(-size.x() / 2, size.x() / 2, cells.x()),
                  divided(-size.y() / 2, size.y() / 2, cells.y()),
                  divided(kTop, kTop + size.z(), cells.z()));
}

FiniteElementMesh read_ball(DocumentMembers& members) {
  double radius = 30, cells = 8;
  members.take("radius", radius, above(0).finite(), "mm");
  members.take("cells", cells, at_least(2).at_most(std::cbrt(double{kMostCells})), "");
  if (std::fmod(cells, 2) != 0) members.at("cells").refuse("an even number");
  return ball_mesh({0, 0, kTop + radius}, radius, static_cast<int>(cells));
}

FiniteElementMesh read_mesh_file(DocumentMembers& members) {
  FiniteElementMesh mesh = read_gmsh(members.at("file").text());
  Vector3d offset = Vector3d::Zero();
  members.take("offset", offset);
  mesh.nodes.colwise() += offset;
  return mesh;
}

Vector3d centre_of(const FiniteElementMesh& mesh, Eigen::Index element) {
  Vector3d sum = Vector3d::Zero();
  for (int a = 0; a < 4; ++a) sum += mesh.nodes.col(mesh.elements(a, element));
  return sum / 4;
}

// Regions in the order of the list; later ones take elements from earlier ones.
void read_regions(DocumentMembers& members, DeformableBody& body, const Hyperelastic& common) {
  const std::vector<int> groups = body.mesh.regions;
  std::fill(body.mesh.regions.begin(), body.mesh.regions.end(), 0);
  body.materials = {common};
  for (const DocumentNode& node : items_of(members, "regions")) {
    DocumentMembers region(node);
    Hyperelastic material = common;
    read_material(region, material);
    const bool ball = region.find("radius").has_value(), group = region.find("group").has_value();
    Extent extent;
    Vector3d centre = Vector3d::Zero();
    double radius = 0, number = 0;
    if (group) {
      region.take("group", number, at_least(0).finite(), "");
    } else if (ball) {
      region.take("centre", centre);
      region.take("radius", radius, above(0).finite(), "mm");
    } else {
      read_extent(region, extent);
    }
    region.end();
    const int index = static_cast<int>(body.materials.size());
    int taken = 0;
    for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
      const Vector3d at = centre_of(body.mesh, e);
      const bool inside = group  ? groups[static_cast<std::size_t>(e)] == number
                          : ball ? (at - centre).norm() <= radius
                                 : extent.contains(at);
      if (!inside) continue;
      body.mesh.regions[static_cast<std::size_t>(e)] = index;
      ++taken;
    }
    if (taken == 0) node.fail("holds the middle of no element; enlarge it, or refine the mesh");
    body.materials.push_back(material);
  }
}

enum class SolidSide { left, back, top, right, front, bottom };
constexpr std::array kSides = {"left", "back", "top", "right", "front", "bottom"};

Extent side_extent(SolidSide side, const Extent& whole) {
  Extent extent = whole;
  const Vector3d slack = kOnSide * (whole.high - whole.low);
  extent.low -= slack;
  extent.high += slack;
  const int axis = static_cast<int>(side) % 3;
  if (side < SolidSide::right)
    extent.high[axis] = whole.low[axis] + slack[axis];
  else
    extent.low[axis] = whole.high[axis] - slack[axis];
  return extent;
}

void read_supports(DocumentMembers& members, const std::string& shape, DeformableBody& body) {
  const Extent whole{body.mesh.nodes.rowwise().minCoeff(), body.mesh.nodes.rowwise().maxCoeff()};
  std::vector<std::pair<Extent, Vector3d>> supports;
  const bool stated = members.find("supports").has_value();
  for (const DocumentNode& node : items_of(members, "supports")) {
    DocumentMembers support(node);
    Extent extent;
    Vector3d move = Vector3d::Zero();
    support.take("move", move);
    if (const auto side = support.find("side")) {
      extent = side_extent(static_cast<SolidSide>(side->choice(kSides)), whole);
    } else {
      read_extent(support, extent);
    }
    support.end();
    bool holds = false;
    for (Eigen::Index n = 0; n < body.mesh.nodes.cols(); ++n)
      holds |= extent.contains(body.mesh.nodes.col(n));
    if (!holds) node.fail("holds no node; enlarge it");
    supports.emplace_back(extent, move);
  }
  if (!stated && shape == "block")
    supports.emplace_back(side_extent(SolidSide::bottom, whole), Vector3d::Zero());
  if (!stated && shape == "ball") {
    constexpr double kHeld = 0.75;  // of the height, from above, is free
    Extent extent = whole;
    extent.low.z() += kHeld * (whole.high.z() - whole.low.z());
    supports.emplace_back(extent, Vector3d::Zero());
  }
  if (supports.empty())
    members.object().fail(R"(has no 'supports'; they must be such as [{"side": "bottom"}])");
  std::vector<Vector3d> moves;
  for (int n = 0; n < body.mesh.nodes.cols(); ++n) {
    for (const auto& [extent, move] : supports) {
      if (!extent.contains(body.mesh.nodes.col(n))) continue;
      body.supported.push_back(n);
      moves.push_back(move);
      break;
    }
  }
  body.support_moves.resize(3, static_cast<Eigen::Index>(moves.size()));
  for (std::size_t k = 0; k < moves.size(); ++k)
    body.support_moves.col(static_cast<Eigen::Index>(k)) = moves[k];
  if (body.support_moves.isZero(0)) body.support_moves.resize(3, 0);
}

}  // namespace

FiniteElementObject finite_elements_of(const DocumentNode& object) {
  DocumentMembers members(object);
  (void)members.find("type");
  const auto stated_shape = members.find("shape");
  const std::string shape = stated_shape ? stated_shape->text() : "block";
  FiniteElementObject result;
  DeformableBody& body = result.body;
  if (shape == "block") {
    body.mesh = read_block(members);
  } else if (shape == "ball") {
    body.mesh = read_ball(members);
  } else if (shape == "mesh") {
    body.mesh = read_mesh_file(members);
    result.mesh_file = members.at("file").text();
  } else {
    stated_shape->refuse("\"block\", \"ball\" or \"mesh\"");
  }
  object.checked([&] { check_finite_element_mesh(body.mesh); });
  Hyperelastic common;
  read_material(members, common);
  read_regions(members, body, common);
  read_supports(members, shape, body);
  for (const DocumentNode& node : items_of(members, "obstacles")) {
    DocumentMembers listed(node);
    Extent extent;
    read_extent(listed, extent);
    RigidBlock block{extent.low, extent.high};
    listed.take("rounding", block.rounding,
                above(0).at_most((extent.high - extent.low).minCoeff() / 2), "mm");
    listed.end();
    body.obstacles.push_back(block);
  }
  FiniteElementSpecimenOptions& options = result.options;
  members.take("friction", options.friction, at_least(0).finite(), "");
  members.take("microslip", options.microslip);
  members.take("tip_radius", options.contact.tip_radius, above(0).finite(), "mm");
  members.take("load_steps", options.contact.load_steps, at_least(1).at_most(1000));
  (void)members.find("identified");  // of `identify`: where the material comes from
  members.end();
  return result;
}

}  // namespace palpate::probing
