// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Where a friction coefficient comes from.
enum class FrictionSource {
  samples,         ///< a cone fitted to this contact's own samples
  other_contacts,  ///< its samples determine none: the mean of those contacts that have one
  none             ///< no contact has one: 0, without friction
};

/// What was learnt at one contact.
struct ContactModel {
  long long id = 0;                                    ///< as in the acquisition
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface, world
  /// Columns: axes of the local frame in the world, right-handed. z is the axis of the friction
  /// cone, the direction of pressing: into the object (thesis 5.4.1).
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  ForceField field;     ///< in the local frame
  double friction = 0;  ///< coefficient; >= 0
  FrictionSource friction_source = FrictionSource::none;
  /// Unit vector into the object, world: a slipping contact moves in the plane of this and the tool
  /// (thesis 5.4.2).
  Eigen::Vector3d friction_axis = Eigen::Vector3d::UnitZ();
  int samples = 0;       ///< pairs of displacement and force that the field was fitted to
  double rms = 0;        ///< [N] sqrt(mean |error|^2) of the field on them
  std::string fit_stop;  ///< how the fit ended: a FitStop in a word
};

/// A deformable object as it was measured: the folder of design and playback.
struct Model {
  geometry::TriangleMesh surface;  ///< undeformed, triangles counter-clockwise seen from outside
  std::vector<ContactModel> contacts;  ///< at least three
  Eigen::Matrix3Xi triangles;          ///< 3 x T indices of contacts, oriented as the surface
  /// Of the contacts at each vertex of the surface. Without any (no columns) they are those of the
  /// nearest points of the triangles, of which there must be some then.
  geometry::SurfaceWeights surface_weights;
  /// Moves the acquisition onto the surface; the contacts here are moved already.
  Eigen::Isometry3d T_surface_acquisition = Eigen::Isometry3d::Identity();
  std::map<std::string, std::string> made;  ///< how: sources, options, program; UTF-8
};

/// A frame is orthonormal and an axis is a unit vector iff no entry of F^T F, or of its length, is
/// further from that than this. 1e-9: rounding of some operations and of 12 printed digits.
inline constexpr double kFrameTolerance = 1e-9;

/// \throws InvalidInput naming the contact or triangle, what is wrong and what would be right.
void check_model(const Model& model);

/// The contacts and their triangles as a mesh.
[[nodiscard]] geometry::TriangleMesh contact_mesh(const Model& model);

}  // namespace palpate::haptics
