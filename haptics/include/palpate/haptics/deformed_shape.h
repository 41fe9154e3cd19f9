// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/geodesic_surface.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/playback.h"

namespace palpate::haptics {

struct DrawnShapeOptions {
  /// [mm] >= 0 along the surface that follows the contact, as if under the tip.
  double tip = 3;
  double reach = 3;  ///< > 0, of the dent beyond the tip, in lengths of the displacement
};

/// The surface with one contact displaced, for pictures: DRAWN, NOT MEASURED. Each vertex moves by
/// the displacement times a smooth function of its distance d along the surface to the contact,
/// which is 1 at the contact and 0 from `tip + reach |displacement|` on:
///
///     (1 - s^2)^2    with s = d / (tip + reach |displacement|)
///
/// The shape is continuous in contact and displacement. Forces do not depend on it.
/// \param surface undeformed, V vertices; keep it from one picture to the next, since making it
/// takes longer than the dent. \param contact on it. \param displacement [mm] world
/// \return 3 x V [mm]; the undeformed vertices for a displacement that is zero or not finite.
/// \throws InvalidInput if the mesh is not valid, the contact is not on it, or on an option outside
/// its range.
[[nodiscard]] Eigen::Matrix3Xd drawn_shape(const geometry::GeodesicSurface& surface,
                                           const geometry::SurfacePoint& contact,
                                           const Eigen::Vector3d& displacement,
                                           const DrawnShapeOptions& options = {});

/// The tip of the model's probe, if it is known.
[[nodiscard]] DrawnShapeOptions shape_options(const Model& model);

/// The surface with one contact displaced, as it was learnt from recorded surfaces
/// (`SurfaceResponse`). A dent like that of `drawn_shape` closes what is left between the surface
/// and the tool, so that the contact, between the corners of its triangle, is at the tool. As far
/// as weight belongs to contacts for which nothing was recorded, that dent is all. Continuous in
/// place and displacement.
/// \param weights of the contacts at the place (`BlendedField::weights`). \return 3 x V [mm]
/// \param response which `check_surface_response` accepts.
/// \throws InvalidInput as `drawn_shape`, or if the response is of another number of vertices.
[[nodiscard]] Eigen::Matrix3Xd measured_shape(const geometry::GeodesicSurface& surface,
                                              const SurfaceResponse& response,
                                              const geometry::ContactWeights& weights,
                                              const geometry::SurfacePoint& contact,
                                              const Eigen::Vector3d& displacement,
                                              const DrawnShapeOptions& options = {});

/// A recorded surface as it is kept, 3 x V [mm].
/// \param contact where the displaced contact is. \param shape in [0, S) of the response
/// \throws InvalidInput if the mesh is not valid or the contact is not on it.
[[nodiscard]] Eigen::Matrix3Xd recorded_shape(const geometry::GeodesicSurface& surface,
                                              const SurfaceResponse& response,
                                              const geometry::SurfacePoint& contact,
                                              Eigen::Index shape);

/// The recorded surface whose displaced contact was nearest to the tool, among those of the contact
/// with the largest weight for which any was recorded (thesis 5.6.1); `drawn_shape` if none was for
/// any contact with a weight. It jumps when another one becomes the nearest, and its dent is where
/// it was recorded. Arguments as for `measured_shape`.
/// \param model with a response. \param surface, query  of the model's surface.
[[nodiscard]] Eigen::Matrix3Xd nearest_shape(const Model& model,
                                             const geometry::GeodesicSurface& surface,
                                             const geometry::SurfaceQuery& query,
                                             const geometry::ContactWeights& weights,
                                             const geometry::SurfacePoint& contact,
                                             const Eigen::Vector3d& displacement);

/// The rule for the displayed surface while a tool touches a model with recorded surfaces.
enum class ShapeRule : std::uint8_t {
  blended,  ///< `measured_shape`: continuous, and the contact is at the tool
  nearest,  ///< `nearest_shape`: exactly what was recorded, elsewhere
};

/// The surface to display in a state of playback, 3 x V [mm]: undeformed while the tool is free,
/// otherwise as the rule says, or `drawn_shape` if no surface was recorded for the model.
/// \param field, surface  of the model; see `drawn_shape`.
[[nodiscard]] Eigen::Matrix3Xd displayed_shape(const Model& model, const BlendedField& field,
                                               const geometry::GeodesicSurface& surface,
                                               const LoopState& state,
                                               ShapeRule rule = ShapeRule::blended);

}  // namespace palpate::haptics
