// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "palpate/sensing/board_views.h"

namespace palpate::sensing {

struct RigViewFiles {
  ImageSize camera;            ///< size of the images
  std::vector<RigView> views;  ///< one per pose, named after its folder
};

/// Reads the poses of a board from folders of images (PNG, TIFF or JPEG).
///
/// Each folder is one pose; a folder of folders stands for the poses in it, sorted by name. A pose
/// has either two images named `board` and `projected` (`view_from_still`), or the images of a Gray
/// code sequence (`view_from_gray_code`), whose names sort in projection order; numbers in names
/// are compared as numbers.
/// \param on_view if given, is called after each pose with the number of poses done and in all.
/// \throws FileError naming the folder or the file if it is empty, not an image, of another size
/// than the rest, or if the number of images differs from the length of the projector's Gray code.
/// \throws InvalidInput as `view_from_still` and `view_from_gray_code`.
[[nodiscard]] RigViewFiles read_rig_views(const std::vector<std::filesystem::path>& folders,
                                          const Board& printed, const ImageSize& projector,
                                          const BoardViewOptions& options = {},
                                          const std::function<void(int, int)>& on_view = {});

/// Writes the images that the projector has to show for `read_rig_views`: graycode_00.png ... in
/// the order of `draw_gray_code`, and projected.png, the still image of `view_from_still`.
/// \return number of images of the Gray code.
/// \throws InvalidInput if the panel is too small or too large.
/// \throws OutputError if a file cannot be written.
int write_projector_images(const std::filesystem::path& folder, const ImageSize& projector,
                           const Board& printed);

}  // namespace palpate::sensing
