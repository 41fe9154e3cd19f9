// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// The pattern of contacts on a surface.
enum class PlanPattern {
  farthest_point,  ///< in farthest-point order along the surface: each prefix is a coarser plan
  grid             ///< on lines, shifted by half the spacing from line to line (thesis 4.2)
};
/// "farthest_point", "grid".
[[nodiscard]] const char* to_string(PlanPattern pattern);

/// The eligibility of a place of a surface for probing: eligible, or the reason against it.
enum class Eligibility {
  eligible,
  no_surface,   ///< a vertex without triangles, or without a normal
  near_border,  ///< the tip could miss the object
  oblique,      ///< the sensor does not see it well, and an arm is likely to collide
  obstructed,   ///< the tip would touch another place first: a cavity tighter than it, or a wall
  not_needed    ///< the model is not needed there
};
/// "eligible", "no_surface", "near_border", "oblique", "obstructed", "not_needed".
[[nodiscard]] const char* to_string(Eligibility eligibility);

/// `visit` describes the fields. lowest_force <= highest_force <= max_force.
struct PlanOptions {
  PlanPattern pattern = PlanPattern::farthest_point;
  double spacing = 14;  ///< so large that a plan has at most 100,000 places
  std::optional<int> contacts = {};
  double tip_radius = 3;  ///< R; at most the size of the surface
  double border = 1.5;
  double view_angle = 7 * std::numbers::pi / 18;
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();  ///< [mm] place of the sensor

  double lowest_force = 0.15;
  std::optional<double> highest_force = {};
  int levels = 6;
  int directions = 4;
  double max_force = 3;
};

void visit(PlanOptions& options, FieldVisitor& visitor);

/// The contacts and forces to probe.
struct ContactPlan {
  PlanOptions options = {};                 ///< with a `highest_force`
  std::vector<Contact> contacts = {};       ///< in the order of probing; ids 0, 1, ...
  std::vector<double> normal_forces = {};   ///< [N] of each level, ascending
  std::vector<Eigen::Index> excluded = {};  ///< number of vertices by `Eligibility`
  double cover = 0;  ///< [mm] largest distance of an eligible vertex from a contact, along the
                     ///< surface; infinity if a part has none
  std::string surface = {};  ///< `surface_fingerprint` of the mesh
};

/// The angle [rad] of direction `k` of a level in the tangent plane, about the normal: all
/// directions are even, and turned by the golden angle from level to level.
[[nodiscard]] double direction_angle(const PlanOptions& options, int level, int k);

/// Unit vectors: columns X and Y span the tangent plane of a contact, X along the world's X if that
/// is not along the normal; Z points into the object.
[[nodiscard]] Eigen::Matrix3d tangent_frame(const Contact& contact);

/// Returns the eligibility of each vertex. The normal at a vertex is the mean of the triangles
/// within about R of it, weighted by their areas; distances from the border are along the surface.
/// A place is obstructed if a ball of radius R that touches it from outside contains another point
/// of the surface deeper than a tenth of R.
/// \param normals 3 x V, receives the outward normals; NaN where there is no surface.
[[nodiscard]] std::vector<Eligibility> eligibility(const geometry::TriangleMesh& mesh,
                                                   const PlanOptions& options,
                                                   Eigen::Matrix3Xd& normals);

/// Plans contacts at vertices of a surface.
/// \param needed of each vertex: whether the model is needed there. Empty: everywhere.
/// \throws InvalidInput if the mesh is not valid, `needed` has another size or an option is outside
/// its range, or, with the number of vertices by reason, if no place is eligible.
[[nodiscard]] ContactPlan plan_contacts(const geometry::TriangleMesh& mesh,
                                        const PlanOptions& options = {},
                                        const std::vector<bool>& needed = {});

/// Sixteen hexadecimal digits that identify the vertices and triangles of a mesh.
[[nodiscard]] std::string surface_fingerprint(const geometry::TriangleMesh& mesh);

/// A plan as text (JSON); docs/probing.md describes it.
[[nodiscard]] std::string to_text(const ContactPlan& plan);
/// \param source names the text in messages.
/// \throws FileError naming the member that is wrong.
[[nodiscard]] ContactPlan parse_plan(const std::string& text, const std::string& source);
/// \throws FileError also if the file cannot be read.
[[nodiscard]] ContactPlan read_plan(const std::filesystem::path& path);
/// \throws OutputError if it cannot be written.
void write_plan(const std::filesystem::path& path, const ContactPlan& plan);

}  // namespace palpate::probing
