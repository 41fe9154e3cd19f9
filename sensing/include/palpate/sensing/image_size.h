// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::sensing {

/// Size of a camera's images, or of a projector's panel.
struct ImageSize {
  int width = 0;   ///< px, >= 2
  int height = 0;  ///< px, >= 2
};

}  // namespace palpate::sensing
