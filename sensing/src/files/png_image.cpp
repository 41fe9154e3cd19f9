// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/png_image.h"

#include <libdeflate.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/memory_limit.h"

namespace palpate::sensing {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
/// Length, type and checksum of a chunk.
constexpr std::size_t kChunkFrame = 12;

/// The number in the first four bytes.
std::uint32_t png_number(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) {
    value = (value << 8U) | static_cast<unsigned char>(byte);
  }
  return value;
}

/// A part of a PNG file, which must outlive it.
struct PngChunk {
  std::string_view type;
  std::string_view data;
};

/// The chunks of a file in which `find_png_damage` finds nothing.
std::vector<PngChunk> png_chunks(const std::string& bytes) {
  const std::string_view all = bytes;
  std::vector<PngChunk> chunks;
  std::size_t position = kSignature.size();
  while (position + kChunkFrame <= all.size()) {
    const std::size_t length = png_number(all.substr(position));
    chunks.push_back({all.substr(position + 4, 4), all.substr(position + 8, length)});
    if (chunks.back().type == "IEND") break;
    position += kChunkFrame + length;
  }
  return chunks;
}

using Byte = std::uint8_t;

/// Pixel format in the header, for the types that are read here.
struct Layout {
  int width = 0;
  int height = 0;
  int channels = 0;       ///< in the file: 1, 3, or 4 with alpha
  int sample_bytes = 0;   ///< 1 or 2
  bool is_known = false;  ///< false for a type that is not read here
  [[nodiscard]] std::size_t pixel_bytes() const {
    return static_cast<std::size_t>(channels) * static_cast<std::size_t>(sample_bytes);
  }
  [[nodiscard]] std::size_t row_bytes() const {
    return static_cast<std::size_t>(width) * pixel_bytes();
  }
};

// Larger sizes in a header are not believed: 2^28 pixels are 1 GB of depths.
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28U;

Layout read_layout(std::string_view header) {
  constexpr std::size_t kHeaderBytes = 13;
  if (header.size() != kHeaderBytes) throw InvalidInput("is damaged: its header has a wrong size");
  const std::uint32_t width = png_number(header);
  const std::uint32_t height = png_number(header.substr(4));
  if (width == 0 || height == 0 || std::uint64_t{width} * height > kMaxPixels) {
    throw InvalidInput("is damaged: its header says " + std::to_string(width) + " x " +
                       std::to_string(height) + " px; 1 to 2^28 pixels are possible");
  }
  const auto bits = static_cast<Byte>(header[8]);
  const auto kind = static_cast<Byte>(header[9]);  // 0 grey, 2 colour, 6 colour with alpha
  const auto interlacing = static_cast<Byte>(header[12]);
  Layout layout{.width = static_cast<int>(width), .height = static_cast<int>(height)};
  layout.channels = kind == 0 ? 1 : kind == 2 ? 3 : 4;
  layout.sample_bytes = bits / 8;
  layout.is_known =
      (kind == 0 || kind == 2 || kind == 6) && (bits == 8 || bits == 16) && interlacing == 0;
  return layout;
}

// Of unpacked bytes to packed ones: deflate codes at most 258 bytes by two bits.
constexpr std::size_t kMaxExpansion = 1032;

/// A pixel has at most this many bytes; so many more are readable behind the rows.
constexpr std::size_t kLongestPixel = 8;

/// `size` bytes of rows, and kLongestPixel behind them.
std::vector<Byte> inflate(std::string_view packed, std::size_t size) {
  if (size / kMaxExpansion > packed.size())  // before memory is taken
    throw InvalidInput("is damaged: " + std::to_string(packed.size()) +
                       " packed bytes cannot hold its pixels");
  // The rows and the image made of them.
  if (const auto wrong =
          beyond_memory_limit(2 * static_cast<double>(size), static_cast<double>(packed.size())))
    throw InvalidInput(*wrong);
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>
      decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  std::vector<Byte> rows(size + kLongestPixel);
  // Because no output size is passed, anything but exactly `size` bytes is an error.
  if (libdeflate_zlib_decompress(decompressor.get(), packed.data(), packed.size(), rows.data(),
                                 size, nullptr) != LIBDEFLATE_SUCCESS) {
    throw InvalidInput("is damaged: its pixels cannot be unpacked");
  }
  return rows;
}

using PixelBytes = Byte __attribute__((vector_size(kLongestPixel)));
using PixelVector = std::int16_t __attribute__((vector_size(2 * kLongestPixel)));

/// What the bytes of a pixel are computed in; a vector is slower for a single one.
template <std::size_t kPixelBytes>
using Pixel = std::conditional_t<kPixelBytes == 1, int, PixelVector>;

template <typename Values>
Values load_pixel(const Byte* bytes) {
  if constexpr (std::is_same_v<Values, int>) {
    return *bytes;
  } else {
    PixelBytes pixel;
    std::memcpy(&pixel, bytes, sizeof pixel);
    return __builtin_convertvector(pixel, Values);
  }
}

template <std::size_t kPixelBytes>
void store_pixel(Pixel<kPixelBytes> values, Byte* bytes) {
  if constexpr (kPixelBytes == 1) {
    *bytes = static_cast<Byte>(values);
  } else {
    const PixelBytes pixel = __builtin_convertvector(values, PixelBytes);
    std::memcpy(bytes, &pixel, kPixelBytes);
  }
}

template <typename Values>
Values absolute(Values values) {
  return values > 0 ? values : -values;
}

/// The one of left, above and above left that is nearest to left + above - above left (Paeth; PNG
/// specification, 9.4).
template <typename Values>
Values paeth(Values left, Values above, Values corner) {
  const Values to_left = absolute<Values>(above - corner);
  const Values to_above = absolute<Values>(left - corner);
  const Values to_corner = absolute<Values>(left + above - 2 * corner);
  const Values nearer = to_above <= to_corner ? above : corner;
  return ((to_left <= to_above) & (to_left <= to_corner)) ? left : nearer;
}

/// Reverses the filter of one row (PNG specification, 9.2), whose bytes are differences from what
/// the pixel to the left and the row above predict. `above` is zero for the first row.
template <std::size_t kPixelBytes, int kFilter>
void undo_filter(Byte* row, const Byte* above, std::size_t size) {
  using Values = Pixel<kPixelBytes>;
  Values left{}, corner{};
  for (std::size_t i = 0; i < size; i += kPixelBytes) {
    const auto up = load_pixel<Values>(above + i);
    auto value = load_pixel<Values>(row + i);
    if constexpr (kFilter == 1) value += left;
    if constexpr (kFilter == 2) value += up;
    if constexpr (kFilter == 3) value += (left + up) / 2;
    if constexpr (kFilter == 4) value += paeth<Values>(left, up, corner);
    left = value & 255;
    store_pixel<kPixelBytes>(left, row + i);
    corner = up;
  }
}

template <std::size_t kPixelBytes>
void undo_filter_of_row(int filter, Byte* row, const Byte* above, std::size_t size) {
  switch (filter) {
    case 0:
      return;
    case 1:
      return undo_filter<kPixelBytes, 1>(row, above, size);
    case 2:
      return undo_filter<kPixelBytes, 2>(row, above, size);
    case 3:
      return undo_filter<kPixelBytes, 3>(row, above, size);
    case 4:
      return undo_filter<kPixelBytes, 4>(row, above, size);
    default:
      throw InvalidInput("is damaged: a row has a filter that does not exist");
  }
}

using UndoFilter = void (*)(int, Byte*, const Byte*, std::size_t);

UndoFilter undo_filter_for(std::size_t pixel_bytes) {
  switch (pixel_bytes) {
    case 1:
      return undo_filter_of_row<1>;
    case 2:
      return undo_filter_of_row<2>;
    case 3:
      return undo_filter_of_row<3>;
    case 4:
      return undo_filter_of_row<4>;
    case 6:
      return undo_filter_of_row<6>;
    default:
      return undo_filter_of_row<8>;
  }
}

template <typename Sample>
Sample load_sample(const Byte* bytes) {
  if constexpr (sizeof(Sample) == 1) {
    return *bytes;
  } else {
    return static_cast<Sample>((bytes[0] << 8U) | bytes[1]);
  }
}

/// Converts RGB(A) or grey of the file to BGR or grey.
template <typename Sample>
void copy_row(const Byte* bytes, const Layout& layout, Sample* pixels) {
  const std::size_t step = layout.pixel_bytes();
  if (layout.channels == 1) {
    for (int i = 0; i < layout.width; ++i, bytes += step) pixels[i] = load_sample<Sample>(bytes);
    return;
  }
  for (int i = 0; i < layout.width; ++i, bytes += step, pixels += 3) {
    pixels[2] = load_sample<Sample>(bytes);
    pixels[1] = load_sample<Sample>(bytes + sizeof(Sample));
    pixels[0] = load_sample<Sample>(bytes + 2 * sizeof(Sample));
  }
}

/// Of 1 to 12: the fastest. Higher ones make images of a camera hardly smaller.
constexpr int kCompression = 1;

/// The number of the filter that takes away the pixel to the left.
constexpr Byte kSubFilter = 1;

/// [bytes] A chunk has fewer than 2^31.
constexpr std::size_t kLargestChunk = std::size_t{1} << 30U;

void add_number(std::string& bytes, std::size_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>(value >> shift);
}

void add_chunk(std::string& bytes, std::string_view type, std::string_view data) {
  add_number(bytes, data.size());
  const std::size_t begin = bytes.size();
  bytes += type;
  bytes += data;
  add_number(bytes, libdeflate_crc32(0, bytes.data() + begin, bytes.size() - begin));
}

std::string deflate(const std::vector<Byte>& rows) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(kCompression), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::string packed(libdeflate_zlib_compress_bound(compressor.get(), rows.size()), '\0');
  packed.resize(libdeflate_zlib_compress(compressor.get(), rows.data(), rows.size(), packed.data(),
                                         packed.size()));
  return packed;
}

template <typename Sample>
void store_sample(Sample sample, Byte* bytes) {
  if constexpr (sizeof(Sample) == 1) {
    *bytes = sample;
  } else {
    bytes[0] = static_cast<Byte>(sample >> 8U);
    bytes[1] = static_cast<Byte>(sample);
  }
}

/// Converts BGR or grey to RGB or grey of the file.
template <typename Sample>
void store_row(const Sample* pixels, int width, int channels, Byte* bytes) {
  for (int i = 0; i < width; ++i, pixels += channels) {
    for (int channel = channels; channel-- > 0; bytes += sizeof(Sample)) {
      store_sample(pixels[channel], bytes);
    }
  }
}

/// The rows as a file has them before they are packed, each after the number of its filter.
std::vector<Byte> filtered_rows(const cv::Mat& image) {
  const std::size_t pixel_bytes = image.elemSize();
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * pixel_bytes;
  std::vector<Byte> rows(static_cast<std::size_t>(image.rows) * (row_bytes + 1));
  Byte* row = rows.data();
  for (int v = 0; v < image.rows; ++v, row += row_bytes) {
    *row++ = kSubFilter;
    if (image.depth() == CV_8U) {
      store_row(image.ptr<std::uint8_t>(v), image.cols, image.channels(), row);
    } else {
      store_row(image.ptr<std::uint16_t>(v), image.cols, image.channels(), row);
    }
    for (std::size_t i = row_bytes; i-- > pixel_bytes;) {
      row[i] = static_cast<Byte>(row[i] - row[i - pixel_bytes]);
    }
  }
  return rows;
}

}  // namespace

std::string find_png_damage(const std::string& bytes) {
  const std::string_view all = bytes;
  if (!all.starts_with(kSignature)) return "does not begin as a PNG file";
  std::size_t position = kSignature.size();
  while (position + kChunkFrame <= all.size()) {
    const std::size_t length = png_number(all.substr(position));
    if (length > all.size() - position - kChunkFrame) break;
    const std::string_view type = all.substr(position + 4, 4);
    if (libdeflate_crc32(0, type.data(), 4 + length) !=
        png_number(all.substr(position + 8 + length))) {
      return "is damaged: wrong checksum in chunk " + std::string(type) + " at byte " +
             std::to_string(position);
    }
    if (type == "IEND") return {};
    position += kChunkFrame + length;
  }
  return "is truncated: it ends after " + std::to_string(bytes.size()) +
         " bytes without the closing chunk";
}

cv::Mat decode_png(const std::string& bytes) {
  Layout layout;
  std::string packed;
  for (const PngChunk& chunk : png_chunks(bytes)) {
    if (chunk.type == "IHDR") {
      layout = read_layout(chunk.data);
      if (!layout.is_known) return {};
    } else if (chunk.type == "IDAT") {
      packed += chunk.data;
    }
  }
  if (layout.width == 0) throw InvalidInput("is damaged: it has no header");
  const std::size_t row_bytes = layout.row_bytes();
  std::vector<Byte> rows =
      inflate(packed, static_cast<std::size_t>(layout.height) * (row_bytes + 1));

  const int channels = layout.channels == 1 ? 1 : 3;
  cv::Mat image(layout.height, layout.width,
                CV_MAKETYPE(layout.sample_bytes == 1 ? CV_8U : CV_16U, channels));
  const UndoFilter undo = undo_filter_for(layout.pixel_bytes());
  const std::vector<Byte> nothing(row_bytes + kLongestPixel, 0);
  const Byte* above = nothing.data();
  for (int v = 0; v < layout.height; ++v) {
    Byte* row = rows.data() + static_cast<std::size_t>(v) * (row_bytes + 1);
    undo(row[0], row + 1, above, row_bytes);
    above = row + 1;
    if (layout.sample_bytes == 1) {
      copy_row(above, layout, image.ptr<std::uint8_t>(v));
    } else {
      copy_row(above, layout, image.ptr<std::uint16_t>(v));
    }
  }
  return image;
}

std::string encode_png(const cv::Mat& image) {
  const std::string packed = deflate(filtered_rows(image));
  std::string header;
  add_number(header, static_cast<std::size_t>(image.cols));
  add_number(header, static_cast<std::size_t>(image.rows));
  header += static_cast<char>(8 * image.elemSize1());          // bits
  header += static_cast<char>(image.channels() == 1 ? 0 : 2);  // grey or colour
  header.append(3, '\0');  // the only compression and family of filters; not interlaced
  std::string bytes(kSignature);
  add_chunk(bytes, "IHDR", header);
  for (std::size_t begin = 0; begin < packed.size(); begin += kLargestChunk) {
    add_chunk(bytes, "IDAT", std::string_view(packed).substr(begin, kLargestChunk));
  }
  add_chunk(bytes, "IEND", {});
  return bytes;
}

}  // namespace palpate::sensing
