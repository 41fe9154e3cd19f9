// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "campaign/neighbour_prediction.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "palpate/geometry/error_growth.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNeighbours = 6;
/// Contacts whose normals differ by more than 60 degrees do not predict each other.
constexpr double kSameSide = 0.5;
/// A contact is enclosed if the weighted mean of the vectors to its neighbours is at most this
/// fraction of their mean length.
constexpr double kEnclosed = 0.4;
constexpr double kPlaneRidge = 0.01;  // penalty of the plane's slopes, relative to its constant

using Near = std::vector<std::pair<double, std::size_t>>;

// The places of neighbours, and their weights.
struct Neighbours {
  Eigen::Matrix3Xd off;     // [mm] from the contact, in its tangent frame
  Eigen::VectorXd weights;  // [1/mm^2]
  bool enclosed = false;
};

Neighbours neighbours_around(const std::vector<AdaptiveSite>& sites, const Near& near,
                             const Contact& here) {
  const Eigen::Matrix3d frame = tangent_frame(here);
  Neighbours result;
  const auto count = static_cast<Eigen::Index>(near.size());
  result.off.resize(3, count);
  result.weights.resize(count);
  Vector3d aside = Vector3d::Zero();
  double away = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [distance, index] = near[static_cast<std::size_t>(i)];
    result.off.col(i) = frame.transpose() * (sites[index].contact.position - here.position);
    result.weights(i) = 1 / (distance * distance);
    aside += result.weights(i) * result.off.col(i);
    away += result.weights(i) * distance;
  }
  result.enclosed = aside.norm() <= kEnclosed * away;
  return result;
}

// The part of each neighbour in the plane through them, at the contact.
Eigen::VectorXd plane_shares(const Neighbours& neighbours) {
  const double farthest = neighbours.off.colwise().norm().maxCoeff();
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix3Xd rows(3, neighbours.off.cols());
  for (Eigen::Index i = 0; i < rows.cols(); ++i) {
    const Vector3d row(1, neighbours.off(0, i) / farthest, neighbours.off(1, i) / farthest);
    normal += neighbours.weights(i) * row * row.transpose();
    rows.col(i) = neighbours.weights(i) * row;
  }
  normal.diagonal().tail<2>().array() += kPlaneRidge * normal(0, 0);
  return (normal.inverse().row(0) * rows).transpose();
}

// [N^2] Of the forces of a contact that its neighbours predict.
double squared_error(const std::vector<AdaptiveSite>& sites, const Near& near,
                     const Eigen::VectorXd& shares, const AdaptiveSite& site) {
  double sum = 0;
  for (const Vector3d& query : site.queries) {
    Vector3d predicted = Vector3d::Zero();
    for (std::size_t i = 0; i < near.size(); ++i) {
      const AdaptiveSite& from = sites[near[i].second];
      const auto turn = Eigen::Quaterniond::FromTwoVectors(site.pressing(), from.pressing());
      predicted += shares[static_cast<Eigen::Index>(i)] *
                   (turn.inverse() * from.surrogate->predict(turn * query).mean);
    }
    const Vector3d error = predicted - site.surrogate->predict(query).mean;
    sum += (site.surrogate->compliance(query).inverse() * error).squaredNorm();
  }
  return sum / static_cast<double>(site.queries.size());
}

}  // namespace

std::vector<std::pair<double, std::size_t>> neighbours_of(const std::vector<AdaptiveSite>& sites,
                                                          std::size_t index) {
  std::vector<std::pair<double, std::size_t>> near;
  const Contact& here = sites[index].contact;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Contact& there = sites[i].contact;
    if (i == index || !sites[i].is_known()) continue;
    if (here.normal.dot(there.normal) < kSameSide) continue;
    near.emplace_back((here.position - there.position).norm(), i);
  }
  std::sort(near.begin(), near.end());
  near.resize(std::min(near.size(), kNeighbours));
  return near;
}

void leave_out(std::vector<AdaptiveSite>& sites, std::size_t index) {
  AdaptiveSite& site = sites[index];
  site.left_out = site.around = -1;
  if (!site.is_known()) return;
  const auto near = neighbours_of(sites, index);
  if (near.empty() || !(near.front().first > 0)) return;
  const Neighbours neighbours = neighbours_around(sites, near, site.contact);
  if (near.size() == kNeighbours && neighbours.enclosed) {
    site.left_out = squared_error(sites, near, plane_shares(neighbours), site);
    return;
  }
  const Eigen::VectorXd shares = neighbours.weights / neighbours.weights.sum();
  const double mean_square = shares.dot(neighbours.off.colwise().squaredNorm().transpose());
  const double beyond = (neighbours.off * shares).head<2>().squaredNorm();
  // In a triangle of three contacts as far from each other as the nearest one, the mean of the mean
  // squared distances to them is a quarter of its squared side.
  const double between = near.front().first * near.front().first / 4;
  site.around = squared_error(sites, near, shares, site) * geometry::error_growth(between) /
                geometry::error_growth(geometry::error_reach(mean_square, beyond));
}

}  // namespace palpate::probing
