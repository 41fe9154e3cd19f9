// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The mean of touches, how it follows heights, and the parameters of an acquisition.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "palpate/core/parallel_for.h"
#include "samples/pressing_stack.h"

namespace palpate::haptics {
namespace {

// Largest number of contacts in one covariance, and of such blocks.
constexpr std::size_t kMostInBlock = 100, kMostBlocks = 6;
// Steps of the differences: of the mean of tau, and of its slope.
constexpr double kTouchStepThere = 0.005, kSlopeStepThere = 0.05;
// A Newton step moves by at most this number of such steps.
constexpr double kMostSteps = 5;
constexpr int kTouchRounds = 4;
// The search ends when it moves by less than this share of the errors.
constexpr double kSmallMove = 0.1;

// Halves contacts across their longest extent until each part fits in one block.
void add_blocks(std::span<const PressedContact> contacts, std::vector<std::size_t> members,
                std::vector<std::vector<std::size_t>>& blocks) {
  if (members.size() <= kMostInBlock) {
    std::ranges::sort(members);
    blocks.push_back(std::move(members));
    return;
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t i : members) mean += contacts[i].position;
  mean /= static_cast<double>(members.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const std::size_t i : members) {
    const Eigen::Vector3d off = contacts[i].position - mean;
    scatter += off * off.transpose();
  }
  // Principal axes do not depend on the frame.
  const Eigen::Vector3d axis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(2);
  const auto middle = members.begin() + static_cast<std::ptrdiff_t>(members.size() / 2);
  std::nth_element(members.begin(), middle, members.end(), [&](std::size_t a, std::size_t b) {
    return axis.dot(contacts[a].position) < axis.dot(contacts[b].position);
  });
  add_blocks(contacts, {members.begin(), middle}, blocks);
  add_blocks(contacts, {middle, members.end()}, blocks);
}

std::vector<std::vector<std::size_t>> blocks_of(std::span<const PressedContact> contacts) {
  std::vector<std::size_t> all(contacts.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> blocks, some;
  add_blocks(contacts, std::move(all), blocks);
  const std::size_t stride = (blocks.size() + kMostBlocks - 1) / kMostBlocks;
  for (std::size_t b = 0; b < blocks.size(); b += stride) some.push_back(std::move(blocks[b]));
  return some;
}

Squares squares_of(const Neighbourhood& all, std::span<const std::size_t> members,
                   const Spatial& spatial) {
  const Stack data = stack(all, members, spatial);
  const Eigen::LLT<Eigen::MatrixXd> factor(data.covariance);
  Eigen::MatrixXd both(data.force.size(), data.design.cols() + 1);
  both << data.design, data.force;
  factor.matrixL().solveInPlace(both);
  const auto design = both.leftCols(data.design.cols());
  const auto force = both.rightCols<1>();
  return {design.transpose() * design, design.transpose() * force,
          force.squaredNorm() + 2 * factor.matrixLLT().diagonal().array().log().sum()};
}

class Offsets {
 public:
  Offsets(const PressingData& data, const Spatial& spatial)
      : data_(data), spatial_(spatial), blocks_(blocks_of(data.contacts)) {}

  [[nodiscard]] Squares sum(const PressingState& state) const {
    const Neighbourhood all = neighbourhood_of(data_.presses, data_.contacts, state);
    std::vector<Squares> parts(blocks_.size());
    parallel_for(blocks_.size(),
                 [&](std::size_t b) { parts[b] = squares_of(all, blocks_[b], spatial_); });
    for (std::size_t b = 1; b < parts.size(); ++b) parts[0] += parts[b];
    return std::move(parts[0]);
  }
  /// -2 log likelihood of the mean of tau and its slope.
  [[nodiscard]] double loss(PressingState state, const Eigen::Vector2d& at) const {
    state.touch = at(0);
    state.height_slope = at(1);
    return profiled_loss(data_, state, sum(state));
  }
  [[nodiscard]] Eigen::VectorXd parameters(const PressingState& state,
                                           Eigen::MatrixXd* covariance) const {
    Squares squares = sum(state);
    add_priors(state.variant, data_.force_scale, data_.bias, squares.matrix, squares.vector);
    const Eigen::LDLT<Eigen::MatrixXd> solver(squares.matrix);
    const Eigen::Index size = squares.vector.size();
    if (covariance) *covariance = solver.solve(Eigen::MatrixXd::Identity(size, size));
    return solver.solve(squares.vector);
  }

 private:
  const PressingData& data_;
  const Spatial& spatial_;
  std::vector<std::vector<std::size_t>> blocks_;
};

// The parameters, with the part of their errors that comes from the mean of tau and its slope.
void solve_parameters(const Offsets& offsets, PressingState& state) {
  state.parameters = offsets.parameters(state, &state.parameter_covariance);
  if (!state.variant.touch) return;
  const Eigen::Matrix2d& covariance = state.touch_covariance;
  if (!covariance.allFinite() || !(covariance(0, 0) > 0)) return;
  Eigen::Matrix2d root = Eigen::Matrix2d::Zero();
  root(0, 0) = std::sqrt(covariance(0, 0));
  root(1, 0) = covariance(1, 0) / root(0, 0);
  root(1, 1) = std::sqrt(std::max(covariance(1, 1) - root(1, 0) * root(1, 0), 0.0));
  for (int k = 0; k < (state.variant.height ? 2 : 1); ++k) {
    PressingState moved = state;
    moved.touch += root(0, k);
    moved.height_slope += root(1, k);
    const Eigen::VectorXd change = offsets.parameters(moved, nullptr) - state.parameters;
    state.parameter_covariance += change * change.transpose();
  }
}

}  // namespace

void fit_offsets(const PressingData& data, const Spatial& spatial, PressingState& state) {
  if (!state.variant.touch) return;
  const Offsets offsets(data, spatial);
  const Eigen::Vector2d steps(kTouchStepThere, state.variant.height ? kSlopeStepThere : 0);
  const Eigen::Index count = state.variant.height ? 2 : 1;
  Eigen::Vector2d at(state.touch, state.height_slope);
  for (int round = 0; round < kTouchRounds; ++round) {
    const double here = offsets.loss(state, at);
    std::array<double, 2> up{}, down{};
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    Eigen::Matrix2d curvature = Eigen::Matrix2d::Identity();
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Vector2d step = steps(k) * Eigen::Vector2d::Unit(k);
      const auto axis = static_cast<std::size_t>(k);
      up[axis] = offsets.loss(state, at + step);
      down[axis] = offsets.loss(state, at - step);
      slope(k) = (up[axis] - down[axis]) / (2 * steps(k));
      curvature(k, k) = (up[axis] - 2 * here + down[axis]) / (steps(k) * steps(k));
    }
    if (count == 2) {
      curvature(0, 1) = curvature(1, 0) =
          (offsets.loss(state, at + steps) - up[0] - up[1] + here) / steps.prod();
    }
    const Eigen::LLT<Eigen::Matrix2d> factor(curvature);
    if (factor.info() != Eigen::Success) {
      // Not near the minimum: one step down.
      for (Eigen::Index k = 0; k < count; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        at(k) += std::min(up[axis], down[axis]) < here
                     ? (up[axis] < down[axis] ? steps(k) : -steps(k))
                     : 0;
      }
      continue;
    }
    state.touch_covariance = 2 * factor.solve(Eigen::Matrix2d::Identity());
    if (count == 1) state.touch_covariance.bottomRightCorner<1, 1>().setZero();
    Eigen::Vector2d move = -factor.solve(slope);
    double longest = 1;
    for (Eigen::Index k = 0; k < count; ++k)
      longest = std::max(longest, std::abs(move(k)) / (kMostSteps * steps(k)));
    move /= longest;
    while (move.norm() > 0 && !(offsets.loss(state, at + move) <= here) &&
           move.dot(curvature * move) > kSmallMove * kSmallMove)
      move /= 2;
    at += move;
    if (move.dot(curvature * move) < 2 * kSmallMove * kSmallMove) break;
  }
  state.touch = at(0);
  state.height_slope = at(1);
}

void fit_parameters(const PressingData& data, const Spatial& spatial, PressingState& state) {
  solve_parameters(Offsets(data, spatial), state);
}

}  // namespace palpate::haptics
