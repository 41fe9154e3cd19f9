// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// The place of a row, for messages.
struct RowPlace {
  const std::filesystem::path& file;
  std::size_t row = 0;  // from 1

  /// \throws FileError with the place and what is wrong there.
  [[noreturn]] void refuse(const std::string& what) const;
};

/// The normal of a row.
/// \throws FileError unless it has length 1.
[[nodiscard]] Eigen::Vector3d checked_normal(const Eigen::Vector3d& normal, const RowPlace& place);

/// Contacts that are made of rows or touches.
class ContactMaker {
 public:
  explicit ContactMaker(double same_place) : same_place_(same_place) {}

  /// The contact with this id gets a further place.
  /// \throws FileError if that is further than `same_place` from its first one.
  void add(long long id, const Eigen::Vector3d& position, const RowPlace& place);
  /// The contact at a place; its id.
  long long add(const Eigen::Vector3d& position, const RowPlace& place);
  /// \param normal outwards, or the negative force
  void add_normal(long long id, const Eigen::Vector3d& normal);
  /// \throws InvalidInput if the normals of a contact cancel.
  [[nodiscard]] std::vector<Contact> contacts() const;

 private:
  struct Made {
    long long id = 0;
    Eigen::Vector3d first;                          // [mm] first place
    Eigen::Vector3d way = Eigen::Vector3d::Zero();  // sum of the places, from the first one
    double places = 0;
    Eigen::Vector3d first_normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();  // sum of the normals, from the first one
    double lengths = 0;                                // sum of their lengths
    double normals = 0;
  };
  double same_place_;
  std::vector<Made> made_;
  std::map<long long, std::size_t> index_;
};

}  // namespace palpate::probing
