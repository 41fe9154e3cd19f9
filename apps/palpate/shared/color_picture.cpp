// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/color_picture.h"

#include <fmt/format.h>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/rig.h"
#include "shared/surface_colors.h"

namespace palpate::apps {

geometry::Attributes colors_beside(const std::filesystem::path& range_map,
                                   const Eigen::Matrix3Xd& vertices, const MapCamera& camera) {
  const std::filesystem::path file =
      range_map.parent_path() / (range_map.stem().string() + "_color.png");
  if (!is_range_map(range_map) || !is_there(file)) {
    throw FileError(file.string() +
                    ": missing. --color needs the colour of the surface, which palpate decode "
                    "--surface-color writes beside the range map.");
  }
  const cv::Mat color = sensing::read_frame(file);
  const geometry::Camera seen_by = sensing::read_camera(rig_of(range_map, camera.rig));
  if (color.depth() != CV_8U || color.cols != seen_by.width || color.rows != seen_by.height) {
    throw FileError(
        fmt::format("{}: is {} x {} px of {} bit; 8 bit and the size of the range map, "
                    "{} x {} px, are expected",
                    file.string(), color.cols, color.rows, 8 * color.elemSize1(), seen_by.width,
                    seen_by.height));
  }
  return colors_of(vertices, seen_by, color);
}

}  // namespace palpate::apps
