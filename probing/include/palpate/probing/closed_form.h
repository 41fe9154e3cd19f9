// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/specimen.h"

// Objects whose displacements follow from forces in closed form, or by minimising a stated energy.
// Each is a surface z(x, y) near z = 700 mm that faces a camera at the origin. At the place (x, y)
// [mm] it has a local frame: Z points into the object, X is the camera's X projected onto the
// tangent plane. `displacement_at` is the equilibrium reached by increasing the force from zero;
// its vectors are local. Functions of places do not check their numbers; `make_specimen` does. A
// share of each displacement may be retarded (`Retardation`), as in foam and tissue.
namespace palpate::probing {

/// Axis (local frame) and coefficient of the friction cone at a place.
struct LocalCone {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  double friction = 0;
};

/// Returns true if a force (local) lies inside the cone.
[[nodiscard]] bool holds(const LocalCone& cone, const Eigen::Vector3d& force);

/// A gently curved sheet, stretched along x between supports, optionally with a stiff block below
/// it (thesis 4.6.2). A contact feels only the strip it lies on.
///
/// With e = displacement minus compliance * force, L_1 = support + x, L_2 = support - x, and l_i
/// the deformed lengths of the two segments, the energy is w (sum_i tension (l_i - L_i) + axial /
/// (2 L_i) (l_i - L_i)^2) + lateral / 2 e_y^2, where w = 1 - taper (y / 75 mm)^2. The block adds
/// block / 2 (softness softplus((e_z - depth) / softness))^2 times windows with logistic edges.
struct Sheet {
  double tension = 0.8;      ///< [N] >= 0
  double axial = 42;         ///< [N] axial stiffness of a segment times its length; > 0
  double support = 50;       ///< [mm] the supports lie at x = +-support; > 10
  double compliance = 0.25;  ///< [mm/N] local, the same in all directions; >= 0
  double lateral = 0.04;     ///< [N/mm] against motion along y; > 0
  double taper = 0.35;  ///< decrease of tension and stiffness towards the free edges; in [0, 1)

  double block = 0;                   ///< [N/mm] stiffness of the block; 0 for none, 1.5 is stiff
  double depth = 15;                  ///< [mm] of the block below the sheet; > 0
  double softness = 0.4;              ///< [mm] of the block's contact; > 0
  double edge = 2;                    ///< [mm] of its windows; > 0
  Eigen::Vector2d block_low{5, -20};  ///< [mm] corners of the block
  Eigen::Vector2d block_high{35, 20};

  double friction = 0.9;             ///< mean coefficient; >= 0
  double friction_variation = 0.05;  ///< amplitude of its variation over the sheet; >= 0
  double tilt = 4;                   ///< [degrees] amplitude of the angle between axis and normal

  double retarded = 0;          ///< share of the displacement that comes late; in [0, 1)
  double retardation_time = 1;  ///< [s] with which it comes; > 0
};

/// Rows X, Y, Z of the local frame.
[[nodiscard]] Eigen::Matrix3d frame_at(const Sheet& sheet, double x, double y);
/// [mm] The undeformed surface.
[[nodiscard]] Eigen::Vector3d surface_at(const Sheet& sheet, double x, double y);
[[nodiscard]] LocalCone cone_at(const Sheet& sheet, double x, double y);
/// [mm] \throws SolverError if Newton's method finds no equilibrium.
[[nodiscard]] Eigen::Vector3d displacement_at(const Sheet& sheet, double x, double y,
                                              const Eigen::Vector3d& force);

/// A foam beam clamped at x = 0 (thesis Figure 6.1): a force on its upper side indents the foam and
/// bends the whole beam.
///
/// The displacement under a force f is the gradient of
///   shear / 2 (f_x^2 + f_y^2) + pressed h^2 u(f_z / h) + coupled c^2 log cosh(|f| / c),
///   u(s) = s asinh s - sqrt(1 + s^2),
/// for the foam, a stiffening curve that is the same everywhere, plus the linear terms of the
/// beam's bending, stretching and twisting.
struct Beam {
  double length = 200;  ///< [mm] > 0
  double width = 40;    ///< [mm] |y| <= width / 2; > 0
  double height = 15;   ///< [mm] of the upper side over the beam's axis; >= 0

  double shear = 0.35;         ///< [mm/N] of the foam; >= 0
  double pressed = 1.6;        ///< [mm/N] of the foam at rest, along z; >= 0
  double pressed_force = 0.8;  ///< [N] h, where stiffening starts; > 0
  double coupled = 0.5;        ///< [mm/N] of the foam at rest, along each axis; >= 0
  double coupled_force = 1.5;  ///< [N] c, where stiffening starts; > 0
  double local_variation = 0;  ///< relative amplitude by which the foam varies; in [0, 1)

  double bending = 4;        ///< [mm/N] at the tip by a force along z; >= 0
  double sideways = 0.8;     ///< [mm/N] at the tip by a force along y; >= 0
  double stretching = 0.05;  ///< [mm/N] at the tip by a force along x; >= 0
  double twisting = 0.002;   ///< [1/(N mm)] angle at the tip by a torque; >= 0

  double friction = 0.8;  ///< >= 0

  double retarded = 0;          ///< share of the displacement that comes late; in [0, 1)
  double retardation_time = 1;  ///< [s] with which it comes; > 0
};

[[nodiscard]] Eigen::Matrix3d frame_at(const Beam& beam, double x, double y);
[[nodiscard]] Eigen::Vector3d surface_at(const Beam& beam, double x, double y);
[[nodiscard]] LocalCone cone_at(const Beam& beam, double x, double y);
[[nodiscard]] Eigen::Vector3d displacement_at(const Beam& beam, double x, double y,
                                              const Eigen::Vector3d& force);
/// [mm/N] Compliance of the whole beam: that of a cantilever loaded at its upper side.
[[nodiscard]] Eigen::Matrix3d bending_compliance(const Beam& beam, double x, double y);
/// [mm] Displacement of the foam under a force.
[[nodiscard]] Eigen::Vector3d indentation(const Beam& beam, const Eigen::Vector3d& force);

/// A square of the surface of a large linear elastic body, with the flat round end of a tool
/// sticking to it: the normal compliance is (1 - nu^2) / (2 a E), the tangential one (1 + nu) (2 -
/// nu) / (4 a E) with the tool's radius a (Johnson, Contact Mechanics, 3.4 and 7.2).
struct ElasticBody {
  double young_modulus = 0.05;  ///< [N/mm^2] > 0
  double poisson_ratio = 0.45;  ///< in (-1, 1/2]
  double tool_radius = 3;       ///< [mm] > 0
  double size = 100;            ///< [mm] side of the square |x|, |y| <= size / 2; > 0
  double friction = 0.7;        ///< >= 0

  double retarded = 0;          ///< share of the displacement that comes late; in [0, 1)
  double retardation_time = 1;  ///< [s] with which it comes; > 0
};

[[nodiscard]] Eigen::Matrix3d frame_at(const ElasticBody& body, double x, double y);
[[nodiscard]] Eigen::Vector3d surface_at(const ElasticBody& body, double x, double y);
[[nodiscard]] LocalCone cone_at(const ElasticBody& body, double x, double y);
[[nodiscard]] Eigen::Vector3d displacement_at(const ElasticBody& body, double x, double y,
                                              const Eigen::Vector3d& force);

/// [mm] Motion of the place `beside` [mm] (x, y from the contact) of the surface by the force: from
/// the tractions to which the two compliances belong, p / sqrt(1 - r^2 / a^2) over the tool's disc
/// (Boussinesq, Cerruti; Johnson 3.2 and 3.6), so that all of the disc moves as the tool. Beside
/// it, the normal displacement is 2 / pi asin(a / r) of the tool's. Below nu = 1/2, the normal part
/// of the force also moves the surface sideways and the tangential part along the normal, by at
/// most (1 - 2 nu) / (pi (1 - nu)) of the tool's displacement (6 % for 0.45), which a tool that
/// sticks would hold back below it.
[[nodiscard]] Eigen::Vector3d displacement_beside(const ElasticBody& body,
                                                  const Eigen::Vector2d& beside,
                                                  const Eigen::Vector3d& force);

/// An object with a mesh of its surface, whose vertices lie on it about 2 mm apart. The sheet's
/// ends 2 mm before its supports and 70 mm beside its middle.
/// \throws InvalidInput naming the field, if a number is outside its range.
[[nodiscard]] std::unique_ptr<Specimen> make_specimen(const Sheet& sheet);
[[nodiscard]] std::unique_ptr<Specimen> make_specimen(const Beam& beam);
[[nodiscard]] std::unique_ptr<Specimen> make_specimen(const ElasticBody& body);

}  // namespace palpate::probing
