// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/align_frames.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <complex>
#include <set>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

using Complex = std::complex<double>;

// Shift of the Laplacian, relative to its mean diagonal, that makes it definite. Inverse iteration
// then converges in about ten steps, and in kIterations the amplitudes of unconnected parts differ
// by less than a factor of 1e100, so that none underflows.
constexpr double kShift = 1e-3;
constexpr int kIterations = 30;

std::set<std::pair<int, int>> edges(const Eigen::Matrix3Xi& triangles) {
  std::set<std::pair<int, int>> result;
  for (const auto& t : triangles.colwise()) {
    for (int k = 0; k < 3; ++k) result.insert(std::minmax({t[k], t[(k + 1) % 3]}));
  }
  return result;
}

// exp(i angle) of the direction in `to` of the x axis of `from`, after the smallest rotation that
// aligns the z axes.
Complex transport(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  const Eigen::Vector3d x = rotation_between(from.col(2), to.col(2)) * from.col(0);
  const Complex direction(to.col(0).dot(x), to.col(1).dot(x));
  return direction / std::abs(direction);
}

Eigen::SparseMatrix<Complex> connection_laplacian(const Model& model) {
  const auto size = static_cast<Eigen::Index>(model.contacts.size());
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size);
  std::vector<Eigen::Triplet<Complex>> entries;
  for (const auto& [i, j] : edges(model.triangles)) {
    const Complex turn = transport(model.contacts[static_cast<std::size_t>(i)].frame,
                                   model.contacts[static_cast<std::size_t>(j)].frame);
    entries.emplace_back(j, i, -turn);
    entries.emplace_back(i, j, -std::conj(turn));
    diagonal[i] += 1;
    diagonal[j] += 1;
  }
  const double shift = kShift * diagonal.mean();
  for (Eigen::Index i = 0; i < size; ++i) entries.emplace_back(i, i, diagonal[i] + shift);
  Eigen::SparseMatrix<Complex> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

void align_frames(Model& model) {
  if (model.triangles.cols() == 0) return;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<Complex>> solver(connection_laplacian(model));
  if (solver.info() != Eigen::Success) {
    throw SolverError(
        "the frames of the contacts could not be aligned: their connection Laplacian "
        "is not definite");
  }
  const auto size = static_cast<Eigen::Index>(model.contacts.size());
  Eigen::VectorXcd directions = Eigen::VectorXcd::Ones(size);
  for (int i = 0; i < kIterations; ++i) {
    directions = solver.solve(directions).eval();
    directions /= directions.norm();
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    ContactModel& contact = model.contacts[static_cast<std::size_t>(i)];
    const Eigen::Matrix3d turn = rotation_exp({0, 0, std::arg(directions[i])});
    contact.frame = contact.frame * turn;
    contact.field = rotated(std::move(contact.field), turn.transpose());
  }
}

}  // namespace palpate::haptics
