// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "palpate/probing/acquisition.h"

// Measurements of a stretched sheet whose truth is known: a gently curved surface near z = 700 mm
// that faces the camera, stretched along x between supports, optionally with a stiff block below
// it. Local frame of a contact: X is the camera's X projected onto the tangent plane, Z points into
// the object. Positions follow from forces by minimising the energy. Only the records of the
// library are used.
namespace palpate::testing {

/// Material of the sheet. With e = displacement at the contact minus compliance * force, L_1 =
/// support + x, L_2 = support - x, and l_i the deformed lengths of the two segments, the energy is
/// w (sum_i tension (l_i - L_i) + axial / (2 L_i) (l_i - L_i)^2) + lateral / 2 e_y^2, where w = 1 -
/// taper (y / 75 mm)^2. The block adds block / 2 (softness softplus((e_z - depth) / softness))^2
/// times windows with logistic edges.
struct Strip {
  double tension = 0.8;      ///< [N]
  double axial = 42;         ///< [N] axial stiffness of a segment times its length
  double support = 50;       ///< [mm] the supports lie at x = +-support
  double compliance = 0.25;  ///< [mm/N] local, the same in all directions
  double lateral = 0.04;     ///< [N/mm] against motion along y
  double taper = 0.35;       ///< decrease of tension and stiffness towards the free edges

  double block = 0;                   ///< [N/mm] stiffness of the block; 0 for none, 1.5 is stiff
  double depth = 15;                  ///< [mm] of the block below the sheet
  double softness = 0.4;              ///< [mm] of the block's contact
  double edge = 2;                    ///< [mm] of its windows
  Eigen::Vector2d block_low{5, -20};  ///< [mm] corners of the block
  Eigen::Vector2d block_high{35, 20};

  double friction = 0.9;             ///< mean coefficient
  double friction_variation = 0.05;  ///< amplitude of its variation over the sheet
  double tilt = 4;                   ///< [degrees] amplitude of the angle between axis and normal
};

/// Settings of the probing.
struct StripProbing {
  double spacing_x = 14;  ///< [mm] of contacts in a row, |x| <= 42 mm; rows alternate
  double spacing_y = 20;  ///< [mm] between rows, |y| <= 60 mm
  std::vector<double> normal_forces{0.15, 0.5, 1.1, 2, 3};  ///< [N]
  int directions = 8;                                       ///< of the tangential force
  double resolution = 0.05;                                 ///< [N] at which bisection ends
  double max_force = 3.3;                                   ///< [N] upper limit of |f|
  double position_noise = 0.02;                             ///< [mm] deviation of a and of b
  /// [mm] along the surface, shared by a and b of one sample
  double location_noise = 0.02;
  double force_noise = 0.01;  ///< [N] of the force at b; at a, half of the same error applies
  unsigned seed = 1;
};

/// Rows X, Y, Z of the local frame.
inline Eigen::Matrix3d strip_frame(double x, double y) {
  const Eigen::Vector3d inward =
      -Eigen::Vector3d(-0.0016 * x, 1.5 / 40 * std::cos(y / 40), -1).normalized();
  const Eigen::Vector3d along = (Eigen::Vector3d::UnitX() - inward * inward.x()).normalized();
  Eigen::Matrix3d frame;
  frame << along.transpose(), inward.cross(along).transpose(), inward.transpose();
  return frame;
}

/// [mm] The undeformed surface, in the camera's frame.
inline Eigen::Vector3d strip_surface(double x, double y) {
  const double within = std::min(std::abs(x), 50.0);
  return {x, y, 702 - 0.0008 * within * within + 1.5 * std::sin(y / 40)};
}

/// Axis (local) and coefficient of the friction cone at (x, y).
struct StripCone {
  Eigen::Vector3d axis;
  double friction = 0;
};

inline StripCone strip_cone(const Strip& strip, double x, double y) {
  const double tilt = strip.tilt * std::numbers::pi / 180;
  const double a = std::sin(tilt * std::cos(y / 25)), b = std::sin(tilt * std::sin(x / 18));
  return {{a, b, std::sqrt(1 - a * a - b * b)},
          strip.friction + strip.friction_variation * std::sin(x / 20) * std::cos(y / 30)};
}

/// Whether a force (local) lies inside the cone.
inline bool strip_holds(const StripCone& cone, const Eigen::Vector3d& force) {
  const double along = force.dot(cone.axis);
  return (force - along * cone.axis).norm() <= cone.friction * along;
}

/// [N] Gradient of the energy by e (local).
inline Eigen::Vector3d strip_gradient(const Strip& strip, double x, double y,
                                      const Eigen::Vector3d& e) {
  const double width = 1 - strip.taper * y * y / (75.0 * 75.0);
  Eigen::Vector3d gradient(0, strip.lateral * e.y(), 0);
  for (const double side : {1.0, -1.0}) {
    const double length = strip.support + side * x;
    const Eigen::Vector3d segment = e + side * length * Eigen::Vector3d::UnitX();
    const double stretched = segment.norm();
    gradient +=
        width * (strip.tension + strip.axial * (stretched - length) / length) / stretched * segment;
  }
  if (strip.block == 0) return gradient;
  const auto logistic = [](double u) { return 0.5 * (1 + std::tanh(u / 2)); };
  const auto window = [&](double at, double low, double high) {
    const double rise = logistic((at - low) / strip.edge),
                 fall = logistic((high - at) / strip.edge);
    return Eigen::Vector2d(rise * fall, rise * fall * (fall - rise) / strip.edge);
  };
  const Eigen::Vector2d in_x = window(x + e.x(), strip.block_low.x(), strip.block_high.x());
  const Eigen::Vector2d in_y = window(y + e.y(), strip.block_low.y(), strip.block_high.y());
  const double u = (e.z() - strip.depth) / strip.softness;
  const double penetration =
      strip.softness * (std::max(u, 0.0) + std::log1p(std::exp(-std::abs(u))));
  const double energy = strip.block / 2 * penetration * penetration;
  return gradient + Eigen::Vector3d(in_x[1] * in_y[0] * energy, in_x[0] * in_y[1] * energy,
                                    in_x[0] * in_y[0] * strip.block * penetration * logistic(u));
}

/// [mm] Displacement (local) of the contact (x, y) under a force (local): the equilibrium reached
/// by increasing the force from zero.
/// \throws std::runtime_error if Newton's method does not find it.
inline Eigen::Vector3d strip_displacement(const Strip& strip, double x, double y,
                                          const Eigen::Vector3d& force) {
  constexpr int kLoads = 12, kIterations = 60;
  constexpr double kDifference = 1e-5;         // [mm] of the numeric Hessian
  constexpr double kLongestStep = 2;           // [mm]
  constexpr double kSmallestStiffness = 1e-4;  // [N/mm]
  constexpr double kResidual = 1e-10;          // [N]
  Eigen::Vector3d e = Eigen::Vector3d::Zero();
  double residual = 0;
  for (int load = 1; load <= kLoads; ++load) {
    for (int i = 0; i < kIterations; ++i) {
      const Eigen::Vector3d unbalanced =
          strip_gradient(strip, x, y, e) - force * load / static_cast<double>(kLoads);
      residual = unbalanced.norm();
      if (residual < kResidual) break;
      Eigen::Matrix3d hessian;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d d = kDifference * Eigen::Vector3d::Unit(k);
        hessian.col(k) = (strip_gradient(strip, x, y, e + d) - strip_gradient(strip, x, y, e - d)) /
                         (2 * kDifference);
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen((hessian + hessian.transpose()) /
                                                                 2);
      const Eigen::Vector3d step =
          -eigen.eigenvectors() *
          (eigen.eigenvectors().transpose() * unbalanced)
              .cwiseQuotient(eigen.eigenvalues().cwiseAbs().cwiseMax(kSmallestStiffness));
      double part = std::min(1.0, kLongestStep / step.norm());
      // Require a smaller residual each time, which suffices for the convex sheet and for the
      // block.
      while (part > 1e-3 && (strip_gradient(strip, x, y, e + part * step) -
                             force * load / static_cast<double>(kLoads))
                                    .norm() > residual) {
        part /= 2;
      }
      e += part * step;
    }
  }
  if (!(residual < 1e3 * kResidual)) throw std::runtime_error("the strip has no equilibrium");
  return e + strip.compliance * force;
}

/// What a probe needs to know of an object: for a contact at (x, y) the rows of its local frame,
/// its position, its friction, and its displacement (local) under a force (local).
inline Eigen::Matrix3d frame_at(const Strip&, double x, double y) { return strip_frame(x, y); }
inline Eigen::Vector3d surface_at(const Strip&, double x, double y) { return strip_surface(x, y); }
inline StripCone cone_at(const Strip& strip, double x, double y) { return strip_cone(strip, x, y); }
inline Eigen::Vector3d displacement_at(const Strip& strip, double x, double y,
                                       const Eigen::Vector3d& force) {
  return strip_displacement(strip, x, y, force);
}

/// A noise-free pair at a contact, inside the friction cone, in the camera's frame.
struct StripTruth {
  Eigen::Vector3d contact, displacement, force;
};

/// Pairs at contacts at the given places.
template <typename Object>
std::vector<StripTruth> strip_truths(const Object& object,
                                     const std::vector<Eigen::Vector2d>& places, int per_place,
                                     unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<StripTruth> truths;
  for (const Eigen::Vector2d& at : places) {
    const Eigen::Matrix3d frame = frame_at(object, at.x(), at.y());
    const StripCone cone = cone_at(object, at.x(), at.y());
    for (int i = 0; i < per_place;) {
      const double normal = 0.1 + 2.9 * uniform(random);
      const double tangential = 0.75 * uniform(random) * normal;
      const double angle = 2 * std::numbers::pi * uniform(random);
      Eigen::Vector3d force(tangential * std::cos(angle), tangential * std::sin(angle), normal);
      force *= std::min(1.0, 3 / force.norm());
      if (!strip_holds(cone, force)) continue;
      truths.push_back({surface_at(object, at.x(), at.y()),
                        frame.transpose() * displacement_at(object, at.x(), at.y(), force),
                        frame.transpose() * force});
      ++i;
    }
  }
  return truths;
}

/// Probes contacts of an object. Stores local forces in the order of the samples; in each direction
/// that slipped, the last sample that stuck is marked.
template <typename Object>
class ObjectProbe {
 public:
  /// `group`: id of the first group of samples; probes of one acquisition need different ids.
  ObjectProbe(const Object& object, const StripProbing& probing, long long group = 0)
      : object_(object), probing_(probing), random_(probing.seed), group_(group) {}

  /// Adds a contact at (x, y) and all its samples.
  void probe(probing::Acquisition& acquisition, double x, double y) {
    const probing::Contact contact = add_contact(acquisition, x, y);
    const StripCone cone = cone_at(object_, x, y);
    for (const double normal : probing_.normal_forces) {
      add(acquisition, contact, x, y, {0, 0, normal}, true);
      for (int k = 0; k < probing_.directions; ++k) {
        const double angle = 0.2 + 2 * std::numbers::pi * k / probing_.directions;
        double low = 0, slips = -1;
        double high =
            std::sqrt(std::max(probing_.max_force * probing_.max_force - normal * normal, 0.0));
        std::size_t last_held = 0;
        while (high - low > probing_.resolution) {
          const double middle = (low + high) / 2;
          const Eigen::Vector3d force(middle * std::cos(angle), middle * std::sin(angle), normal);
          const bool held = strip_holds(cone, force);
          if (held) last_held = acquisition.samples.size();
          add(acquisition, contact, x, y, force, held);
          (held ? low : high) = middle;
          if (!held) slips = middle;
        }
        if (slips > 0 && last_held > 0) acquisition.samples[last_held].on_friction_boundary = true;
      }
      ++group_;
    }
  }

  /// Adds a contact at (x, y) with one group per normal force: the normal force alone, and with a
  /// tangential force of `ratio` times it in each direction. Omits the search for the friction
  /// boundary, which takes most samples.
  void probe_sparsely(probing::Acquisition& acquisition, double x, double y, double ratio) {
    const probing::Contact contact = add_contact(acquisition, x, y);
    for (const double normal : probing_.normal_forces) {
      add(acquisition, contact, x, y, {0, 0, normal}, true);
      for (int k = 0; k < probing_.directions; ++k) {
        const double angle = 0.2 + 2 * std::numbers::pi * k / probing_.directions;
        add(acquisition, contact, x, y,
            normal * Eigen::Vector3d(ratio * std::cos(angle), ratio * std::sin(angle), 1), true);
      }
      ++group_;
    }
  }

 private:
  probing::Contact add_contact(probing::Acquisition& acquisition, double x, double y) const {
    acquisition.contacts.push_back({static_cast<long long>(acquisition.contacts.size()),
                                    surface_at(object_, x, y),
                                    -frame_at(object_, x, y).row(2).transpose()});
    return acquisition.contacts.back();
  }

  Eigen::Vector3d noise(double deviation) {
    return deviation * Eigen::Vector3d(normal_(random_), normal_(random_), normal_(random_));
  }

  void add(probing::Acquisition& acquisition, const probing::Contact& contact, double x, double y,
           const Eigen::Vector3d& force, bool held) {
    constexpr double kSlide = 4;  // [mm] distance that a slipping tool moves
    const Eigen::Matrix3d frame = frame_at(object_, x, y);
    const Eigen::Matrix3d to_camera = frame.transpose();
    const Eigen::Vector3d wrong = noise(probing_.force_noise);
    Eigen::Vector3d location = noise(probing_.location_noise);
    location.z() = 0;
    const Eigen::Vector3d pressed(0, 0, force.z());
    const Eigen::Vector3d a = displacement_at(object_, x, y, pressed + wrong / 2) + location +
                              noise(probing_.position_noise);
    Eigen::Vector3d b =
        displacement_at(object_, x, y, force + wrong) + location + noise(probing_.position_noise);
    if (!held) b += kSlide * (force - pressed).normalized() + Eigen::Vector3d::UnitZ();
    const auto id = static_cast<long long>(acquisition.samples.size());
    acquisition.samples.push_back({.id = id,
                                   .contact = contact.id,
                                   .group = group_,
                                   .force = to_camera * force,
                                   .a = contact.position + to_camera * a,
                                   .b = contact.position + to_camera * b,
                                   .slipped = !held,
                                   .time = 12.0 * static_cast<double>(id)});
  }

  const Object& object_;
  const StripProbing& probing_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  long long group_;
};

using StripProbe = ObjectProbe<Strip>;

/// The places to be probed.
inline std::vector<Eigen::Vector2d> strip_places(const StripProbing& probing = {}) {
  std::vector<Eigen::Vector2d> places;
  bool shifted = false;
  for (double y = -60; y <= 60; y += probing.spacing_y, shifted = !shifted) {
    for (double x = -42 + (shifted ? probing.spacing_x / 2 : 0); x <= 42; x += probing.spacing_x) {
      places.emplace_back(x, y);
    }
  }
  return places;
}

/// The whole sheet; with the defaults 46 contacts and about 11,600 samples.
inline probing::Acquisition strip_acquisition(const Strip& strip = {},
                                              const StripProbing& probing = {}) {
  probing::Acquisition acquisition;
  StripProbe probe(strip, probing);
  for (const Eigen::Vector2d& at : strip_places(probing)) probe.probe(acquisition, at.x(), at.y());
  return acquisition;
}

/// One contact of the sheet.
inline probing::Acquisition strip_contact(double x, double y, const Strip& strip = {},
                                          const StripProbing& probing = {}) {
  probing::Acquisition acquisition;
  StripProbe(strip, probing).probe(acquisition, x, y);
  return acquisition;
}

}  // namespace palpate::testing
