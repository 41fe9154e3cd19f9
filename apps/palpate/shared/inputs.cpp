// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/inputs.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/input_file.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/reason.h"

namespace palpate::apps {
namespace {

bool may_be_mesh(const fs::path& path) {
  constexpr std::array kEndings{".ply", ".obj", ".off", ".stl", ".gltf", ".glb",
                                ".3ds", ".dae", ".fbx", ".x3d", ".3mf"};
  return std::ranges::find(kEndings, lower_extension(path)) != kEndings.end();
}

constexpr double kRotation = 1e-6;  // accepts values rounded to six decimals, as in text files
constexpr std::size_t kWithoutLastRow = 12, kWhole = 16;

std::vector<double> numbers(const fs::path& path) {
  std::string text = read_input_file(path);
  std::ranges::replace(text, ',', ' ');
  std::istringstream words(text);
  std::vector<double> result;
  std::string word;
  while (words >> word) {
    char* end = nullptr;
    result.push_back(std::strtod(word.c_str(), &end));
    if (*end == '\0' && std::isfinite(result.back())) continue;
    throw FileError(fmt::format("{}: number {} is '{}'; expected a finite number.", path.string(),
                                result.size(), word));
  }
  return result;
}

}  // namespace

std::vector<fs::path> list_frames(const std::vector<fs::path>& paths) {
  std::vector<fs::path> frames;
  for (const fs::path& path : paths) {
    if (!is_folder(path)) {
      frames.push_back(path);
      continue;
    }
    const std::vector<fs::path> in_folder = sensing::list_images(path);
    frames.insert(frames.end(), in_folder.begin(), in_folder.end());
  }
  return frames;
}

std::vector<fs::path> list_meshes(const fs::path& folder) {
  std::vector<fs::path> meshes;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!is_hidden(entry.path()) && may_be_mesh(entry.path()) && entry.is_regular_file())
      meshes.push_back(entry.path());
  }
  std::ranges::sort(meshes, comes_before);
  return meshes;
}

std::vector<std::string> reason_words() {
  std::vector<std::string> words;
  for (int code = 0; code < sensing::kReasonCount; ++code) {
    std::string word(sensing::name(static_cast<sensing::Reason>(code)));
    std::replace(word.begin(), word.end(), '_', ' ');
    words.push_back(std::move(word));
  }
  return words;
}

fs::path noise_beside(const fs::path& range_map) {
  const auto beside = [&](const char* ending) {
    return range_map.parent_path() / (range_map.stem().string() + ending);
  };
  const fs::path noise = beside("_noise.tiff");
  return is_there(noise) ? noise : beside("_sigma.tiff");
}

void check_is_depths(const fs::path& path) {
  if (!is_sigma(path) && !is_reasons(path)) return;
  throw InvalidInput(path.string() + ": holds " +
                     (is_sigma(path) ? "the deviations of depths" : "the reasons of lost pixels") +
                     ", not depths; pass the range map beside it");
}

sensing::Rig load_rig(const fs::path& path) {
  sensing::Rig rig = sensing::read_rig(path);
  tell_doubts(path.string(), sensing::rig_doubts(rig));
  return rig;
}

void tell_doubts(const std::string& source, const std::vector<sensing::Doubt>& doubts) {
  if (const std::string why = sensing::impossible_parts(doubts); !why.empty())
    throw InvalidInput(source + ": " + why + ".");
  static std::mutex mutex;  // frames of a sequence are read at the same time
  static std::set<std::string> told;
  const std::scoped_lock lock(mutex);
  for (const sensing::Doubt& doubt : doubts) {
    if (told.insert(doubt.subject).second) spdlog::warn("{}: {}.", source, doubt.message);
  }
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found)
    throw FileError(path.string() + ": there is no such file or folder.");
  if (error) throw FileError(path.string() + ": cannot be read: " + error.message() + ".");
  return fs::is_directory(status);
}

bool is_there(const fs::path& path) {
  std::error_code cannot_look;
  return fs::exists(path, cannot_look);
}

bool is_image(const fs::path& path) {
  return lower_extension(path) == ".png" || is_range_map(path);
}

bool is_range_map(const fs::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".tiff" || extension == ".tif";
}

bool is_depth_image(const fs::path& path) {
  const std::optional<sensing::PngPixels> pixels = sensing::read_png_pixels(path);
  return pixels && sensing::may_be_depths(*pixels);
}

bool is_sigma(const fs::path& path) {
  return path.filename().string().ends_with("_sigma.tiff") || is_noise(path);
}

bool is_noise(const fs::path& path) { return path.filename().string().ends_with("_noise.tiff"); }

bool is_reasons(const fs::path& path) {
  return path.filename().string().ends_with("_reasons.tiff");
}

Eigen::Isometry3d read_pose(const fs::path& path) {
  std::vector<double> entries = numbers(path);
  if (entries.size() == kWithoutLastRow) entries.insert(entries.end(), {0, 0, 0, 1});
  if (entries.size() != kWhole) {
    throw FileError(fmt::format(
        "{}: {} numbers; expected the 12 or 16 of a matrix of rotation and translation [mm].",
        path.string(), entries.size()));
  }
  Eigen::Isometry3d pose;
  pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(entries.data());
  if (pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw FileError(path.string() + ": the last row of the matrix must be 0 0 0 1.");
  }
  if (!pose.linear().isUnitary(kRotation) || !(pose.linear().determinant() > 0)) {
    throw FileError(path.string() +
                    ": the first three columns must be a rotation: orthogonal to 1e-6, "
                    "right-handed, without scale.");
  }
  return pose;
}

}  // namespace palpate::apps
