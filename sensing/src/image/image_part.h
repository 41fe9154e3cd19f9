// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"

namespace palpate::sensing {

/// A rectangle of an image [px].
struct ImagePart {
  long row = 0;  ///< first
  long column = 0;
  long rows = 0;
  long columns = 0;

  [[nodiscard]] bool is_whole(const Mask& image) const {
    return rows == image.rows() && columns == image.cols();
  }
};

/// Parts begin at multiples of this [px].
inline constexpr long kPartSpacing = 16;

/// The part of a plane or a mask.
template <typename Image>
[[nodiscard]] auto part_of(const Image& image, const ImagePart& part) {
  return image.block(part.row, part.column, part.rows, part.columns);
}

/// The smallest part that contains all lit places and `margin` pixels around them. Single pixels,
/// which noise lights anywhere, do not count. It is the whole image if that is hardly larger, and
/// one block if nothing is lit.
[[nodiscard]] ImagePart lit_part(const Mask& lit, long margin);

}  // namespace palpate::sensing
