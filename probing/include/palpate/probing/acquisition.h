// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// A place on the undeformed surface where the object was probed.
struct Contact {
  long long id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] world frame
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< outwards, unit length, world frame
};

/// One applied force and the tool positions it led to (thesis 4.5), in the world frame.
struct Sample {
  long long id = 0;
  long long contact = 0;  ///< id of the contact
  long long group = 0;    ///< samples of one contact and one group share their normal force
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] whole force of the tool on the object
  /// [mm] tool position with only the component of `force` along the contact's normal
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  /// [mm] tool position with the whole force; not used if the tool slipped
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  bool on_friction_boundary = false;  ///< the largest tangential force in its direction that held
  bool slipped = false;
  std::optional<std::string> range_map = std::nullopt;  ///< file of the deformed surface
  double time = 0;                                      ///< [s] since the acquisition began; >= 0
};

/// All that an arm measured of one object.
struct Acquisition {
  std::vector<Contact> contacts;
  std::vector<Sample> samples;
  std::map<std::string, std::string> meta;
  /// [mm] > 0 of the ball that touched the object; none: not known.
  std::optional<double> probe_radius = {};
};

/// Two contacts are at one place if their distance <= kSamePlaceTolerance * diagonal of the box
/// around all contacts. 1e-6: far below the resolution of an arm, far above the last digit of a
/// file.
inline constexpr double kSamePlaceTolerance = 1e-6;

/// A normal counts as a unit vector if | |n| - 1 | <= kUnitLengthTolerance: three printed digits.
inline constexpr double kUnitLengthTolerance = 2e-3;

/// An acquisition that was checked once, when it was made or read. Functions that take one need not
/// check it again. It has at least one contact, finite numbers, lengths and forces of at most
/// `kLargestMeasurement` (measurable.h), unit normals, unique ids, no two contacts at one place,
/// only samples of its contacts, no negative time, no sample that both slipped and held, and no
/// probe's radius that is not above 0. The samples of each contact stand together, contact by
/// contact, otherwise in the order in which they were given.
class CheckedAcquisition {
 public:
  /// Implicit, so that an `Acquisition` is checked wherever a checked one is expected.
  ///
  /// \throws InvalidInput naming the contact or the sample, what is wrong and what would be right.
  CheckedAcquisition(Acquisition acquisition);

  [[nodiscard]] const Acquisition& records() const { return records_; }
  [[nodiscard]] const std::vector<Contact>& contacts() const { return records_.contacts; }
  [[nodiscard]] const std::vector<Sample>& samples() const { return records_.samples; }

  /// The index in `contacts()` of the contact with this id, if there is one.
  [[nodiscard]] std::optional<std::size_t> find(long long id) const;
  /// The samples of `contacts()[contact]`.
  [[nodiscard]] std::span<const Sample> samples_of(std::size_t contact) const;

 private:
  Acquisition records_;
  std::unordered_map<long long, std::size_t> index_;  // of each contact's id
  std::vector<std::size_t> begin_;  // of each contact's samples; one more at the end
};

}  // namespace palpate::probing
