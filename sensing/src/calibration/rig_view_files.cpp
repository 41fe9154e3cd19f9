// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_view_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "files/image_codecs.h"
#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/input_file.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/gray_code.h"

namespace palpate::sensing {
namespace {

namespace fs = std::filesystem;

bool is_jpeg(const fs::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".jpg" || extension == ".jpeg";
}

bool is_view_image(const fs::path& path) {
  const std::string extension = lower_extension(path);
  return is_jpeg(path) || extension == ".png" || extension == ".tif" || extension == ".tiff";
}

/// Reads a grey image, 8 or 16 bit, of the same size as all images so far.
cv::Mat read_view_image(const fs::path& path, ImageSize& size) {
  cv::Mat image = is_jpeg(path) ? decode_image(path, read_input_file(path), cv::IMREAD_GRAYSCALE)
                                : read_frame(path);
  if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
  if (size.width == 0) size = {image.cols, image.rows};
  if (image.cols != size.width || image.rows != size.height) {
    throw FileError(path.string() + ": " + std::to_string(image.cols) + " x " +
                    std::to_string(image.rows) + " px, but the images before it have " +
                    std::to_string(size.width) + " x " + std::to_string(size.height));
  }
  return image;
}

/// Entries of a folder, in the order of `comes_before`.
struct Entries {
  std::vector<fs::path> images;
  std::vector<fs::path> folders;
};
Entries list_entries(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  if (error) throw FileError(folder.string() + ": no such folder, or it cannot be read");
  Entries entries;
  for (; entry != fs::directory_iterator(); entry.increment(error)) {
    if (is_hidden(entry->path())) continue;
    std::error_code ignored;
    if (entry->is_directory(ignored)) entries.folders.push_back(entry->path());
    if (entry->is_regular_file(ignored) && is_view_image(entry->path()))
      entries.images.push_back(entry->path());
  }
  std::sort(entries.images.begin(), entries.images.end(), comes_before);
  std::sort(entries.folders.begin(), entries.folders.end(), comes_before);
  return entries;
}

/// The folders that contain images, one per pose.
std::vector<fs::path> list_poses(const std::vector<fs::path>& folders) {
  std::vector<fs::path> poses;
  for (const fs::path& folder : folders) {
    const Entries entries = list_entries(folder);
    if (!entries.images.empty()) {
      poses.push_back(folder);
      continue;
    }
    for (const fs::path& inner : entries.folders)
      if (!list_entries(inner).images.empty()) poses.push_back(inner);
    if (entries.folders.empty())
      throw FileError(folder.string() + ": there is no image in it, nor folders of images");
  }
  if (poses.empty()) throw FileError("calibrate_rig: the folders hold no images");
  return poses;
}

RigView read_pose(const fs::path& folder, const Board& printed, const ImageSize& projector,
                  const BoardViewOptions& options, ImageSize& size) {
  const std::vector<fs::path> files = list_entries(folder).images;
  const auto named = [&](const char* stem) {
    return std::find_if(files.begin(), files.end(),
                        [&](const fs::path& file) { return file.stem() == stem; });
  };
  const auto board = named("board");
  const auto projected = named("projected");
  if (board != files.end() && projected != files.end()) {
    return view_from_still(read_view_image(*board, size), read_view_image(*projected, size),
                           printed, projector);
  }
  const int expected = gray_code_length(projector);
  if (static_cast<int>(files.size()) != expected) {
    throw FileError(folder.string() + ": holds " + std::to_string(files.size()) +
                    " images; the Gray code of a projector of " + std::to_string(projector.width) +
                    " x " + std::to_string(projector.height) + " px has " +
                    std::to_string(expected) +
                    ", white and black at the end, or two are expected, named board and projected");
  }
  std::vector<cv::Mat> images;
  for (const fs::path& file : files) {
    images.push_back(read_view_image(file, size));
    if (images.back().type() != images.front().type())
      throw FileError(file.string() + ": 8 and 16 bit are mixed in this folder");
  }
  try {
    return view_from_gray_code(images, printed, projector, options);
  } catch (const InvalidInput& error) {
    throw FileError(folder.string() + ": " + error.what());
  }
}

}  // namespace

RigViewFiles read_rig_views(const std::vector<fs::path>& folders, const Board& printed,
                            const ImageSize& projector, const BoardViewOptions& options,
                            const std::function<void(int, int)>& on_view) {
  (void)board_corners(printed);  // rejects a bad board before reading anything
  const std::vector<fs::path> poses = list_poses(folders);
  RigViewFiles result;
  for (const fs::path& pose : poses) {
    RigView view = read_pose(pose, printed, projector, options, result.camera);
    const fs::path name = pose.has_filename() ? pose.filename() : pose.parent_path().filename();
    view.name = name.string();
    result.views.push_back(std::move(view));
    if (on_view) on_view(static_cast<int>(result.views.size()), static_cast<int>(poses.size()));
  }
  return result;
}

int write_projector_images(const fs::path& folder, const ImageSize& projector,
                           const Board& printed) {
  const cv::Mat still = draw_projected_board(projector, projected_board(projector, printed));
  const std::vector<cv::Mat> code = draw_gray_code(projector);
  for (std::size_t i = 0; i < code.size(); ++i)
    write_png(folder / fmt::format("graycode_{:02}.png", i), code[i]);
  write_png(folder / "projected.png", still);
  return static_cast<int>(code.size());
}

}  // namespace palpate::sensing
