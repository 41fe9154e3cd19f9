// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "palpate/core/error.h"

namespace palpate::python {
namespace {

/// "(4, 3)"
std::string shape_of(const py::array& array) { return py::str(py::tuple(array.attr("shape"))); }

[[noreturn]] void refuse(const char* name, const std::string& what) {
  throw InvalidInput(std::string(name) + ": " + what);
}

/// Anything that NumPy makes an array of, without conversion of its type.
py::array any_array(py::handle object, const char* name) {
  // NumPy would drop the mask, and take what it hides for numbers.
  if (py::hasattr(object, "mask") && py::hasattr(object, "filled"))
    refuse(name, "is a masked array; pass its .filled(numpy.nan), or what is not masked");
  py::array array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    refuse(name, std::string("is not an array of numbers but ") +
                     std::string(py::str(py::type::of(object).attr("__name__"))));
  }
  return array;
}

/// \param kinds of NumPy's types: b bool, i and u whole numbers, f floating.
void check_type(const py::array& array, const char* name, std::string_view kinds,
                const char* right) {
  if (kinds.find(array.dtype().kind()) == std::string_view::npos) {
    refuse(name, "its type is " + std::string(py::str(array.dtype())) + "; it must be " + right);
  }
}

std::string place_in(const py::array& array, py::ssize_t index) {
  std::string place = "]";
  for (py::ssize_t d = array.ndim() - 1; d >= 0; --d) {
    place.insert(0, (d > 0 ? ", " : "[") + std::to_string(index % array.shape(d)));
    index /= array.shape(d);
  }
  return place;
}

bool is_index(std::int64_t number) {
  return number >= 0 && number <= std::numeric_limits<int>::max();
}
bool is_index(std::uint64_t number) { return number <= std::numeric_limits<int>::max(); }
bool is_index(double number) {
  return number >= 0 && number <= std::numeric_limits<int>::max() && number == std::floor(number);
}

template <typename Number>
py::array_t<int> checked_indices(const py::array& array, const char* name) {
  const auto numbers =
      py::array_t<Number, py::array::c_style | py::array::forcecast>::ensure(array);
  py::array_t<int> result(std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()));
  int* out = result.mutable_data();
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const Number number = numbers.data()[i];
    if (!is_index(number)) {
      refuse(name, place_in(array, i) + " is " + std::string(py::str(py::cast(number))) +
                       "; it must be a whole number from 0 to 2147483647");
    }
    out[i] = static_cast<int>(number);
  }
  return result;
}

}  // namespace

py::array_t<double> real_numbers(py::handle object, const char* name) {
  const py::array array = any_array(object, name);
  check_type(array, name, "biuf", "real numbers");
  constexpr int kAligned = py::detail::npy_api::NPY_ARRAY_ALIGNED_;
  return py::array_t<double, py::array::c_style | py::array::forcecast | kAligned>::ensure(array);
}

Points::Points(py::handle object, const char* name) : array_(real_numbers(object, name)) {
  if (array_.ndim() == 2 && array_.shape(1) == 3) return;
  std::string hint;
  if (array_.ndim() == 1 && array_.size() == 3) hint = ": one point is a list of one, [[x, y, z]]";
  if (array_.ndim() == 2 && array_.shape(0) == 3) hint = ": transpose it";
  refuse(name, "its shape is " + shape_of(array_) + "; it must be (N, 3)" + hint);
}

Eigen::Vector3d vector3(py::handle object, const char* name) {
  // The usual case without the generic conversion, which takes longer than a tick.
  if (Py_TYPE(object.ptr()) == py::detail::npy_api::get().PyArray_Type_ &&
      py::isinstance<py::array_t<double>>(object)) {
    const auto array = py::reinterpret_borrow<py::array_t<double>>(object);
    if (array.ndim() == 1 && array.shape(0) == 3) return {array.at(0), array.at(1), array.at(2)};
  }
  const py::array_t<double> numbers = real_numbers(object, name);
  if (numbers.ndim() != 1 || numbers.size() != 3)
    refuse(name, "its shape is " + shape_of(numbers) + "; it must be (3,)");
  return Eigen::Vector3d(numbers.data());
}

Eigen::Isometry3d isometry(py::handle pose, const char* name) {
  if (pose.is_none()) return Eigen::Isometry3d::Identity();
  const py::array_t<double> numbers = real_numbers(pose, name);
  const bool fits = numbers.ndim() == 2 && numbers.shape(0) == 4 && numbers.shape(1) == 4;
  if (!fits) throw InvalidInput(std::string(name) + ": must be a matrix of shape (4, 4)");
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  // The same as in files: rounding of six printed digits.
  constexpr double kRotationTolerance = 1e-6;
  const double off =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).lpNorm<Eigen::Infinity>();
  if (!matrix.allFinite() || off > kRotationTolerance || rotation.determinant() < 0 ||
      matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw InvalidInput(std::string(name) +
                       ": must be finite, a rotation and a translation, with 0 0 0 1 below");
  }
  return Eigen::Isometry3d(matrix);
}

py::array_t<int> indices(py::handle object, const char* name, int dimensions) {
  const py::array array = any_array(object, name);
  if (array.size() > 0) check_type(array, name, "iuf", "whole numbers");
  if (array.ndim() != dimensions || (dimensions == 2 && array.shape(1) != 3)) {
    refuse(name, "its shape is " + shape_of(array) + "; it must be " +
                     (dimensions == 2 ? "(N, 3)" : "(N,)"));
  }
  switch (array.dtype().kind()) {
    case 'u':
      return checked_indices<std::uint64_t>(array, name);
    case 'f':
      return checked_indices<double>(array, name);
    default:
      return checked_indices<std::int64_t>(array, name);
  }
}

geometry::ImageF image(py::handle object, const char* name) {
  const py::array array = any_array(object, name);
  check_type(array, name, "biuf", "real numbers");
  if (array.ndim() != 2) {
    refuse(name, "its shape is " + shape_of(array) + "; it must be (rows, columns)");
  }
  const auto depths = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(array);
  return Eigen::Map<const geometry::ImageF>(depths.data(), depths.shape(0), depths.shape(1));
}

}  // namespace palpate::python
