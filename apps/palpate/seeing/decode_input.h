// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "palpate/sensing/decode.h"
#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/response.h"

namespace palpate::apps {

/// Opens the frames of a call, and prints the warnings of their source.
/// \param bayer order of the colours, such as "rggb"; empty for frames in colour.
/// \param bits that the values of 16-bit frames use; 0: not stated, all 16.
/// \param output the folder of the results, in which no frame may lie.
/// \throws InvalidInput or FileError.
[[nodiscard]] sensing::FrameSource open_frames(const std::vector<std::filesystem::path>& frames,
                                               const std::string& bayer, int bits,
                                               const std::filesystem::path& output);

/// Makes the function that reads the frame warn if 16-bit values fill only 10, 12 or 14 bits. The
/// values stay, because a frame does not show the full scale of its camera.
void doubt_bits_when_read(sensing::SourceFrame& frame);

/// Adds a linearisation to the function that reads the frame.
/// \param linearize must outlive the frame.
void linearize_when_read(const sensing::Linearizer& linearize, sensing::SourceFrame& frame);

/// Makes the function that reads the frame warn if the sinusoid is so distorted that depths get
/// waves. A pattern without stripes is often not Palpate's own, and its projector not linear.
void examine_when_read(sensing::SourceFrame& frame);

/// Refuses pipes: settings are read twice, the second time for their fingerprints in the record.
/// \param files options and their values.
/// \throws InvalidInput if one is a pipe.
void refuse_pipes(const std::vector<std::pair<const char*, std::filesystem::path>>& files);

}  // namespace palpate::apps
