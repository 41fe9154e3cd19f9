// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <utility>
#include <vector>

#include "palpate/geometry/range_map.h"

// Arrays of NumPy as matrices of Eigen, and back. An array of N x 3 numbers, row by row, has the
// same numbers in the same order as the 3 x N matrix, column by column, of this library.
namespace palpate::python {

namespace py = pybind11;

/// Real numbers as a C-contiguous, aligned array of native float64. The array itself if it is one,
/// otherwise a copy. \throws InvalidInput naming the argument, unless it holds real numbers.
[[nodiscard]] py::array_t<double> real_numbers(py::handle object, const char* name);

/// [mm] An argument of shape (N, 3), seen as 3 x N without a copy if `real_numbers` makes none.
class Points {
 public:
  /// \throws InvalidInput naming the argument, its shape or type, and what it must be.
  Points(py::handle object, const char* name);
  [[nodiscard]] Eigen::Map<const Eigen::Matrix3Xd> columns() const {
    return {array_.data(), 3, array_.shape(0)};
  }

 private:
  py::array_t<double> array_;
};

/// A vector of three numbers: an array, tuple or list. \throws InvalidInput
[[nodiscard]] Eigen::Vector3d vector3(py::handle object, const char* name);

/// A rigid motion: an array of shape (4, 4), or the identity for None. \throws InvalidInput
[[nodiscard]] Eigen::Isometry3d isometry(py::handle pose, const char* name);

/// Whole numbers from 0 to 2^31 - 1 of the given number of dimensions, of any type that holds whole
/// numbers; also of a floating type, if they are whole. \throws InvalidInput naming the first
/// number that is not.
[[nodiscard]] py::array_t<int> indices(py::handle object, const char* name, int dimensions);

/// Depths of shape (rows, columns) in any real type, rounded to float32. \throws InvalidInput
[[nodiscard]] geometry::ImageF image(py::handle object, const char* name);

/// The access of a view: writeable views change the memory that they show.
enum class View { writeable, read_only };

/// A view of memory that `owner` keeps alive, of the given shape and strides in bytes.
template <typename Scalar>
[[nodiscard]] py::array view(const Scalar* data, std::vector<py::ssize_t> shape,
                             std::vector<py::ssize_t> strides, py::handle owner,
                             View access = View::writeable) {
  py::array array(py::dtype::of<Scalar>(), std::move(shape), std::move(strides), data, owner);
  if (access == View::read_only) {
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  }
  return array;
}

/// A 3 x N matrix as (N, 3).
template <typename Scalar>
[[nodiscard]] py::array rows_view(const Eigen::Matrix<Scalar, 3, Eigen::Dynamic>& matrix,
                                  py::handle owner, View access = View::writeable) {
  constexpr auto kSize = static_cast<py::ssize_t>(sizeof(Scalar));
  return view(matrix.data(), {matrix.cols(), 3}, {3 * kSize, kSize}, owner, access);
}

/// A vector of numbers as (N,).
template <typename Scalar>
[[nodiscard]] py::array vector_view(const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& vector,
                                    py::handle owner) {
  return view(vector.data(), {vector.size()}, {static_cast<py::ssize_t>(sizeof(Scalar))}, owner);
}
template <typename Scalar>
[[nodiscard]] py::array vector_view(const std::vector<Scalar>& vector, py::handle owner) {
  return view(vector.data(), {static_cast<py::ssize_t>(vector.size())},
              {static_cast<py::ssize_t>(sizeof(Scalar))}, owner);
}

/// An image as (rows, columns).
template <typename Scalar>
[[nodiscard]] py::array image_view(
    const Eigen::Array<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& pixels,
    py::handle owner) {
  constexpr auto kSize = static_cast<py::ssize_t>(sizeof(Scalar));
  return view(pixels.data(), {pixels.rows(), pixels.cols()}, {pixels.cols() * kSize, kSize}, owner);
}

/// A matrix that becomes the array's own, without a copy of its numbers.
template <typename Scalar>
[[nodiscard]] py::array own_rows(Eigen::Matrix<Scalar, 3, Eigen::Dynamic>&& matrix) {
  using Matrix = Eigen::Matrix<Scalar, 3, Eigen::Dynamic>;
  auto kept = std::make_unique<Matrix>(std::move(matrix));
  const py::capsule owner(kept.get(), [](void* held) { delete static_cast<Matrix*>(held); });
  return rows_view(*kept.release(), owner);
}

/// A small matrix of fixed size, copied, row by row as NumPy prints it.
template <typename Derived>
[[nodiscard]] py::array copy_of(const Eigen::MatrixBase<Derived>& matrix) {
  py::array_t<double> array({matrix.rows(), matrix.cols()});
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      array.mutable_at(row, column) = matrix(row, column);
  }
  return array;
}

/// A vector of three numbers as (3,), copied.
[[nodiscard]] inline py::array copy_of(const Eigen::Vector3d& vector) {
  return py::array_t<double>(3, vector.data());
}

/// One vector of each element, as (N, 3), copied.
template <typename Elements, typename Get>
[[nodiscard]] py::array gather_rows(const Elements& elements, Get get) {
  py::array_t<double> array({static_cast<py::ssize_t>(elements.size()), py::ssize_t{3}});
  double* row = array.mutable_data();
  for (const auto& element : elements) {
    Eigen::Map<Eigen::Vector3d>{row} = get(element);
    row += 3;
  }
  return array;
}

/// One number of each element, as (N,), copied.
template <typename Scalar, typename Elements, typename Get>
[[nodiscard]] py::array gather(const Elements& elements, Get get) {
  py::array_t<Scalar> array(static_cast<py::ssize_t>(elements.size()));
  Scalar* number = array.mutable_data();
  for (const auto& element : elements) *number++ = get(element);
  return array;
}

}  // namespace palpate::python
