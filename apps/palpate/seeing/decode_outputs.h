// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/decode.h"

namespace palpate::apps {

/// The files that `decode` writes for each frame, and their folder: data as TIFF and meshes,
/// pictures as PNG.
struct DecodeOutputs {
  std::filesystem::path folder;
  std::string meshes;     ///< file extension without the dot, pcd for points; empty for none
  bool color = false;     ///< NNNNNN_color.png, and colours of the meshes
  bool sigma = false;     ///< NNNNNN_sigma.tiff
  bool noise = false;     ///< NNNNNN_noise.tiff; only if the rig has a covariance
  bool reasons = false;   ///< NNNNNN_reasons.tiff
  bool pictures = false;  ///< NNNNNN.png, and a picture of each of the images above
};

/// The file of frame `number`: folder/NNNNNN followed by `ending`.
[[nodiscard]] std::filesystem::path numbered(const std::filesystem::path& folder,
                                             std::size_t number, const std::string& ending);

/// Returns true for a name of the kind that `numbered` returns.
[[nodiscard]] bool is_numbered(const std::filesystem::path& name);

/// Writes the data of a frame. A frame without a surface has no mesh.
/// \param color of the surface, 8 bit, BGR or grey, of the range map's size; empty unless
/// `outputs.color`.
/// \throws OutputError if a file cannot be written.
void write_outputs(const DecodeOutputs& outputs, std::size_t number,
                   const sensing::DecodeResult& result, const cv::Mat& color = {});

/// Draws the pictures of a frame, if there are to be any. A frame without a depth has only that of
/// its reasons.
/// \throws OutputError if a picture cannot be drawn.
void draw_outputs(const DecodeOutputs& outputs, std::size_t number,
                  const sensing::DecodeResult& result, const std::string& title);

/// The outputs of a frame, as endings of `numbered`: data, and then pictures.
/// \param has_surface true if the frame has a depth, and thus a mesh and pictures of the depths.
struct OutputEndings {
  std::vector<std::string> data, pictures;
};
[[nodiscard]] OutputEndings output_endings(const DecodeOutputs& outputs, bool has_surface);

/// Returns true if all data and pictures of a frame exist.
/// \param has_surface true if the frame has a depth, and thus a mesh and pictures of the depths.
[[nodiscard]] bool has_outputs(const DecodeOutputs& outputs, std::size_t number, bool has_surface);

}  // namespace palpate::apps
