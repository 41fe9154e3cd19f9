// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map.h"

#include <tiffio.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <system_error>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/core/output_file.h"
#include "palpate/core/parallel_for.h"
#include "range_map/pixel_rays.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

// Bytes per strip: few strips are faster than many.
constexpr std::size_t kStripBytes = 1024 * 1024;

/// The first error message of libtiff. Fixed size, because it is filled in a callback of a C
/// library, through which no exception may propagate.
struct TiffMessage {
  std::array<char, 256> text{};
  [[nodiscard]] bool empty() const { return text[0] == '\0'; }
  [[nodiscard]] std::string str() const { return text.data(); }
};

int keep_first_message(TIFF* /*file*/, void* message, const char* /*module*/, const char* format,
                       va_list arguments) {
  auto& text = static_cast<TiffMessage*>(message)->text;
  if (text[0] == '\0') std::vsnprintf(text.data(), text.size(), format, arguments);
  return 1;  // handled: nothing is printed
}

int ignore_message(TIFF* /*file*/, void* /*user*/, const char* /*module*/, const char* /*format*/,
                   va_list /*arguments*/) {
  return 1;
}

using TiffFile = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

using TiffOptions = std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)>;

TiffOptions options_with(TiffMessage& message) {
  TiffOptions options(TIFFOpenOptionsAlloc(), &TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_first_message, &message);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore_message, nullptr);
  return options;
}

/// Null if it cannot be opened. `message` must outlive the file.
TiffFile open_tiff(const fs::path& path, const char* mode, TiffMessage& message) {
  return {TIFFOpenExt(path.c_str(), mode, options_with(message).get()), &TIFFClose};
}

/// The same for the content of a pipe, by a temporary file, because libtiff seeks.
TiffFile open_piped_tiff(const fs::path& path, TiffMessage& message) {
  const std::string content = read_input_file(path);
  const std::unique_ptr<std::FILE, decltype(&std::fclose)> copy(std::tmpfile(), &std::fclose);
  if (!copy || std::fwrite(content.data(), 1, content.size(), copy.get()) != content.size() ||
      std::fflush(copy.get()) != 0)
    throw FileError(path.string() + ": cannot be kept in a temporary file: " +
                    std::generic_category().message(errno));
  const int descriptor = ::dup(::fileno(copy.get()));  // closed by libtiff
  if (descriptor < 0 || ::lseek(descriptor, 0, SEEK_SET) != 0)
    throw FileError(path.string() +
                    ": cannot be read again: " + std::generic_category().message(errno));
  return {TIFFFdOpenExt(descriptor, path.c_str(), "rm", options_with(message).get()), &TIFFClose};
}

std::string sample_name(int bits, int format, int channels) {
  const char* kind = format == SAMPLEFORMAT_IEEEFP ? "floating-point"
                     : format == SAMPLEFORMAT_UINT ? "unsigned integer"
                     : format == SAMPLEFORMAT_INT  ? "signed integer"
                                                   : "other";
  return std::to_string(channels) + (channels == 1 ? " channel" : " channels") + " of " +
         std::to_string(bits) + " bit " + kind;
}

/// An image of the size of the file, not yet filled.
ImageF checked_image(TIFF* file, const fs::path& path) {
  std::uint16_t bits = 1;
  std::uint16_t format = SAMPLEFORMAT_UINT;
  std::uint16_t channels = 1;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &channels);
  TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(file, TIFFTAG_IMAGELENGTH, &height);
  if (bits != 32 || format != SAMPLEFORMAT_IEEEFP || channels != 1)
    throw FileError(path.string() + ": holds " + sample_name(bits, format, channels) +
                    "; a range map is a TIFF of 1 channel of 32 bit floating-point");
  if (width == 0 || height == 0 || std::uint64_t{width} * height > kMaxPixels)
    throw FileError(path.string() + ": has a size of " + std::to_string(width) + " x " +
                    std::to_string(height) + " px; a range map has 1 to 2^28 pixels");
  // The image, and a copy in which unknown pixels are NaN.
  check_memory_to_read(2 * sizeof(float) * static_cast<double>(width) * height,
                       static_cast<double>(TIFFGetSizeProc(file)(TIFFClientdata(file))),
                       path.string());
  return ImageF(static_cast<Eigen::Index>(height), static_cast<Eigen::Index>(width));
}

FileError truncated(const fs::path& path, const ImageF& z, Eigen::Index row,
                    const TiffMessage& message) {
  return FileError(path.string() + ": cannot be read from row " + std::to_string(row) + " of " +
                   std::to_string(z.rows()) + " on; the file is truncated or damaged (" +
                   message.str() + ")");
}

/// Checks that strips and tiles lie in the file, each at a place of its own. For others, libtiff
/// may leave pixels as they are in memory, without an error.
void check_parts(TIFF* file, const fs::path& path) {
  const bool is_tiled = TIFFIsTiled(file) != 0;
  const std::uint32_t parts = is_tiled ? TIFFNumberOfTiles(file) : TIFFNumberOfStrips(file);
  const char* const kind = is_tiled ? "tile" : "strip";
  const std::uintmax_t size = TIFFGetSizeProc(file)(TIFFClientdata(file));
  std::uintmax_t total = 0;
  for (std::uint32_t part = 0; part < parts && total <= size; ++part) {
    const std::uint64_t bytes = TIFFGetStrileByteCount(file, part);
    if (bytes == 0)
      throw FileError(path.string() + ": " + kind + " " + std::to_string(part) + " of " +
                      std::to_string(parts) + " is not in the file; it is truncated or damaged");
    total += bytes;
  }
  if (total > size)
    throw FileError(path.string() + ": its " + std::to_string(parts) + " " + kind +
                    "s have more bytes than the file, " + std::to_string(size) +
                    "; it is truncated or damaged");
}

void read_strips(TIFF* file, const fs::path& path, const TiffMessage& message, ImageF& z) {
  std::uint32_t rows_per_strip = 0;
  TIFFGetFieldDefaulted(file, TIFFTAG_ROWSPERSTRIP, &rows_per_strip);
  const Eigen::Index step = std::clamp<Eigen::Index>(rows_per_strip, 1, z.rows());
  std::uint32_t strip = 0;
  for (Eigen::Index row = 0; row < z.rows(); row += step, ++strip) {
    const auto bytes = static_cast<tmsize_t>(std::min(step, z.rows() - row) * z.cols()) *
                       static_cast<tmsize_t>(sizeof(float));
    if (TIFFReadEncodedStrip(file, strip, z.row(row).data(), bytes) != bytes)
      throw truncated(path, z, row, message);
  }
}

void read_tiles(TIFF* file, const fs::path& path, const TiffMessage& message, ImageF& z) {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  TIFFGetField(file, TIFFTAG_TILEWIDTH, &width);
  TIFFGetField(file, TIFFTAG_TILELENGTH, &height);
  if (width == 0 || height == 0 || std::uint64_t{width} * height > kMaxPixels)
    throw FileError(path.string() + ": has tiles of " + std::to_string(width) + " x " +
                    std::to_string(height) + " px; the file is damaged");
  ImageF tile(static_cast<Eigen::Index>(height), static_cast<Eigen::Index>(width));
  const auto bytes = static_cast<tmsize_t>(tile.size()) * static_cast<tmsize_t>(sizeof(float));
  for (Eigen::Index row = 0; row < z.rows(); row += tile.rows())
    for (Eigen::Index col = 0; col < z.cols(); col += tile.cols()) {
      const std::uint32_t index = TIFFComputeTile(file, static_cast<std::uint32_t>(col),
                                                  static_cast<std::uint32_t>(row), 0, 0);
      if (TIFFReadEncodedTile(file, index, tile.data(), bytes) != bytes)
        throw truncated(path, z, row, message);
      const Eigen::Index rows = std::min(tile.rows(), z.rows() - row);
      const Eigen::Index cols = std::min(tile.cols(), z.cols() - col);
      z.block(row, col, rows, cols) = tile.topLeftCorner(rows, cols);
    }
}

void write_strips(const fs::path& path, const fs::path& temporary, const ImageF& z) {
  TiffMessage message;
  errno = 0;
  // The system's reason says what is wrong: the disk is full, and not "write error at scanline 0".
  const auto check = [&](bool good) {
    if (good && message.empty()) return;
    const std::string reason = errno != 0 ? std::generic_category().message(errno) : message.str();
    throw OutputError(path.string() + ": cannot be written: " + reason +
                      ". What was there before is unchanged.");
  };
  TiffFile file = open_tiff(temporary, "w", message);
  check(file != nullptr);
  const Eigen::Index step = std::clamp<Eigen::Index>(
      static_cast<Eigen::Index>(kStripBytes / sizeof(float)) / z.cols(), 1, z.rows());
  TIFFSetField(file.get(), TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(z.cols()));
  TIFFSetField(file.get(), TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(z.rows()));
  TIFFSetField(file.get(), TIFFTAG_BITSPERSAMPLE, 32);
  TIFFSetField(file.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(file.get(), TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(file.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  // Depths contain noise: even the fastest deflate takes fourteen times as long for half the size.
  TIFFSetField(file.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(file.get(), TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(step));
  std::uint32_t strip = 0;
  for (Eigen::Index row = 0; row < z.rows(); row += step, ++strip) {
    ImageF rows = z.middleRows(row, std::min(step, z.rows() - row));  // libtiff wants it mutable
    const auto bytes = static_cast<tmsize_t>(rows.size()) * static_cast<tmsize_t>(sizeof(float));
    check(TIFFWriteEncodedStrip(file.get(), strip, rows.data(), bytes) == bytes);
  }
  check(TIFFWriteDirectory(file.get()) == 1);
  file.reset();  // TIFFClose returns nothing; a failure is seen in the message
  check(true);
}

}  // namespace

Eigen::Matrix3Xd back_project(const RangeMap& map) {
  check_camera(map.camera, "camera of the range map");
  if (map.z.rows() != map.camera.height || map.z.cols() != map.camera.width)
    throw InvalidInput("range map: depths are " + std::to_string(map.z.cols()) + " x " +
                       std::to_string(map.z.rows()) + " px, but the camera is " +
                       std::to_string(map.camera.width) + " x " +
                       std::to_string(map.camera.height) + " px");
  Eigen::Matrix3Xd points(3, map.z.size());
  fill_pixel_rays(map.camera, points.topRows<2>());
  const Eigen::Index width = map.z.cols();
  parallel_for(map.z.rows(), [&](Eigen::Index row) {
    for (Eigen::Index i = row * width; i < (row + 1) * width; ++i) {
      const auto z = static_cast<double>(map.z.data()[i]);
      points.col(i) << z * points(0, i), z * points(1, i), z;
    }
  });
  return points;
}

ImageF read_depth_tiff(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::is_regular_file(status) && !fs::is_fifo(status))
    throw FileError(path.string() + ": no such file; a range map is a TIFF file");
  TiffMessage message;
  const TiffFile file =
      fs::is_fifo(status) ? open_piped_tiff(path, message) : open_tiff(path, "rm", message);
  if (!file)
    throw FileError(path.string() + ": is not a TIFF file, or it is truncated (" + message.str() +
                    "); a range map is a TIFF of 1 channel of 32 bit floating-point");
  ImageF z = checked_image(file.get(), path);
  check_parts(file.get(), path);
  if (TIFFIsTiled(file.get()) != 0)
    read_tiles(file.get(), path, message, z);
  else
    read_strips(file.get(), path, message, z);
  return (z > 0 && z.isFinite()).select(z, std::numeric_limits<float>::quiet_NaN());
}

void write_depth_tiff(const fs::path& path, const ImageF& z) {
  if (z.size() == 0) throw InvalidInput(path.string() + ": a range map without pixels to write");
  write_file_by_path(path, [&](const fs::path& temporary) { write_strips(path, temporary, z); });
}

}  // namespace palpate::geometry
