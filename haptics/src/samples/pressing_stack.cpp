// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/pressing_stack.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace palpate::haptics {
namespace {

double matern_at(double distance) {
  const double a = std::sqrt(5.0) * distance;
  return (1 + a + a * a / 3) * std::exp(-a);
}

}  // namespace

Neighbourhood neighbourhood_of(std::span<const CompressedPress> presses,
                               std::span<const PressedContact> contacts,
                               const PressingState& state) {
  Neighbourhood result;
  result.contacts = contacts;
  result.noise_variance = state.noise_variance;
  result.root = Eigen::LLT<Eigen::MatrixXd>(state.covariance).matrixL();
  result.presses.resize(presses.size());
  result.white.resize(presses.size());
  for (std::size_t i = 0; i < presses.size(); ++i) {
    result.presses[i] = linearized(presses[i], state, state.coefficients[i],
                                   expected_tau(state, presses[i].height));
    result.white[i] = result.presses[i].curve * result.root;
  }
  return result;
}

double correlation(const Neighbourhood& all, std::size_t i, std::size_t j, const Spatial& spatial) {
  if (i == j) return 1 + spatial.nugget;
  return matern_at((all.contacts[i].position - all.contacts[j].position).norm() / spatial.length);
}

Stack stack(const Neighbourhood& all, std::span<const std::size_t> members,
            const Spatial& spatial) {
  Stack result;
  result.begin = {0};
  for (const std::size_t i : members)
    result.begin.push_back(result.begin.back() + all.presses[i].force.size());
  const Eigen::Index rows = result.begin.back();
  const Eigen::Index columns = all.presses[members[0]].design.cols();
  result.covariance.resize(rows, rows);
  result.design.resize(rows, columns);
  result.force.resize(rows);
  for (std::size_t a = 0; a < members.size(); ++a) {
    const std::size_t i = members[a];
    const LinearPress& press = all.presses[i];
    const Eigen::Index at = result.begin[a], size = press.force.size();
    result.design.middleRows(at, size) = press.design;
    result.force.segment(at, size) = press.force;
    for (std::size_t b = 0; b <= a; ++b) {
      const std::size_t j = members[b];
      const double factor = spatial.amplitude * correlation(all, i, j, spatial);
      const RowBlock block = factor * all.white[i] * all.white[j].transpose();
      result.covariance.block(at, result.begin[b], size, block.cols()) = block;
    }
    result.covariance.block(at, at, size, size) +=
        spatial.touch_variance * press.touch * press.touch.transpose();
    result.covariance.diagonal().segment(at, size).array() += all.noise_variance;
  }
  return result;
}

Squares& Squares::operator+=(const Squares& other) {
  matrix += other.matrix;
  vector += other.vector;
  fit += other.fit;
  return *this;
}

double profiled_loss(const PressingData& data, const PressingState& state, Squares sum) {
  add_priors(state.variant, data.force_scale, data.bias, sum.matrix, sum.vector);
  return sum.fit - sum.vector.dot(sum.matrix.ldlt().solve(sum.vector)) + touch_prior(state);
}

}  // namespace palpate::haptics
