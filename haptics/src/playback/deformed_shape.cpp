// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/deformed_shape.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/geodesic_distance.h"

namespace palpate::haptics {
namespace {

// Least share of a gap that the corners of a triangle close; on coarser meshes a gap stays.
constexpr double kLeastMoveShare = 0.25;

void check(const DrawnShapeOptions& options) {
  require("DrawnShapeOptions::tip", options.tip, at_least(0).finite(), "mm");
  require("DrawnShapeOptions::reach", options.reach, above(0).finite());
}

double dent_radius(const DrawnShapeOptions& options, const Eigen::Vector3d& displacement) {
  return options.tip + options.reach * displacement.norm();
}

// Of the displacement of the contact, at a distance from it.
double drawn_dent(double distance, double radius) {
  const double s = distance / radius;
  return s < 1 ? (1 - s * s) * (1 - s * s) : 0;
}

Eigen::VectorXd distances_from(const geometry::GeodesicSurface& surface,
                               const geometry::SurfacePoint& contact, double radius) {
  return geometry::geodesic_distance(surface, {&contact, 1}, {.stop_radius = radius}).distance;
}

// Returns the motion of each node.
Eigen::Matrix3Xd node_moves(const SurfaceResponse& from, const geometry::ContactWeights& weights,
                            const Eigen::Vector3d& displacement) {
  const Eigen::Index nodes = from.responses.rows() / 9;
  Eigen::Matrix3Xd moves = Eigen::Matrix3Xd::Zero(3, nodes);
  for (int k = 0; k < weights.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const auto column = from.responses.col(weights.contacts[i]);
    for (Eigen::Index n = 0; n < nodes; ++n) {
      const Eigen::Matrix3d response =
          column.segment<9>(9 * n).cast<double>().reshaped(Eigen::fix<3>, Eigen::fix<3>);
      moves.col(n) += weights.weights[i] * (response * displacement);
    }
  }
  return moves;
}

// Moves each vertex with its nodes.
void add_node_moves(const SurfaceResponse& response, const Eigen::Matrix3Xd& moves,
                    Eigen::Matrix3Xd& shape) {
  for (Eigen::Index v = 0; v < shape.cols(); ++v) {
    Eigen::Vector3d move = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k)
      move += static_cast<double>(response.weights(k, v)) * moves.col(response.nodes(k, v));
    shape.col(v) += move;
  }
}

void check_vertices(const char* function, const SurfaceResponse& response,
                    const geometry::TriangleMesh& surface) {
  if (response.nodes.cols() == surface.vertices.cols()) return;
  throw InvalidInput(std::string(function) + ": the response is of " +
                     std::to_string(response.nodes.cols()) + " vertices; the surface has " +
                     std::to_string(surface.vertices.cols()));
}

// The recorded surface of a contact whose displaced contact was nearest to the tool; nullopt
// without any.
std::optional<Eigen::Index> nearest_of(const SurfaceResponse& response, Eigen::Index contact,
                                       const Eigen::Vector3d& displacement) {
  std::optional<Eigen::Index> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index s = 0; s < response.shape_contacts.size(); ++s) {
    if (response.shape_contacts[s] != contact) continue;
    const double distance = (response.displacements.col(s).cast<double>() - displacement).norm();
    if (distance >= least) continue;
    least = distance;
    nearest = s;
  }
  return nearest;
}

}  // namespace

Eigen::Matrix3Xd drawn_shape(const geometry::GeodesicSurface& surface,
                             const geometry::SurfacePoint& contact,
                             const Eigen::Vector3d& displacement,
                             const DrawnShapeOptions& options) {
  check(options);
  geometry::check_surface_point(surface.mesh(), contact, "drawn_shape(): contact");
  Eigen::Matrix3Xd shape = surface.mesh().vertices;
  if (!displacement.allFinite() || displacement.isZero(0)) return shape;
  const double radius = dent_radius(options, displacement);
  const Eigen::VectorXd distances = distances_from(surface, contact, radius);
  for (Eigen::Index v = 0; v < shape.cols(); ++v)
    shape.col(v) += drawn_dent(distances[v], radius) * displacement;
  return shape;
}

DrawnShapeOptions shape_options(const Model& model) {
  DrawnShapeOptions options;
  options.tip = model.probe_radius.value_or(options.tip);
  return options;
}

Eigen::Matrix3Xd measured_shape(const geometry::GeodesicSurface& surface,
                                const SurfaceResponse& response,
                                const geometry::ContactWeights& weights,
                                const geometry::SurfacePoint& contact,
                                const Eigen::Vector3d& displacement,
                                const DrawnShapeOptions& options) {
  check_vertices("measured_shape()", response, surface.mesh());
  check(options);
  Eigen::Matrix3Xd shape = surface.mesh().vertices;
  if (!displacement.allFinite() || displacement.isZero(0)) return shape;
  add_node_moves(response, node_moves(response, weights, displacement), shape);
  const auto dent = [&](double distance) {
    double sum = 0;
    for (int k = 0; k < weights.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      sum += weights.weights[i] * dent_at(response, weights.contacts[i], distance);
    }
    return sum;
  };
  Eigen::VectorXd distances = distances_from(surface, contact, response.reach);
  for (Eigen::Index v = 0; v < shape.cols(); ++v) shape.col(v) += dent(distances[v]) * displacement;

  // The displayed place lies between the corners of its triangle, which follow the dent less than
  // the place itself.
  const Eigen::Vector3i corners = surface.mesh().triangles.col(contact.triangle);
  const Eigen::Vector3d place = geometry::position(surface.mesh(), contact);
  const Eigen::Vector3d gap =
      place + displacement - shape(Eigen::all, corners) * contact.barycentric;
  const double radius = dent_radius(options, gap);
  if (radius > response.reach) distances = distances_from(surface, contact, radius);
  const auto closing = [&](Eigen::Index v) { return drawn_dent(distances[v], radius); };
  double share = 0;
  for (int k = 0; k < 3; ++k) share += contact.barycentric[k] * closing(corners[k]);
  const Eigen::Vector3d move = gap / std::max(share, kLeastMoveShare);
  for (Eigen::Index v = 0; v < shape.cols(); ++v) shape.col(v) += closing(v) * move;
  return shape;
}

Eigen::Matrix3Xd recorded_shape(const geometry::GeodesicSurface& surface,
                                const SurfaceResponse& response,
                                const geometry::SurfacePoint& contact, Eigen::Index shape) {
  check_vertices("recorded_shape()", response, surface.mesh());
  Eigen::Matrix3Xd vertices = surface.mesh().vertices;
  add_node_moves(response, response.moves.col(shape).cast<double>().reshaped(3, Eigen::AutoSize),
                 vertices);
  const Eigen::VectorXd distances = distances_from(surface, contact, response.reach);
  const Eigen::Vector3d displacement = response.displacements.col(shape).cast<double>();
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    vertices.col(v) +=
        dent_at(response, response.shape_contacts[shape], distances[v]) * displacement;
  }
  return vertices;
}

Eigen::Matrix3Xd nearest_shape(const Model& model, const geometry::GeodesicSurface& surface,
                               const geometry::SurfaceQuery& query,
                               const geometry::ContactWeights& weights,
                               const geometry::SurfacePoint& contact,
                               const Eigen::Vector3d& displacement) {
  const Eigen::Vector3d tool = geometry::position(surface.mesh(), contact) + displacement;
  auto left = weights.weights;
  for (int k = 0; k < weights.count; ++k) {
    const auto heaviest = static_cast<std::size_t>(
        std::max_element(left.begin(), left.begin() + weights.count) - left.begin());
    if (!(left[heaviest] > 0)) break;
    left[heaviest] = 0;
    const int nearby = weights.contacts[heaviest];
    const Eigen::Vector3d& position = model.contacts[static_cast<std::size_t>(nearby)].position;
    const auto shape = nearest_of(*model.response, nearby, tool - position);
    if (shape) {
      return recorded_shape(surface, *model.response, query.closest_point(position).at, *shape);
    }
  }
  return drawn_shape(surface, contact, displacement, shape_options(model));
}

Eigen::Matrix3Xd displayed_shape(const Model& model, const BlendedField& field,
                                 const geometry::GeodesicSurface& surface, const LoopState& state,
                                 ShapeRule rule) {
  if (state.contact_state == ContactState::free) return surface.mesh().vertices;
  const geometry::SurfacePoint& at = state.proxy.at;
  const Eigen::Vector3d displacement = state.tool - state.proxy.position;
  const DrawnShapeOptions options = shape_options(model);
  if (!model.response) return drawn_shape(surface, at, displacement, options);
  const geometry::ContactWeights weights = field.weights(at);
  if (rule == ShapeRule::nearest)
    return nearest_shape(model, surface, field.surface(), weights, at, displacement);
  return measured_shape(surface, *model.response, weights, at, displacement, options);
}

}  // namespace palpate::haptics
