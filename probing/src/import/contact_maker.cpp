// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/contact_maker.h"

#include <cmath>

#include "palpate/core/error.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {

void RowPlace::refuse(const std::string& what) const {
  throw FileError(file.string() + ": row " + std::to_string(row) + ": " + what);
}

Eigen::Vector3d checked_normal(const Eigen::Vector3d& normal, const RowPlace& place) {
  if (std::abs(normal.norm() - 1) > kUnitLengthTolerance) {
    place.refuse("its normal nx,ny,nz has length " + to_text(normal.norm()) +
                 "; it must be a unit vector that points out of the object");
  }
  return normal;
}

void ContactMaker::add(long long id, const Eigen::Vector3d& position, const RowPlace& place) {
  const auto [found, added] = index_.emplace(id, made_.size());
  if (added) made_.push_back({id, position});
  Made& made = made_[found->second];
  const double distance = (position - made.first).norm();
  if (!(distance <= same_place_)) {
    place.refuse("contact " + std::to_string(id) + " is " + to_text(distance) +
                 " mm from where it was before; x,y,z is its place on the undeformed surface, "
                 "the same in all its rows up to same_place (" +
                 to_text(same_place_) + " mm)");
  }
  made.way += position - made.first;
  ++made.places;
}

long long ContactMaker::add(const Eigen::Vector3d& position, const RowPlace& place) {
  const Made* nearest = nullptr;
  double least = same_place_;
  for (const Made& made : made_) {
    const double distance = (made.first - position).norm();
    if (distance > least || (nearest != nullptr && distance == least)) continue;
    least = distance;
    nearest = &made;
  }
  const long long id = nearest ? nearest->id : static_cast<long long>(made_.size()) + 1;
  add(id, position, place);
  return id;
}

void ContactMaker::add_normal(long long id, const Eigen::Vector3d& normal) {
  Made& made = made_[index_.at(id)];
  if (made.normals == 0) made.first_normal = normal;
  made.turned += normal - made.first_normal;
  made.lengths += normal.norm();
  ++made.normals;
}

std::vector<Contact> ContactMaker::contacts() const {
  std::vector<Contact> result;
  for (const Made& made : made_) {
    const Eigen::Vector3d sum = made.normals * made.first_normal + made.turned;
    constexpr double kCancelled = 0.5;  // sum over the sum of lengths
    if (!(sum.norm() > kCancelled * made.lengths)) {
      throw InvalidInput("contact " + std::to_string(made.id) +
                         ": its normals, or the forces from which they are made, point in "
                         "different directions; give nx,ny,nz, one direction a contact");
    }
    // Equal normals stay as they are in the file.
    const bool as_given =
        made.turned.isZero(0) && std::abs(made.first_normal.norm() - 1) <= kUnitLengthTolerance;
    result.push_back({made.id, made.first + made.way / made.places,
                      as_given ? made.first_normal : Eigen::Vector3d(sum.normalized())});
  }
  return result;
}

}  // namespace palpate::probing
