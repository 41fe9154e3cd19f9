// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "palpate/probing/acquisition.h"
#include "palpate/probing/closed_form.h"

// Measurements of a stretched sheet whose truth is known (probing/closed_form.h), in the order and
// with the noise of a simple probing.
namespace palpate::support {

using Strip = probing::Sheet;
using StripCone = probing::LocalCone;

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

inline Eigen::Matrix3d strip_frame(double x, double y) { return frame_at(Strip{}, x, y); }
inline Eigen::Vector3d strip_surface(double x, double y) { return surface_at(Strip{}, x, y); }
inline StripCone strip_cone(const Strip& strip, double x, double y) { return cone_at(strip, x, y); }
inline Eigen::Vector3d strip_displacement(const Strip& strip, double x, double y,
                                          const Eigen::Vector3d& force) {
  return displacement_at(strip, x, y, force);
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
      if (!holds(cone, force)) continue;
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
          const bool held = holds(cone, force);
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
    return deviation * Eigen::Vector3d{normal_(random_), normal_(random_), normal_(random_)};
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

}  // namespace palpate::support
