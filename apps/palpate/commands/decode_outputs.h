// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/sensing/decode.h"

namespace palpate::apps {

/// What `decode` writes of each frame, into which folder. Data are TIFF and meshes, pictures PNG.
struct DecodeOutputs {
  std::filesystem::path folder;
  std::string meshes;     ///< ending without the dot; empty for none
  bool sigma = false;     ///< NNNNNN_sigma.tiff, NNNNNN_sigma.png
  bool reasons = false;   ///< NNNNNN_reasons.tiff, NNNNNN_reasons.png
  bool pictures = false;  ///< NNNNNN.png
};

/// The file of frame `number`: folder/NNNNNN and `ending`.
[[nodiscard]] std::filesystem::path numbered(const std::filesystem::path& folder,
                                             std::size_t number, const std::string& ending);

/// Whether a name is one that `numbered` gives, or a temporary of one.
[[nodiscard]] bool is_numbered(const std::filesystem::path& name);

/// Writes the data of a frame. A frame without a surface gets no mesh.
/// \throws OutputError; InvalidInput if sigma is asked for and the decoder predicts none.
void write_outputs(const DecodeOutputs& outputs, std::size_t number,
                   const sensing::DecodeResult& result);

/// Whether the data of a frame are there; `has_surface`: a mesh belongs to them.
[[nodiscard]] bool has_outputs(const DecodeOutputs& outputs, std::size_t number, bool has_surface);

/// Draws from the data what is asked for; with `missing_only`, what is not there. Needs the rig
/// beside the range map.
void draw_outputs(const DecodeOutputs& outputs, std::size_t number, const std::string& title,
                  bool missing_only);

}  // namespace palpate::apps
