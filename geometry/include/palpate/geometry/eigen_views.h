// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

/// Views of the same numbers in the shapes of other libraries, without a copy. A view is valid as
/// long as its matrix or list is neither moved nor resized.
namespace palpate::geometry {

/// N x 3, row-major, with a point or a triangle per row: the shape of NumPy arrays.
template <class Scalar>
using Rows3 = Eigen::Matrix<Scalar, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// The columns of a 3 x N matrix as rows; writing to the view writes to the matrix.
template <class Scalar>
[[nodiscard]] Eigen::Map<Rows3<Scalar>> as_rows(
    Eigen::Matrix<Scalar, 3, Eigen::Dynamic>& columns) noexcept {
  return {columns.data(), columns.cols(), 3};
}
template <class Scalar>
[[nodiscard]] Eigen::Map<const Rows3<Scalar>> as_rows(
    const Eigen::Matrix<Scalar, 3, Eigen::Dynamic>& columns) noexcept {
  return {columns.data(), columns.cols(), 3};
}

/// The rows of an N x 3 matrix as columns, the shape of points in this library.
template <class Scalar>
[[nodiscard]] Eigen::Map<Eigen::Matrix<Scalar, 3, Eigen::Dynamic>> as_columns(
    Rows3<Scalar>& rows) noexcept {
  return {rows.data(), 3, rows.rows()};
}
template <class Scalar>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<Scalar, 3, Eigen::Dynamic>> as_columns(
    const Rows3<Scalar>& rows) noexcept {
  return {rows.data(), 3, rows.rows()};
}

/// A list of points or triangles, as in Open3D, as columns.
template <class Scalar, class Allocator>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<Scalar, 3, Eigen::Dynamic>> as_columns(
    const std::vector<Eigen::Matrix<Scalar, 3, 1>, Allocator>& list) noexcept {
  static_assert(sizeof(list[0]) == 3 * sizeof(Scalar));
  return {list.empty() ? nullptr : list.front().data(), 3, static_cast<Eigen::Index>(list.size())};
}

}  // namespace palpate::geometry
