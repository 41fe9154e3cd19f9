// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/tiff_frame.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <ostream>
#include <string>
#include <type_traits>

#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"

namespace palpate::sensing {
namespace {

// Types of values, and tags, by their numbers in the standard.
enum class TiffType : std::uint16_t { whole16 = 3, whole32 = 4 };
enum class TiffTag : std::uint16_t {
  width = 256,
  height = 257,
  bits = 258,
  compression = 259,
  meaning = 262,
  strip_place = 273,
  channels = 277,
  rows_in_strip = 278,
  strip_bytes = 279
};
constexpr std::uint16_t kTags = 9;
constexpr std::uint16_t kMagic = 42;
constexpr std::uint32_t kNotCompressed = 1;
constexpr std::uint32_t kBlackIsZero = 1;
constexpr std::uint32_t kRedGreenBlue = 2;

/// Bytes of the header, of an entry of the directory, and of all before the bits of each channel.
constexpr std::uint32_t kHeader = 8;
constexpr std::uint32_t kEntry = 12;
constexpr std::uint32_t kDirectoryEnd = kHeader + 2 + kTags * kEntry + 4;

template <typename Number>
void append(std::string& bytes, Number number) {
  static_assert(std::is_integral_v<Number>);
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

void append_entry(std::string& bytes, TiffTag tag, std::uint32_t value) {
  append(bytes, static_cast<std::uint16_t>(tag));
  append(bytes, static_cast<std::uint16_t>(TiffType::whole32));
  append(bytes, std::uint32_t{1});
  append(bytes, value);
}

/// The bytes before the pixels in a TIFF file without compression (TIFF 6.0, baseline, one
/// strip): the rows follow, from the top, grey or red, green, blue, in the byte order of this
/// computer.
std::string tiff_start(const cv::Mat& image) {
  const auto channels = static_cast<std::uint32_t>(image.channels());
  const auto bits = static_cast<std::uint16_t>(8 * image.elemSize1());
  const auto height = static_cast<std::uint32_t>(image.rows);
  const std::uint32_t pixels = kDirectoryEnd + 2 * channels;
  std::string bytes(std::endian::native == std::endian::little ? "II" : "MM");
  append(bytes, kMagic);
  append(bytes, kHeader);
  append(bytes, kTags);
  append_entry(bytes, TiffTag::width, static_cast<std::uint32_t>(image.cols));
  append_entry(bytes, TiffTag::height, height);
  append(bytes, static_cast<std::uint16_t>(TiffTag::bits));
  append(bytes, static_cast<std::uint16_t>(TiffType::whole16));
  append(bytes, channels);
  if (channels == 1) {  // a value of up to four bytes is in its entry
    append(bytes, bits);
    append(bytes, std::uint16_t{0});
  } else {
    append(bytes, kDirectoryEnd);
  }
  append_entry(bytes, TiffTag::compression, kNotCompressed);
  append_entry(bytes, TiffTag::meaning, channels == 1 ? kBlackIsZero : kRedGreenBlue);
  append_entry(bytes, TiffTag::strip_place, pixels);
  append_entry(bytes, TiffTag::channels, channels);
  append_entry(bytes, TiffTag::rows_in_strip, height);
  append_entry(bytes, TiffTag::strip_bytes,
               static_cast<std::uint32_t>(image.total() * image.elemSize()));
  append(bytes, std::uint32_t{0});  // there is no other image
  for (std::uint32_t i = 0; i < channels; ++i) append(bytes, bits);
  return bytes;
}

}  // namespace

void write_tiff(const std::filesystem::path& path, const cv::Mat& image) {
  if (!is_frame(image)) {
    throw InvalidInput("write_tiff(" + path.string() +
                       "): an image of 8 or 16 bit with 1 or 3 channels is expected");
  }
  const std::string start = tiff_start(image);
  cv::Mat turned;  // the image itself must not change
  if (image.channels() == 3) cv::cvtColor(image, turned, cv::COLOR_BGR2RGB);
  const cv::Mat& pixels = turned.empty() ? image : turned;
  const auto row = static_cast<std::streamsize>(pixels.elemSize()) * pixels.cols;
  write_file(path, [&](std::ostream& out) {
    out.write(start.data(), static_cast<std::streamsize>(start.size()));
    for (int v = 0; v < pixels.rows; ++v) out.write(pixels.ptr<char>(v), row);
  });
}

}  // namespace palpate::sensing
