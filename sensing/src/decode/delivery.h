// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decode/workspace.h"

namespace palpate::sensing {

/// Finds the reasons of the whole working image as if no part of it had been decoded.
void find_reasons_around(Workspace& work);

/// Writes an image of the part into the result's image of the frame. If the part is all of it, they
/// exchange their memory.
/// \param around of the size of the working image.
template <typename Image, typename Around>
void deliver(Image& image, const Workspace& work, const Around& around, bool transposed,
             Image& result) {
  const ImagePart& part = work.part;
  if (work.part_model && transposed) {
    result = around.transpose();
    result.block(part.column, part.row, part.columns, part.rows) = image.transpose();
  } else if (work.part_model) {
    result = around;
    result.block(part.row, part.column, part.rows, part.columns) = image;
  } else if (transposed) {
    result = image.transpose();
  } else {
    result.swap(image);
  }
}

}  // namespace palpate::sensing
