// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/deformed_shape.h"

#include <algorithm>
#include <string>

#include "palpate/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/require.h"

namespace palpate::haptics {
namespace {

// Least share of a gap that the corners of a triangle close; on coarser meshes a gap stays.
constexpr double kLeastShare = 0.25;

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

Eigen::VectorXd distances_from(const geometry::TriangleMesh& surface,
                               const geometry::SurfacePoint& contact, double radius) {
  return geometry::geodesic_distance(surface, {&contact, 1}, {.stop_radius = radius}).distance;
}

// How each node moves.
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

}  // namespace

Eigen::Matrix3Xd drawn_shape(const geometry::TriangleMesh& surface,
                             const geometry::SurfacePoint& contact,
                             const Eigen::Vector3d& displacement,
                             const DrawnShapeOptions& options) {
  check(options);
  Eigen::Matrix3Xd shape = surface.vertices;
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

Eigen::Matrix3Xd measured_shape(const geometry::TriangleMesh& surface,
                                const SurfaceResponse& response,
                                const geometry::ContactWeights& weights,
                                const geometry::SurfacePoint& contact,
                                const Eigen::Vector3d& displacement,
                                const DrawnShapeOptions& options) {
  if (response.nodes.cols() != surface.vertices.cols()) {
    throw InvalidInput("measured_shape(): the response is of " +
                       std::to_string(response.nodes.cols()) + " vertices; the surface has " +
                       std::to_string(surface.vertices.cols()));
  }
  check(options);
  Eigen::Matrix3Xd shape = surface.vertices;
  if (!displacement.allFinite() || displacement.isZero(0)) return shape;
  const Eigen::Matrix3Xd moves = node_moves(response, weights, displacement);
  const auto moved_by_nodes = [&](Eigen::Index v) {
    Eigen::Vector3d move = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k)
      move += static_cast<double>(response.weights(k, v)) * moves.col(response.nodes(k, v));
    return move;
  };
  const auto dent = [&](double distance) {
    double sum = 0;
    for (int k = 0; k < weights.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      sum += weights.weights[i] * dent_at(response, weights.contacts[i], distance);
    }
    return sum;
  };
  Eigen::VectorXd distances = distances_from(surface, contact, response.reach);
  for (Eigen::Index v = 0; v < shape.cols(); ++v)
    shape.col(v) += moved_by_nodes(v) + dent(distances[v]) * displacement;

  // The displayed place lies between the corners of its triangle, which follow the dent less than
  // the place itself.
  const Eigen::Vector3i corners = surface.triangles.col(contact.triangle);
  const Eigen::Vector3d place = surface.vertices(Eigen::all, corners) * contact.barycentric;
  const Eigen::Vector3d gap =
      place + displacement - shape(Eigen::all, corners) * contact.barycentric;
  const double radius = dent_radius(options, gap);
  if (radius > response.reach) distances = distances_from(surface, contact, radius);
  const auto closing = [&](Eigen::Index v) { return drawn_dent(distances[v], radius); };
  double share = 0;
  for (int k = 0; k < 3; ++k) share += contact.barycentric[k] * closing(corners[k]);
  const Eigen::Vector3d move = gap / std::max(share, kLeastShare);
  for (Eigen::Index v = 0; v < shape.cols(); ++v) shape.col(v) += closing(v) * move;
  return shape;
}

Eigen::Matrix3Xd displayed_shape(const Model& model, const BlendedField& field,
                                 const LoopState& state) {
  if (state.contact_state == ContactState::free) return model.surface.vertices;
  const geometry::SurfacePoint& at = state.proxy.at;
  const Eigen::Vector3d displacement = state.tool - state.proxy.position;
  const DrawnShapeOptions options = shape_options(model);
  if (!model.response) return drawn_shape(model.surface, at, displacement, options);
  return measured_shape(model.surface, *model.response, field.weights(at), at, displacement,
                        options);
}

}  // namespace palpate::haptics
