// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace palpate::probing {

/// A place on the undeformed surface where the object was probed.
struct Contact {
  long long id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] world frame
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< outwards, unit length, world frame
};

/// One applied force and the tool positions it led to (thesis 4.5). Everything in the world frame.
struct Sample {
  long long id = 0;
  long long contact = 0;  ///< id of the contact
  long long group = 0;    ///< samples of one contact and one group share their normal force
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] whole force of the tool on the object
  /// [mm] tool position with only the component of `force` along the contact's normal
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  /// [mm] tool position with the whole force; of no use if the tool slipped
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  bool on_friction_boundary = false;  ///< the largest tangential force in its direction that held
  bool slipped = false;
  std::string range_map = {};  ///< file of the deformed surface, or empty
  double time = 0;             ///< [s] since the acquisition began; >= 0
};

/// All that an arm measured of one object.
struct Acquisition {
  std::vector<Contact> contacts;
  std::vector<Sample> samples;
  std::map<std::string, std::string> meta;
};

/// Two contacts are at one place iff their distance <= kSamePlaceTolerance * diagonal of the box
/// around all contacts. 1e-6: far below what an arm can tell apart, far above the last digit of a
/// file.
inline constexpr double kSamePlaceTolerance = 1e-6;

/// A normal counts as a unit vector iff | |n| - 1 | <= kUnitLengthTolerance: three printed digits.
inline constexpr double kUnitLengthTolerance = 2e-3;

/// Checks what the fit relies on: at least one contact, finite numbers, unit normals, unique ids,
/// no two contacts at one place, every sample at a contact, no negative time, no sample that both
/// slipped and held.
/// \throws InvalidInput naming the contact or the sample, what is wrong and what would be right.
void check_acquisition(const Acquisition& acquisition);

}  // namespace palpate::probing
