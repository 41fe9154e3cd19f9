// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_input.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/sensing/harmonics.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

/// Describes the distortion of the sinusoid in a frame; nullopt if it is not distorted, or cannot
/// be examined.
std::optional<std::string> distortion_of(const cv::Mat& frame) {
  sensing::HarmonicCheck check;
  try {
    check = sensing::check_harmonics(frame);
  } catch (const InvalidInput&) {  // too few places show a sinusoid
    return std::nullopt;
  }
  if (!check.distorted) return std::nullopt;
  const auto percent = [](const std::optional<sensing::Harmonic>& harmonic) {
    return harmonic ? fmt::format("{:.1f} %", 100 * std::abs(harmonic->ratio))
                    : std::string("unknown");
  };
  return fmt::format(
      "the sinusoid is distorted (second harmonic {}, third {} of the fundamental), so depths have "
      "waves of about {:.3f} rad of its phase; make projector and camera linear, or measure them "
      "(palpate calibrate response) and give --response",
      percent(check.second), percent(check.third), check.phase_wave);
}

// Returns the folder of a file; of a symbolic link, that of its target.
fs::path folder_of(const fs::path& file) {
  std::error_code not_there;
  if (fs::is_symlink(file, not_there)) return fs::weakly_canonical(file, not_there).parent_path();
  const fs::path folder = file.parent_path();
  return folder.empty() ? "." : folder;
}

}  // namespace

void doubt_bits_when_read(sensing::SourceFrame& frame) {
  frame.read = [read = std::move(frame.read), name = frame.name] {
    cv::Mat image = read();
    if (image.depth() != CV_16U) return image;
    const double largest = cv::norm(image, cv::NORM_INF);
    for (const int bits : {10, 12, 14}) {
      if (largest >= 1 << bits) continue;
      spdlog::warn(
          "{}: no value is above {}, as if {} of the 16 bits were used: then everything counts as "
          "too dark. If so, pass --bits {}; --bits 16 if the frame is meant to be as it is",
          name, (1 << bits) - 1, bits, bits);
      break;
    }
    return image;
  };
}

void linearize_when_read(const sensing::Linearizer& linearize, sensing::SourceFrame& frame) {
  frame.read = [read = std::move(frame.read), name = frame.name, &linearize] {
    const cv::Mat image = read();
    try {
      return linearize(image);
    } catch (const InvalidInput& misfit) {
      throw InvalidInput(name + ": " + misfit.what());
    }
  };
}

void examine_when_read(sensing::SourceFrame& frame) {
  frame.read = [read = std::move(frame.read), name = frame.name] {
    cv::Mat image = read();
    if (const auto waves = distortion_of(image)) spdlog::warn("{}: {}", name, *waves);
    return image;
  };
}

sensing::FrameSource open_frames(const std::vector<fs::path>& frames, const std::string& bayer,
                                 int bits, const fs::path& output) {
  sensing::FrameSourceOptions options;
  if (bits > 0) options.bits = bits;
  if (!bayer.empty()) options.bayer = sensing::bayer_pattern(bayer);
  sensing::FrameSource source(frames, options);
  check_outputs(frames, {output});
  fs::path looked_at;  // most frames lie in one folder, and each lookup takes time
  for (const fs::path& file : source.files()) {
    const fs::path folder = folder_of(file);
    if (folder == looked_at) continue;
    looked_at = folder;
    std::error_code not_there;
    if (!fs::equivalent(folder, output, not_there)) continue;
    throw InvalidInput(file.string() + ": lies in " + output.string() +
                       ", the output folder, so results could replace frames of the same "
                       "name. Choose another --output.");
  }
  for (const std::string& warning : source.warnings()) spdlog::warn("{}", warning);
  return source;
}

void refuse_pipes(const std::vector<std::pair<const char*, fs::path>>& files) {
  for (const auto& [option, file] : files) {
    std::error_code not_there;
    if (!fs::is_fifo(file, not_there)) continue;
    throw InvalidInput(std::string(option) + ": " + file.string() +
                       " is a pipe; write its content to a file, which can be read twice");
  }
}

}  // namespace palpate::apps
