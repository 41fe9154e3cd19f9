// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/left_out_blend.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "model/field_warp.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

// Nearest contacts among which the Delaunay triangle is sought.
constexpr std::size_t kCorners = 12;
// A place on the border of a triangle, up to rounding, is in it.
constexpr double kInside = -1e-9;

struct Weighted {
  std::array<int, 3> corners{};
  std::array<double, 3> weights{};
  int count = 0;
};

// The weights w >= 0 with sum 1 and sum w_k x_k = 0 that minimise sum w_k |x_k|^2 are those of the
// Delaunay triangle around zero: the lower hull of the places lifted onto a paraboloid.
Weighted delaunay_weights(const Eigen::Matrix2Xd& places) {
  Weighted best;
  double least = std::numeric_limits<double>::infinity();
  const int count = static_cast<int>(places.cols());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      for (int c = b + 1; c < count; ++c) {
        Eigen::Matrix2d sides;
        sides << places.col(b) - places.col(a), places.col(c) - places.col(a);
        const double area = sides.determinant();
        if (area == 0) continue;
        const Eigen::Vector2d w = sides.inverse() * -places.col(a);
        const double first = 1 - w.sum();
        if (!(w.minCoeff() >= kInside) || !(first >= kInside)) continue;
        const double lift = first * places.col(a).squaredNorm() +
                            w(0) * places.col(b).squaredNorm() + w(1) * places.col(c).squaredNorm();
        if (!(lift < least)) continue;
        least = lift;
        best = {{a, b, c}, {std::max(first, 0.0), std::max(w(0), 0.0), std::max(w(1), 0.0)}, 3};
      }
    }
  }
  if (best.count > 0) return best;
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      const Eigen::Vector2d side = places.col(b) - places.col(a);
      const double square = side.squaredNorm();
      const double w = square > 0 ? std::clamp(-side.dot(places.col(a)) / square, 0.0, 1.0) : 0;
      const double distance = (places.col(a) + w * side).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      best = {{a, b, 0}, {1 - w, w, 0}, a == b ? 1 : 2};
    }
  }
  return best;
}

// Up to kCorners contacts around one, the nearest first.
std::vector<int> contacts_around(const Model& model,
                                 const std::vector<std::vector<int>>& neighbours,
                                 std::size_t self) {
  std::set<int> found;
  for (const int one : neighbours[self]) {
    found.insert(one);
    for (const int other : neighbours[static_cast<std::size_t>(one)]) found.insert(other);
  }
  found.erase(static_cast<int>(self));
  std::vector<std::pair<double, int>> nearest;
  for (const int other : found) {
    const Eigen::Vector3d& there = model.contacts[static_cast<std::size_t>(other)].position;
    nearest.emplace_back((there - model.contacts[self].position).squaredNorm(), other);
  }
  std::ranges::sort(nearest);
  if (nearest.size() > kCorners) nearest.resize(kCorners);
  std::vector<int> result;
  for (const auto& [square, other] : nearest) result.push_back(other);
  return result;
}

Surroundings without(const Surroundings& around, int contact) {
  Surroundings rest;
  std::vector<Eigen::Index> kept;
  for (std::size_t j = 0; j < around.contacts.size(); ++j) {
    if (around.contacts[j] == contact) continue;
    rest.contacts.push_back(around.contacts[j]);
    kept.push_back(static_cast<Eigen::Index>(j));
  }
  rest.places = around.places(Eigen::all, kept);
  rest.values = around.values(Eigen::all, kept);
  return rest;
}

}  // namespace

LeftOutBlends::LeftOutBlends(const Model& model)
    : model_(model), kriging_(learn_kriging(model)), known_(model.contacts.size(), -1) {
  for (std::size_t k = 0; k < kriging_.known.size(); ++k)
    known_[static_cast<std::size_t>(kriging_.known[k])] = static_cast<int>(k);
}

ContactModel LeftOutBlends::corner_without(int corner, std::size_t contact) const {
  const ContactModel& from = model_.contacts[static_cast<std::size_t>(corner)];
  ContactModel result;
  result.position = from.position;
  result.frame = from.frame;
  result.compliance = from.compliance;
  result.strength = from.strength;
  const int known = known_[static_cast<std::size_t>(corner)];
  if (known < 0) return result;
  const BlendRule rule = model_.interpolation.rule;
  const Eigen::Matrix<double, 6, 5> trend = kriging_trend(
      without(kriging_.around[static_cast<std::size_t>(known)], static_cast<int>(contact)),
      *kriged_value(from, rule), kriging_.covariance);
  if (rule == BlendRule::compliances)
    result.compliance->trend = trend;
  else
    result.strength->trend = trend.row(2);
  return result;
}

std::optional<Blend> LeftOutBlends::at(std::size_t contact) const {
  const BlendRule rule = model_.interpolation.rule;
  const std::vector<int> around = contacts_around(model_, kriging_.neighbours, contact);
  if (around.empty()) return std::nullopt;
  const ContactModel& self = model_.contacts[contact];
  const Eigen::Matrix3d own_frame = kriged_frame(self, rule);
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(around.size()));
  for (std::size_t k = 0; k < around.size(); ++k) {
    const Eigen::Vector3d off =
        model_.contacts[static_cast<std::size_t>(around[k])].position - self.position;
    places.col(static_cast<Eigen::Index>(k)) = own_frame.leftCols<2>().transpose() * off;
  }
  const Weighted weighted = delaunay_weights(places);
  const auto count = static_cast<std::size_t>(weighted.count);
  Blend result;
  result.contacts.count = weighted.count;
  std::vector<ContactModel> corners;
  std::vector<Eigen::Matrix3d> frames;
  bool any = false;
  for (std::size_t k = 0; k < count; ++k) {
    const int index = around[static_cast<std::size_t>(weighted.corners[k])];
    result.contacts.contacts[k] = index;
    result.contacts.weights[k] = weighted.weights[k];
    corners.push_back(corner_without(index, contact));
    frames.push_back(kriged_frame(corners.back(), rule));
    any = any || (weighted.weights[k] > 0 && corners.back().compliance);
  }
  const std::array<int, 3> all{0, 1, 2};
  const std::span indices = std::span(all).first(count);
  const std::span weights = std::span(weighted.weights).first(count);
  const double reach = model_.interpolation.reach;
  if (rule == BlendRule::forces) {
    result.field_frame = blend_rotations(frames, weights);
    const double factor = strength_factor(corners, indices, weights, self.position, reach);
    for (std::size_t k = 0; k < count; ++k) result.warps[k].energy = factor;
    return result;
  }
  result.field_frame = own_frame;
  Compliance here;
  if (any)
    here = compliance_between(corners, frames, indices, weights, self.position, own_frame, reach);
  for (std::size_t k = 0; k < count; ++k) {
    if (corners[k].compliance && any) {
      const Eigen::Matrix2d turn = turn_between(frames[k], own_frame);
      result.warps[k] = warp_between(turned(corners[k].compliance->values, turn), here);
    }
    const Eigen::Matrix3d carry = rotation_between(frames[k].col(2), own_frame.col(2));
    result.warps[k].displacement =
        (carry * corners[k].frame).transpose() * own_frame * result.warps[k].displacement;
  }
  return result;
}

}  // namespace palpate::haptics
