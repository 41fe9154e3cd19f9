// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "campaign/neighbour_prediction.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNeighbours = 6;
/// Contacts whose normals differ by more than 60 degrees do not predict each other.
constexpr double kSameSide = 0.5;
/// A contact is enclosed iff the weighted mean of the vectors to its neighbours is at most this
/// fraction of their mean length.
constexpr double kEnclosed = 0.4;
constexpr double kPlaneRidge = 0.01;  // penalty of the plane's slopes, relative to its constant

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
  const auto near = neighbours_of(sites, index);
  site.left_out = -1;
  if (near.size() < kNeighbours || !site.is_known()) return;
  const Contact& here = site.contact;
  const Eigen::Matrix3d frame = tangent_frame(here);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix3Xd rows(3, static_cast<Eigen::Index>(near.size()));
  Vector3d aside = Vector3d::Zero();
  double away = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double distance = near[i].first, weight = 1 / (distance * distance);
    const Vector3d off = sites[near[i].second].contact.position - here.position;
    const Vector3d row(1, off.dot(frame.col(0)) / near.back().first,
                       off.dot(frame.col(1)) / near.back().first);
    normal += weight * row * row.transpose();
    rows.col(static_cast<Eigen::Index>(i)) = weight * row;
    aside += weight * off;
    away += weight * distance;
  }
  if (aside.norm() > kEnclosed * away) return;
  normal.diagonal().tail<2>().array() += kPlaneRidge * normal(0, 0);
  const Eigen::VectorXd shares = (normal.inverse().row(0) * rows).transpose();
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
  site.left_out = sum / static_cast<double>(site.queries.size());
}

}  // namespace palpate::probing
