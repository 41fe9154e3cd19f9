// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/exact_predicates.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate::geometry {
namespace {

/// Half the distance from 1 to the next double, as in Shewchuk 1997.
constexpr double kHalfUlp = std::numeric_limits<double>::epsilon() / 2;
constexpr double kBound2 = (3 + 16 * kHalfUlp) * kHalfUlp;
constexpr double kBound3 = (7 + 56 * kHalfUlp) * kHalfUlp;

/// A number as the exact sum of parts that do not overlap, the largest last (Shewchuk 1997); empty
/// for 0.
template <std::size_t kCapacity>
struct Expansion {
  std::array<double, kCapacity> parts;  // not initialised, because few are used
  std::size_t size = 0;

  void append(double part) {
    if (part != 0) parts[size++] = part;
  }
  [[nodiscard]] int sign() const { return size == 0 ? 0 : parts[size - 1] > 0 ? 1 : -1; }
};

/// Returns the rounding error of a sum: a + b = sum + error.
double rest_of_sum(double a, double b, double sum) {
  const double of_b = sum - a, of_a = sum - of_b;
  return (a - of_a) + (b - of_b);
}

Expansion<2> difference(double a, double b) {
  Expansion<2> result;
  const double sum = a - b;
  result.append(rest_of_sum(a, -b, sum));
  result.append(sum);
  return result;
}

template <std::size_t kCapacity, std::size_t kOther>
Expansion<kCapacity + kOther> operator+(const Expansion<kCapacity>& e, const Expansion<kOther>& f) {
  Expansion<kCapacity + kOther> result;
  for (std::size_t i = 0; i < e.size; ++i) result.append(e.parts[i]);
  for (std::size_t i = 0; i < f.size; ++i) {
    double carried = f.parts[i];
    const std::size_t size = result.size;
    result.size = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const double part = result.parts[k], sum = carried + part;
      result.append(rest_of_sum(carried, part, sum));
      carried = sum;
    }
    result.append(carried);
  }
  return result;
}

template <std::size_t kCapacity>
Expansion<2 * kCapacity> scaled(const Expansion<kCapacity>& e, double factor) {
  Expansion<2 * kCapacity> result;
  double carried = 0;
  for (std::size_t i = 0; i < e.size; ++i) {
    const double high = e.parts[i] * factor, low = std::fma(e.parts[i], factor, -high);
    const double sum = carried + low;
    result.append(rest_of_sum(carried, low, sum));
    carried = high + sum;
    result.append(rest_of_sum(high, sum, carried));
  }
  result.append(carried);
  return result;
}

template <std::size_t kCapacity>
Expansion<4 * kCapacity> operator*(const Expansion<kCapacity>& e, const Expansion<2>& f) {
  Expansion<2 * kCapacity> low, high;
  if (f.size > 0) low = scaled(e, f.parts[0]);
  if (f.size > 1) high = scaled(e, f.parts[1]);
  return low + high;
}

template <std::size_t kCapacity>
Expansion<kCapacity> operator-(Expansion<kCapacity> e) {
  for (std::size_t i = 0; i < e.size; ++i) e.parts[i] = -e.parts[i];
  return e;
}

int sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

int exact_orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  const auto minor = [&d](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return difference(p[0], d[0]) * difference(q[1], d[1]) +
           -(difference(q[0], d[0]) * difference(p[1], d[1]));
  };
  return (minor(b, c) * difference(a[2], d[2]) + minor(c, a) * difference(b[2], d[2]) +
          minor(a, b) * difference(c[2], d[2]))
      .sign();
}

}  // namespace

int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                const Eigen::Vector3d& d) {
  const Eigen::Vector3d p = a - d, q = b - d, r = c - d;
  const double qr = q[0] * r[1], rq = r[0] * q[1];
  const double rp = r[0] * p[1], pr = p[0] * r[1];
  const double pq = p[0] * q[1], qp = q[0] * p[1];
  const double determinant = p[2] * (qr - rq) + q[2] * (rp - pr) + r[2] * (pq - qp);
  const double size = (std::abs(qr) + std::abs(rq)) * std::abs(p[2]) +
                      (std::abs(rp) + std::abs(pr)) * std::abs(q[2]) +
                      (std::abs(pq) + std::abs(qp)) * std::abs(r[2]);
  if (std::abs(determinant) > kBound3 * size || size == 0) return sign_of(determinant);
  return exact_orientation(a, b, c, d);
}

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]);
  const double determinant = left - right, size = std::abs(left) + std::abs(right);
  if (std::abs(determinant) > kBound2 * size || size == 0) return sign_of(determinant);
  return (difference(a[0], c[0]) * difference(b[1], c[1]) +
          -(difference(a[1], c[1]) * difference(b[0], c[0])))
      .sign();
}

}  // namespace palpate::geometry
