// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/force_field.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/friction_limit.h"
#include "palpate/haptics/passivity_certificate.h"
#include "palpate/haptics/pressing_estimate.h"
#include "palpate/haptics/rate_law.h"
#include "palpate/haptics/surface_response.h"

namespace palpate::haptics {

/// The source of a friction coefficient.
enum class FrictionSource {
  samples,         ///< a cone fitted to this contact's own samples
  other_contacts,  ///< the contact's samples determine none: the mean of the contacts that have one
  none,            ///< unknown: no contact has one. The coefficient is 0; playback may take another
  /// The contact's samples determine no estimate, for example because nothing slipped, but they
  /// give a lower bound above the mean of the other contacts. The coefficient is that lower bound.
  lower_bound
};

/// Response of a contact to the model's reference force F along a direction into the object, and
/// its change around it on the surface. The contact's pressing frame is its local frame turned by
/// the smallest rotation that turns the z axis into that direction.
struct ContactCompliance {
  /// Unit vector in the contact's local frame: the mean inward normal of the surface around it.
  /// Friction may tilt the z axis of the local frame against it; elasticity does not follow.
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  /// In the pressing frame: u_x, u_y, u_z [mm], the displacement at which the force of the
  /// contact's field is (0, 0, F), u_z > 0; c_xx, c_xy, c_yy [mm/N], the inverse of the upper left
  /// 2 x 2 block of the field's stiffness there, positive definite.
  Eigen::Vector<double, 6> values = Eigen::Vector<double, 6>::Zero();
  /// Derivatives of the values with respect to the place, 6 x 5: d/dx, d/dy, d2/dx2, d2/dxdy,
  /// d2/dy2, along the pressing frame's x and y axes [per mm, per mm^2].
  Eigen::Matrix<double, 6, 5> trend = Eigen::Matrix<double, 6, 5>::Zero();

  friend bool operator==(const ContactCompliance&, const ContactCompliance&) = default;
};

/// Resistance of a contact to a press, and its change around it on the surface.
struct ContactStrength {
  /// [N] >= 0, the mean force along the local z axis of a press to the model's reference depth.
  double value = 0;
  /// Derivatives with respect to the place: d/dx, d/dy, d2/dx2, d2/dxdy, d2/dy2, along the x and y
  /// axes of the local frame [N/mm, N/mm^2].
  Eigen::Vector<double, 5> trend = Eigen::Vector<double, 5>::Zero();

  friend bool operator==(const ContactStrength&, const ContactStrength&) = default;
};

/// The quantity that a place between contacts takes from its neighbours.
enum class BlendRule {
  forces,      ///< their forces at the same displacement (Eq 5.10), scaled to the place's strength
  compliances  ///< their forces at displacements that fit the compliance of the place
};

/// The interpolation of forces between contacts (see `BlendedField`).
struct Interpolation {
  BlendRule rule = BlendRule::forces;
  double reference_force = 0;  ///< [N] F of the contacts' compliances; > 0 with `compliances`
  double reference_depth = 0;  ///< [mm] of the contacts' strengths; > 0 if there are any
  double reach = 0;  ///< [mm] how far beyond its contacts a place follows their trend; >= 0

  friend bool operator==(const Interpolation&, const Interpolation&) = default;
};

/// Uncertainty of the forces of a contact, and of those between it and its neighbours, from which
/// `BlendedField::deviation` is computed. All are >= 0.
struct ContactUncertainty {
  double force = 0;         ///< [N] of the force vector, whatever the displacement
  double displacement = 0;  ///< [mm] of each component; it acts through the stiffness
  double across = 0;   ///< of the force across the contact's z axis, relative to that force: the
                       ///< stiffness across was not measured
  double between = 0;  ///< [mm^-1.25] unknown to the neighbours, relative to the force

  friend bool operator==(const ContactUncertainty&, const ContactUncertainty&) = default;
};

/// Noise of the measurements that a model was made of: standard deviations of each component.
struct MeasurementNoise {
  double force = 0;         ///< [N]
  double displacement = 0;  ///< [mm]

  friend bool operator==(const MeasurementNoise&, const MeasurementNoise&) = default;
};

/// The model of one contact.
struct ContactModel {
  long long id = 0;                                    ///< as in the acquisition
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface, world
  /// Columns: axes of the local frame in the world, right-handed. z is the axis of the friction
  /// cone, the direction of pressing: into the object (thesis 5.4.1).
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  ForceField field;  ///< in the local frame
  /// Coefficient; >= 0. With a load exponent it is that under the normal force
  /// `Model::friction_force`.
  double friction = 0;
  /// Exponent of the dependence of the coefficient on the normal force f_N: it is
  /// friction (f_N / friction_force)^exponent. 0: none. In [-0.5, 0.5].
  double load_exponent = 0;
  /// Standard error of the coefficient, or its standard deviation among the contacts that it is the
  /// mean of; >= 0. A lower bound has none.
  std::optional<double> friction_error = {};
  /// The contact's own samples show with 95 % confidence that the coefficient is at least this.
  double friction_lower_bound = 0;
  FrictionSource friction_source = FrictionSource::none;
  /// Unit vector into the object, world: a slipping contact moves in the plane of this and the tool
  /// (thesis 5.4.2).
  Eigen::Vector3d friction_axis = Eigen::Vector3d::UnitZ();
  /// None: not known, or the field does not reach the reference force. The contact's forces then
  /// count at the same displacement, whatever the rule.
  std::optional<ContactCompliance> compliance = {};
  /// With the rule `forces`; none: not known. The place's strength is then that of the others.
  std::optional<ContactStrength> strength = {};
  int samples = 0;  ///< pairs of displacement and force that the field was fitted to
  double rms = 0;   ///< [N] sqrt(mean |error|^2) of the field on them
  // Results of the fit (see FitResult); nullopt if not known.
  std::optional<FitStop> fit_stop = {};     ///< how the fit ended
  std::optional<FitMode> fit_mode = {};     ///< the guarantee that the fit gives
  std::optional<Passivity> passivity = {};  ///< of the field over the reach of its samples
  std::optional<double> chi2 = {};          ///< per degree of freedom; >= 0
  std::optional<double> noise_floor = {};   ///< [N] the rms that noise alone makes; >= 0
  std::optional<double> condition = {};     ///< of the fit's least squares; >= 0
  bool shared_local = false;                ///< fitted to a local part that contacts share
  std::optional<ContactUncertainty> uncertainty = {};  ///< none: not known
};

/// A deformable object as it was measured: the folder of design and playback.
struct Model {
  geometry::TriangleMesh surface;  ///< undeformed, triangles counter-clockwise seen from outside
  std::vector<ContactModel> contacts;  ///< at least three
  Eigen::Matrix3Xi triangles;          ///< 3 x T indices of contacts, oriented as the surface
  /// The method that made `triangles`, and makes those of fewer contacts or of another surface.
  geometry::ContactTriangulationMethod triangulation =
      geometry::ContactTriangulationMethod::delaunay;
  /// Weights of the contacts at each vertex of the surface. Without any (no columns) they are the
  /// barycentric coordinates of the vertex's nearest point on the triangles of contacts, of which
  /// there must be some then.
  geometry::SurfaceWeights surface_weights;
  Interpolation interpolation;
  /// [mm] > 0 of the ball with which the object was measured; none: not known.
  std::optional<double> probe_radius = {};
  /// [N] Normal force for which the friction coefficients hold; > 0 if any has a load exponent.
  double friction_force = 0;
  /// Dependence of forces on the rate, the same at all contacts (rate_law.h): at most two terms.
  /// Empty: none. The fields give the force that stays.
  std::vector<RateTerm> rate;
  std::optional<MeasurementNoise> noise = {};  ///< none: not known
  /// Response of the whole surface to the tool, for display; none: no surfaces were recorded.
  std::optional<SurfaceResponse> response = {};
  /// Moves the acquisition onto the surface; the contacts here are moved already.
  Eigen::Isometry3d T_surface_acquisition = Eigen::Isometry3d::Identity();
  /// `probing::fingerprint` of the acquisition that the model was fitted to; none: it was fitted to
  /// no acquisition, or it was scaled, transferred or merged since.
  std::optional<std::string> samples_fingerprint = {};
  /// Offsets subtracted from the records of that acquisition, in its frame; none if not all of its
  /// contacts were only pressed. `hysteresis` < 1.
  std::optional<PressingOffsets> pressing_offsets = {};
  /// Origin: sources, options, program; UTF-8. For people: nothing is computed from it.
  std::map<std::string, std::string> made;
};

/// A frame is orthonormal and an axis is a unit vector if no entry of F^T F, or of its length, is
/// further from that than this. 1e-9: rounding of some operations and of 12 printed digits.
inline constexpr double kFrameTolerance = 1e-9;

/// The words of the field document: "samples", "other_contacts", ...
[[nodiscard]] const char* to_string(FrictionSource source);
/// "forces" or "compliances"
[[nodiscard]] const char* to_string(BlendRule rule);

/// \throws InvalidInput naming the contact or triangle, what is wrong and what would be right.
void check_model(const Model& model);

/// Returns true if a contact's friction is unknown: its source is `none`, the coefficient 0.
[[nodiscard]] bool has_unknown_friction(const ContactModel& contact);
/// Number of contacts whose friction is unknown.
[[nodiscard]] int unknown_friction_count(const Model& model);

/// Columns: axes of a contact's pressing frame in the world; its frame if it has no compliance.
[[nodiscard]] Eigen::Matrix3d pressing_frame(const ContactModel& contact);

/// `surface_weights`; in a model without any, the weights that its triangles give.
[[nodiscard]] geometry::SurfaceWeights vertex_weights(const Model& model);

/// The contacts and their triangles as a mesh.
[[nodiscard]] geometry::TriangleMesh contact_mesh(const Model& model);

}  // namespace palpate::haptics
