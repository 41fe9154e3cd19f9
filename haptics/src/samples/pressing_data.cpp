// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/pressing_data.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"

namespace palpate::haptics {
namespace {

// Depths of one contact are different if they differ by more than this share of the largest.
constexpr double kSameDepth = 0.02;
Press press_of(const PressedContact& contact) {
  const Eigen::Vector3d along = contact.direction.normalized();
  Press press;
  press.depth = (along.transpose() * contact.displacements).transpose();
  press.force = (along.transpose() * contact.forces).transpose();
  const Eigen::Matrix3Xd across = contact.displacements - along * press.depth.transpose();
  const double square = press.depth.squaredNorm();
  press.across_slope =
      square > 0 ? Eigen::Vector3d(across * press.depth / square) : Eigen::Vector3d::Zero();
  press.across_force = (contact.forces - along * press.force.transpose()).rowwise().mean();
  press.weight = Eigen::VectorXd::Ones(press.depth.size());
  return press;
}

int different_depths(const Eigen::VectorXd& depth) {
  std::vector<double> sorted(depth.begin(), depth.end());
  std::ranges::sort(sorted);
  const double least = kSameDepth * std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  int count = 1;
  double last = sorted.front();
  for (const double d : sorted) {
    if (d - last > least) {
      ++count;
      last = d;
    }
  }
  return count;
}

CompressedPress compressed(const PressedContact& contact, const Press& press, const Scales& scales,
                           int degree) {
  const Eigen::Index samples = press.depth.size();
  Eigen::MatrixXd table(samples, degree + 3);
  table.col(0) = press.weight;
  for (int k = 1; k <= degree; ++k)
    table.col(k) = table.col(k - 1).cwiseProduct(press.depth / scales.length);
  table.col(degree + 1).setOnes();
  table.col(degree + 2) = press.force;
  const Eigen::Index rows = std::min<Eigen::Index>(samples, degree + 2);
  const Eigen::HouseholderQR<Eigen::MatrixXd> factor(table.leftCols(degree + 2));
  const Eigen::MatrixXd turned = factor.householderQ().adjoint() * table;
  CompressedPress result;
  result.powers = turned.topLeftCorner(rows, degree + 1);
  result.constant = turned.col(degree + 1).head(rows);
  result.force = turned.col(degree + 2).head(rows);
  result.rest = turned.col(degree + 2).tail(samples - rows).squaredNorm();
  result.samples = static_cast<int>(samples);
  result.height = contact.height / scales.length;
  result.bias = scales.along ? Eigen::RowVectorXd(Eigen::RowVectorXd::Ones(1))
                             : Eigen::RowVectorXd(contact.direction.normalized().transpose());
  return result;
}

}  // namespace

void check_pressed(const PressedContact& contact, std::size_t index) {
  const std::string name = "estimate_pressing(): contact " + std::to_string(index);
  const Eigen::Index count = contact.forces.cols();
  if (count == 0 || contact.displacements.cols() != count ||
      (!contact.unloading.empty() &&
       static_cast<Eigen::Index>(contact.unloading.size()) != count)) {
    throw InvalidInput(name + " has " + std::to_string(contact.displacements.cols()) +
                       " displacements, " + std::to_string(count) + " forces and " +
                       std::to_string(contact.unloading.size()) +
                       " directions of motion; there must be as many of each, at least one");
  }
  if (!contact.displacements.allFinite() || !contact.forces.allFinite() ||
      !contact.position.allFinite() || !contact.direction.allFinite() ||
      !std::isfinite(contact.height) || !(contact.direction.norm() > 0))
    throw InvalidInput(name + " has a number that is not finite, or no direction; leave it out");
}

std::vector<Press> presses_of(std::span<const PressedContact> contacts) {
  std::vector<Press> presses;
  presses.reserve(contacts.size());
  for (const PressedContact& contact : contacts) presses.push_back(press_of(contact));
  return presses;
}

Scales scales_of(std::span<const PressedContact> contacts, const std::vector<Press>& presses) {
  Scales scales;
  double largest = 0, along = 0, across = 0, samples = 0;
  std::vector<double> depths;
  for (std::size_t i = 0; i < presses.size(); ++i) {
    largest = std::max(largest, presses[i].depth.cwiseAbs().maxCoeff());
    along += presses[i].force.squaredNorm();
    across += contacts[i].forces.squaredNorm() - presses[i].force.squaredNorm();
    samples += static_cast<double>(presses[i].force.size());
    depths.push_back(different_depths(presses[i].depth));
  }
  if (largest > 0) scales.length = largest;
  if (along > 0) scales.force = std::sqrt(along / samples);
  scales.depths = static_cast<int>(median(depths));
  scales.along = across <= kAlongOnly * kAlongOnly * along;
  return scales;
}

std::vector<CompressedPress> compressed(std::span<const PressedContact> contacts,
                                        const std::vector<Press>& presses, const Scales& scales,
                                        int degree) {
  std::vector<CompressedPress> result;
  result.reserve(presses.size());
  for (std::size_t i = 0; i < presses.size(); ++i)
    result.push_back(compressed(contacts[i], presses[i], scales, degree));
  return result;
}

}  // namespace palpate::haptics
