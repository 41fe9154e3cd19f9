// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// Values of an image as whole multiples of a step, rows x cols, row-major.
using CodeImage = Eigen::Array<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Code of an unknown value in a CodeImage.
inline constexpr std::int32_t kUnknownCode = std::numeric_limits<std::int32_t>::min();
/// Codes are below this in magnitude, so that a difference of two needs three bytes.
inline constexpr std::int32_t kCodeLimit = 1 << 22;

/// Bytes that `pack` needs for a value.
inline constexpr std::size_t kPackedBytes = 3;

using ImageD = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rounds to the nearest whole multiple: |value - step * code| <= step / 2, up to the rounding of
/// the product. A value that is not finite becomes kUnknownCode.
/// \throws InvalidInput unless step > 0, or if a value is kCodeLimit steps or more from zero.
[[nodiscard]] CodeImage codes_of(const Eigen::Ref<const ImageD>& values, double step);

/// The largest of 1, 2 and 5 times a power of ten that is at most `most`: a step that is short to
/// state.
/// \throws InvalidInput unless most > 0 and finite.
[[nodiscard]] double round_step(double most);

/// Writes codes as bytes that compress well if neighbours are alike: three for each code, first the
/// low bytes of all, then the middle, then the high ones. They encode 0 for an unknown code, and
/// otherwise 1 + 2 d for a difference d >= 0 from the predicted code, -2 d for d < 0. The
/// prediction is the median of left, above, and left + above - above left; if not all are known,
/// left, or else above, or else the last known code, at first 0. No information is lost.
/// \throws InvalidInput if a code is not below kCodeLimit in magnitude.
[[nodiscard]] std::vector<std::byte> pack(const CodeImage& codes);

/// Returns the codes from which `pack` made the bytes.
/// \throws InvalidInput if the size is negative, there are not kPackedBytes for each code, or they
/// are not those of `pack`.
[[nodiscard]] CodeImage unpack(std::span<const std::byte> bytes, Eigen::Index rows,
                               Eigen::Index cols);

}  // namespace palpate::geometry
