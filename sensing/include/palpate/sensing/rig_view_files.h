// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "palpate/sensing/board_views.h"

namespace palpate::sensing {

struct RigViewFiles {
  ImageSize camera;            ///< of the images
  std::vector<RigView> views;  ///< one a pose, named after its folder
};

/// Reads the poses of a board from folders of images (PNG, TIFF or JPEG).
///
/// Each folder is one pose; a folder of folders stands for the poses in it, by name. A pose has
/// either two images named `board` and `projected` (`view_from_still`), or those of a Gray code
/// sequence in projection order (`view_from_gray_code`), which the names give; numbers in them
/// count as numbers. `on_view`, if given, is called after each pose with how many are done and in
/// all. \throws FileError naming the folder or the file: nothing there, not an image, another size
/// than the rest, another number of images than the projector's Gray code has; InvalidInput as the
/// functions above.
[[nodiscard]] RigViewFiles read_rig_views(const std::vector<std::filesystem::path>& folders,
                                          const Board& printed, const ImageSize& projector,
                                          const BoardViewOptions& options = {},
                                          const std::function<void(int, int)>& on_view = {});

/// Writes what the projector has to show for `read_rig_views`: graycode_00.png ... in the order of
/// `draw_gray_code`, and projected.png, the still image of `view_from_still`.
/// \return how many images the Gray code has.
/// \throws InvalidInput if the panel is too small or too large; OutputError.
int write_projector_images(const std::filesystem::path& folder, const ImageSize& projector,
                           const Board& printed);

}  // namespace palpate::sensing
