// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/deformed_shape.h"
#include "palpate/haptics/fit_surface_response.h"
#include "palpate/probing/finite_element_specimen.h"

namespace palpate::bench {
namespace {

constexpr double kSide = 60, kHeight = 20;  // [mm] of the block, held at its bottom
constexpr int kCells = 12;
constexpr double kTip = 4, kSpacing = 12;  // [mm]
constexpr int kUnseen = 40;
constexpr unsigned kShapeSeed = 1;

struct Shape {
  Eigen::Vector3d place, displacement;
  Eigen::Matrix3Xd vertices;
};

std::vector<double> divided(double from, double to, int cells) {
  std::vector<double> at;
  for (int i = 0; i <= cells; ++i) at.push_back(from + (to - from) * i / cells);
  return at;
}

// The upper side is that towards the camera, at z = 700 mm; a stiff inclusion is below one part.
probing::DeformableBody block() {
  probing::DeformableBody body;
  body.mesh =
      probing::box_mesh(divided(-kSide / 2, kSide / 2, kCells),
                        divided(-kSide / 2, kSide / 2, kCells), divided(700, 700 + kHeight, 4));
  body.materials = {{.shear_modulus = 0.02, .bulk_modulus = 0.4},
                    {.shear_modulus = 0.2, .bulk_modulus = 4}};
  for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k) middle += body.mesh.nodes.col(body.mesh.elements(k, e)) / 4;
    if (middle.x() > 5 && std::abs(middle.y()) < 15 && middle.z() > 708)
      body.mesh.regions[static_cast<std::size_t>(e)] = 1;
  }
  for (Eigen::Index n = 0; n < body.mesh.nodes.cols(); ++n)
    if (body.mesh.nodes(2, n) > 700 + kHeight - 1e-6) body.supported.push_back(static_cast<int>(n));
  return body;
}

class Solid {
 public:
  Solid()
      : solid_(block(), {.tip_radius = kTip}),
        surface_(probing::make_specimen(block(), {.contact = {.tip_radius = kTip}})->surface()) {
    std::map<std::tuple<double, double, double>, int> nodes;
    const Eigen::Matrix3Xd& rest = solid_.rest();
    for (Eigen::Index n = 0; n < rest.cols(); ++n)
      nodes[{rest(0, n), rest(1, n), rest(2, n)}] = static_cast<int>(n);
    for (const auto& v : surface_.vertices.colwise())
      nodes_.push_back(nodes.at({v.x(), v.y(), v.z()}));
  }

  [[nodiscard]] const geometry::TriangleMesh& surface() const { return surface_; }

  // The surface under forces at a place; those without equilibrium are left out.
  [[nodiscard]] std::vector<Shape> shapes(const Eigen::Vector3d& place,
                                          const std::vector<Eigen::Vector3d>& forces) const {
    const probing::ContactState touch = solid_.touch(place, Eigen::Vector3d::UnitZ());
    probing::ContactSeries series(solid_, touch);
    std::vector<Shape> shapes;
    for (const Eigen::Vector3d& force : forces) {
      const probing::ContactResult result = series.apply_force(force);
      if (result.stop != probing::ContactStop::converged) continue;
      shapes.push_back(
          {place, result.state.tip - touch.tip, result.state.positions(Eigen::all, nodes_)});
    }
    return shapes;
  }

 private:
  probing::ContactEquilibrium solid_;
  geometry::TriangleMesh surface_;
  std::vector<int> nodes_;
};

struct ShapeErrors {
  double squares = 0, gap = 0, count = 0;
  void add(const Eigen::Matrix3Xd& shown, const Shape& truth, const geometry::TriangleMesh& surface,
           const geometry::SurfacePoint& at) {
    squares += (shown - truth.vertices).colwise().squaredNorm().mean();
    const Eigen::Matrix3d corners = shown(Eigen::all, surface.triangles.col(at.triangle));
    gap += (corners * at.barycentric - truth.place - truth.displacement).norm();
    ++count;
  }
  void print(const char* name) const {
    fmt::print("| {} | {:.3f} | {:.2f} |\n", name, std::sqrt(squares / count), gap / count);
  }
};

// A model whose forces do not matter, of contacts on a grid.
haptics::Model grid_model(const geometry::TriangleMesh& surface) {
  probing::Acquisition acquisition;
  for (double y = -2 * kSpacing; y <= 2 * kSpacing; y += kSpacing) {
    for (double x = -2 * kSpacing; x <= 2 * kSpacing; x += kSpacing) {
      const auto id = static_cast<long long>(acquisition.contacts.size());
      acquisition.contacts.push_back({id, {x, y, 700}, {0, 0, -1}});
      for (long long k = 1; k <= 4; ++k) {
        probing::Sample sample;
        sample.id = 4 * id + k;
        sample.contact = id;
        sample.group = sample.id;
        sample.force = Eigen::Vector3d(0, 0, 0.4 * static_cast<double>(k));
        sample.a = sample.b =
            acquisition.contacts.back().position + Eigen::Vector3d(0, 0, static_cast<double>(k));
        acquisition.samples.push_back(sample);
      }
    }
  }
  return haptics::build_model(acquisition, surface).model;
}

}  // namespace

void measure_shapes() {
  const Solid solid;
  const haptics::Model model = grid_model(solid.surface());
  std::vector<Eigen::Vector3d> forces = {{0, 0, 0.5}, {0, 0, 1}, {0, 0, 1.5}, {0, 0, 2}};
  for (int k = 0; k < 4; ++k) {
    const double angle = 0.2 + k * std::numbers::pi / 2;
    forces.emplace_back(0.7 * std::cos(angle), 0.7 * std::sin(angle), 1.5);
  }
  std::vector<Shape> recorded;
  std::vector<std::size_t> contacts;
  for (std::size_t c = 0; c < model.contacts.size(); ++c) {
    for (Shape& shape : solid.shapes(model.contacts[c].position, forces)) {
      recorded.push_back(std::move(shape));
      contacts.push_back(c);
    }
  }
  std::mt19937 random(kShapeSeed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Shape> unseen;
  while (unseen.size() < kUnseen) {
    const double x = 24 * uniform(random), y = 24 * uniform(random);
    const double fx = 0.5 * uniform(random), fy = 0.5 * uniform(random);
    const std::vector<Shape> shape =
        solid.shapes({x, y, 700}, {{fx, fy, 1.2 + 0.8 * uniform(random)}});
    unseen.insert(unseen.end(), shape.begin(), shape.end());
  }

  const haptics::BlendedField field(model);
  fmt::print("{} vertices, {} contacts, {} recorded shapes, {} unseen ones\n\n",
             solid.surface().vertices.cols(), model.contacts.size(), recorded.size(),
             unseen.size());
  fmt::print("| shown | error: RMS [mm] | contact to tool: mean [mm] |\n|---|---|---|\n");
  ShapeErrors still, nearest, drawn;
  for (const Shape& truth : unseen) {
    const geometry::SurfacePoint at = field.surface().closest_point(truth.place).at;
    still.add(solid.surface().vertices, truth, solid.surface(), at);
    const auto near = std::ranges::min_element(recorded, {}, [&](const Shape& shape) {
      return (shape.place + shape.displacement - truth.place - truth.displacement).norm();
    });
    nearest.add(near->vertices, truth, solid.surface(), at);
    drawn.add(haptics::drawn_shape(solid.surface(), at, truth.displacement, {.tip = kTip}), truth,
              solid.surface(), at);
  }
  still.print("undeformed surface");
  nearest.print("nearest recorded surface (thesis 5.6.1)");
  drawn.print("drawn dent");
  for (const int nodes : {50, 200, 400}) {
    const haptics::SurfaceResponse response = haptics::fit_surface_response(
        model, recorded.size(),
        [&](std::size_t k) {
          return haptics::RecordedShape{contacts[k], recorded[k].displacement,
                                        recorded[k].vertices};
        },
        {.nodes = nodes});
    ShapeErrors ours;
    for (const Shape& truth : unseen) {
      const geometry::SurfacePoint at = field.surface().closest_point(truth.place).at;
      ours.add(haptics::measured_shape(solid.surface(), response, field.weights(at), at,
                                       truth.displacement, {.tip = kTip}),
               truth, solid.surface(), at);
    }
    ours.print(fmt::format("responses of {} nodes, {:.1f} kB a contact; recorded shapes: RMS "
                           "{:.3f}, largest {:.2f} mm",
                           response.responses.rows() / 9,
                           1e-3 * 2 * static_cast<double>(response.responses.rows()), response.rms,
                           response.largest)
                   .c_str());
  }
}

}  // namespace palpate::bench
