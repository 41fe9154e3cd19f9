// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/frame_source.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <system_error>
#include <utility>

#include "files/video_file.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/sensing/decodable.h"
#include "palpate/sensing/frame.h"

namespace palpate::sensing {
namespace {

namespace fs = std::filesystem;

/// A number of frames that a video rounds from its duration may be off by one.
constexpr std::size_t kRoundedFrames = 1;

/// Returns true if an image may have lossy compression.
bool may_have_losses(const fs::path& path) {
  const std::string ending = lower_extension(path);
  return ending == ".jpg" || ending == ".jpeg" || ending == ".webp";
}

/// Videos give three channels, whatever the camera had.
cv::Mat first_channel(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  std::vector<cv::Mat> channels;
  cv::split(image, channels);
  for (std::size_t i = 1; i < channels.size(); ++i) {
    if (cv::norm(channels[0], channels[i], cv::NORM_INF) != 0)
      throw InvalidInput(
          "is in colour; a Bayer mosaic has one value a pixel. Leave the Bayer pattern out");
  }
  return channels[0];
}

cv::Mat read_image(const fs::path& file, const FrameSourceOptions& options) {
  const cv::Mat image = read_frame(file);
  try {
    return decodable(image, options.bayer, options.bits);
  } catch (const InvalidInput& error) {
    throw FileError(file.string() + ": " + error.what());
  }
}

}  // namespace

struct FrameSource::Impl {
  std::vector<fs::path> files;
  FrameSourceOptions options;
  std::vector<std::string> warnings;
  std::size_t expected = 0;
  std::size_t file = 0;                 ///< of the next frame
  std::size_t number = 0;               ///< of the next frame
  std::optional<VideoFile> video = {};  ///< the current file, if it is one
  std::size_t in_video = 0;             ///< number of its frames delivered so far

  void look_at_videos();
  void look_at_images();
  std::optional<SourceFrame> next();
  std::optional<SourceFrame> next_of_video();
};

void FrameSource::Impl::look_at_videos() {
  for (const fs::path& path : files) {
    if (!is_video(path)) {
      ++expected;
      continue;
    }
    const VideoFile opened(path);
    expected += opened.announced_frames();
    if (!opened.is_lossless()) {
      warnings.push_back(
          path.string() +
          ": is compressed with losses, or holds colour at less than full resolution; stripe "
          "colours and phase suffer. Record without losses: FFV1, HuffYUV, PNG or raw RGB");
    }
  }
}

/// One warning for all; the first image stands for the others.
void FrameSource::Impl::look_at_images() {
  const auto first = std::find_if(files.begin(), files.end(), may_have_losses);
  std::error_code missing;  // reported when the frame is read
  if (first == files.end() || !fs::is_regular_file(*first, missing) || !has_losses(*first)) return;
  const auto count = std::count_if(first, files.end(), may_have_losses);
  warnings.push_back(
      first->string() +
      (count > 1 ? " and " + std::to_string(count - 1) + " more: are" : std::string(": is")) +
      " compressed with losses; stripe colours and phase suffer. Record without "
      "losses: PNG, TIFF or BMP");
}

std::optional<SourceFrame> FrameSource::Impl::next_of_video() {
  const fs::path& path = files[file];
  if (!video) {
    video.emplace(path);
    in_video = 0;
  }
  const std::string place = std::string("#").append(std::to_string(in_video));
  SourceFrame frame{
      .number = number, .name = path.filename().string() + place, .file = path, .read = {}};
  const cv::Mat image = video->next();
  if (image.empty()) {
    const std::size_t announced = video->announced_frames();
    video.reset();
    ++file;
    if (announced <= in_video + kRoundedFrames) return std::nullopt;
    ++number;
    frame.read = [message = path.string() + ": breaks off after " + std::to_string(in_video) +
                            " of the " + std::to_string(announced) +
                            " frames that it announces"]() -> cv::Mat { throw FileError(message); };
    return frame;
  }
  ++number;
  ++in_video;
  frame.read = [image, options = options, name = path.string() + place] {
    try {
      return decodable(options.bayer ? first_channel(image) : image, options.bayer, options.bits);
    } catch (const InvalidInput& error) {
      throw FileError(name + ": " + error.what());
    }
  };
  return frame;
}

std::optional<SourceFrame> FrameSource::Impl::next() {
  while (file < files.size()) {
    const fs::path& path = files[file];
    if (is_video(path)) {
      if (auto frame = next_of_video()) return frame;
      continue;
    }
    ++file;
    return SourceFrame{.number = number++,
                       .name = path.filename().string(),
                       .file = path,
                       .read = [path, options = options] { return read_image(path, options); }};
  }
  return std::nullopt;
}

FrameSource::FrameSource(const std::vector<fs::path>& paths, const FrameSourceOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  for (const fs::path& path : paths) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found)
      throw FileError(path.string() + ": there is no such file or folder.");
    if (error) throw FileError(path.string() + ": cannot be read: " + error.message() + ".");
    if (fs::is_directory(status)) {
      const std::vector<fs::path> images = list_images(path);
      impl_->files.insert(impl_->files.end(), images.begin(), images.end());
    } else {
      impl_->files.push_back(path);
    }
  }
  impl_->look_at_videos();
  impl_->look_at_images();
}

FrameSource::~FrameSource() = default;
FrameSource::FrameSource(FrameSource&&) noexcept = default;
FrameSource& FrameSource::operator=(FrameSource&&) noexcept = default;

std::optional<SourceFrame> FrameSource::next() { return impl_->next(); }
const std::vector<fs::path>& FrameSource::files() const { return impl_->files; }
std::size_t FrameSource::expected_frames() const { return impl_->expected; }
const std::vector<std::string>& FrameSource::warnings() const { return impl_->warnings; }

std::vector<fs::path> list_images(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> images;
  for (fs::directory_iterator entry(folder, error); entry != fs::directory_iterator();
       entry.increment(error)) {
    if (!has_frame_name(entry->path()) || is_hidden(entry->path())) continue;
    std::error_code ignored;  // an inaccessible entry is not an image
    // The folder itself states which entries are files; only links have to be followed. One that
    // leads nowhere is a frame that is missing; its reader says so.
    if (entry->is_regular_file(ignored) ||
        entry->status(ignored).type() == fs::file_type::not_found)
      images.push_back(entry->path());
  }
  if (error)
    throw FileError(folder.string() + ": this folder cannot be read: " + error.message() + ".");
  if (images.empty())
    throw FileError(folder.string() +
                    ": there is no image in this folder (png, tiff, bmp, jpeg or webp).");
  std::sort(images.begin(), images.end(), comes_before);
  return images;
}

}  // namespace palpate::sensing
