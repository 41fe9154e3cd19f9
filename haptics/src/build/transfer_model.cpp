// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/transfer_model.h"

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "build/forget_samples.h"
#include "build/interpolated_as.h"
#include "build/surface_refinement.h"
#include "palpate/core/error.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/rotation.h"
#include "palpate/haptics/rounding.h"
#include "palpate/haptics/transform_field.h"

namespace palpate::haptics {
namespace {

using geometry::SurfaceMap;
using geometry::SurfacePoint;

void check_map(const Model& model, const SurfaceMap& map) {
  if (map.positions.cols() != model.surface.vertices.cols() ||
      map.folded.size() != model.surface.triangles.cols()) {
    throw InvalidInput("transfer_model(): the map is of a surface of " +
                       std::to_string(map.positions.cols()) + " vertices and " +
                       std::to_string(map.folded.size()) + " triangles, that of the model has " +
                       std::to_string(model.surface.vertices.cols()) + " and " +
                       std::to_string(model.surface.triangles.cols()));
  }
  if (map.verdict == geometry::SurfaceMapVerdict::not_sensible)
    throw InvalidInput("transfer_model(): the map of the surfaces is not sensible: " + map.reason);
}

void turn(ContactModel& contact, const SurfacePoint& at, const Eigen::Vector3i& corners,
          const std::vector<Eigen::Matrix3d>& rotations) {
  std::array<Eigen::Matrix3d, 3> turns;
  std::array<double, 3> weights{};
  for (std::size_t c = 0; c < 3; ++c) {
    turns[c] = rotations[static_cast<std::size_t>(corners[static_cast<Eigen::Index>(c)])];
    weights[c] = at.barycentric[static_cast<Eigen::Index>(c)];
  }
  const Eigen::Matrix3d rotation = blend_rotations(turns, weights);
  contact.frame = rotation * contact.frame;
  contact.friction_axis = (rotation * contact.friction_axis).normalized();
}

void scale_forces(ContactModel& contact, double scale, ForceScaling forces) {
  if (forces == ForceScaling::feel) return;
  const double factor = forces == ForceScaling::material ? scale * scale * scale : scale;
  contact.field = transform_field(contact.field, scale * Eigen::Matrix3d::Identity(), factor).field;
  contact.rms *= factor / scale;
  if (contact.noise_floor) *contact.noise_floor *= factor / scale;
}

}  // namespace

TransferredModel transfer_model(const Model& model, const geometry::TriangleMesh& target,
                                const SurfaceMap& map, const TransferModelOptions& options) {
  check_model(model);
  check_map(model, map);
  const geometry::SurfaceQuery from(model.surface), to(target);
  const std::vector<Eigen::Matrix3d> rotations = geometry::local_rotations(model.surface, map);
  TransferredModel result{.model = model, .distorted = {}, .isolated = {}};
  result.model.surface = target;
  forget_samples(result.model);
  result.model.response.reset();  // it moves the vertices of the other surface
  const double size = geometry::bounding_diagonal(target);
  for (ContactModel& contact : result.model.contacts) {
    const SurfacePoint at = from.closest_point(contact.position).at;
    const Eigen::Vector3i corners = model.surface.triangles.col(at.triangle);
    const geometry::ClosestPoint image =
        to.closest_point(map.positions(Eigen::all, corners) * at.barycentric);
    contact.position = rounded_position(image.position, size);
    turn(contact, at, corners, rotations);
    scale_forces(contact, map.scale, options.forces);
    contact.compliance.reset();  // it belonged to the old surface
    contact.strength.reset();
    contact.uncertainty.reset();
    contact = rounded(std::move(contact));
    if (map.distorted[at.triangle]) result.distorted.push_back(contact.id);
  }
  Eigen::Matrix3Xd inward(3, static_cast<Eigen::Index>(model.contacts.size()));
  for (std::size_t i = 0; i < model.contacts.size(); ++i)
    inward.col(static_cast<Eigen::Index>(i)) = result.model.contacts[i].frame.col(2);
  const RefinedSurface refined = refine_surface(inward, result.model);
  geometry::ContactTriangulation triangulation = geometry::triangulate_contacts(
      result.model.surface, refined.places, {.method = model.triangulation});
  result.model.triangles = std::move(triangulation.mesh.triangles);
  result.model.surface_weights = std::move(triangulation.weights);
  for (const int i : triangulation.isolated)
    result.isolated.push_back(result.model.contacts[static_cast<std::size_t>(i)].id);
  if (result.model.probe_radius && options.forces != ForceScaling::feel)
    *result.model.probe_radius *= map.scale;
  std::string& before = result.model.made["transferred"];
  before += (before.empty() ? "" : "; ") + std::string("forces: ") + to_string(options.forces) +
            ", " + map.reason;
  // With `material`, the forces of pressing scale with the object.
  const double factor = options.forces == ForceScaling::material ? map.scale * map.scale : 1;
  result.model.friction_force *= factor;
  Interpolation as = result.model.interpolation;
  as.reference_force *= factor;
  if (options.forces != ForceScaling::feel) as.reference_depth *= map.scale;
  result.model = interpolated_as(std::move(result.model), as);
  return result;
}

}  // namespace palpate::haptics
