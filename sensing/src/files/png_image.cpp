// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/png_image.h"

#include <png.h>
#include <zlib.h>

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/memory_limit.h"

namespace palpate::sensing {
namespace {

// Larger sizes in a header are refused: 2^28 pixels are 1 GB of depths.
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28U;

/// Unpacked bytes per packed byte: deflate codes at most 258 bytes by two bits.
constexpr std::size_t kMaxExpansion = 1032;

/// zlib level 1 of 9. Higher ones make images of a camera hardly smaller.
constexpr int kCompression = 1;

/// libpng leaves a function by longjmp, which runs no destructors: `work` must own nothing.
/// Returns false if libpng gave up.
template <typename Work>
bool succeeds(png_structp png, const Work& work) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT(cert-err52-cpp): libpng's interface
  work();
  return true;
}

/// Collects libpng's messages about a file: the reason of an error is often in a warning before it.
void note(png_structp png, png_const_charp text) {
  auto& faults = *static_cast<std::string*>(png_get_error_ptr(png));
  if (!faults.empty()) faults += "; ";
  faults += text;
}

[[noreturn]] void give_up(png_structp png, png_const_charp text) {
  note(png, text);
  png_longjmp(png, 1);
}

struct Input {
  const std::string& bytes;
  std::size_t position = 0;
  bool is_too_short = false;
};

void take_bytes(png_structp png, png_bytep to, std::size_t size) {
  auto& input = *static_cast<Input*>(png_get_io_ptr(png));
  input.is_too_short = size > input.bytes.size() - input.position;
  if (input.is_too_short) png_error(png, "end of file");
  std::memcpy(to, input.bytes.data() + input.position, size);
  input.position += size;
}

void append_bytes(png_structp png, png_bytep from, std::size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<char*>(from), size);
}

void flush_nothing(png_structp) {}

class Reader {
 public:
  explicit Reader(const std::string& bytes) : input_{bytes} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &faults_, give_up, note);
    info_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  cv::Mat read() {
    check(succeeds(png_, [this] { read_header(); }));
    cv::Mat image = new_image();
    check(succeeds(png_, [this, &image] { read_pixels(image); }));
    return image;
  }

 private:
  void check(bool succeeded) const {
    if (succeeded) return;
    if (input_.is_too_short) {
      throw InvalidInput("is truncated: it ends after " + std::to_string(input_.bytes.size()) +
                         " bytes without the closing chunk");
    }
    throw InvalidInput("is damaged before byte " + std::to_string(input_.position) + ": " +
                       faults_);
  }

  void read_header() {
    png_set_read_fn(png_, &input_, take_bytes);
    png_set_user_limits(png_, kMaxPixels, kMaxPixels);
    // Profiles, texts and the like are not unpacked, but their checksums are compared.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_benign_errors(png_, 0);  // more pixels than the header says are an error too
    png_read_info(png_, info_);
    row_bytes_in_file_ = png_get_rowbytes(png_, info_);
    png_set_palette_to_rgb(png_);
    png_set_expand_gray_1_2_4_to_8(png_);
    png_set_strip_alpha(png_);
    png_set_bgr(png_);
    png_set_swap(png_);  // 16 bit have their high byte first
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
  }

  /// Takes the memory of the image once the file can hold it.
  [[nodiscard]] cv::Mat new_image() const {
    const std::uint32_t width = png_get_image_width(png_, info_);
    const std::uint32_t height = png_get_image_height(png_, info_);
    if (std::uint64_t{width} * height > kMaxPixels) {
      throw InvalidInput("is damaged: its header says " + std::to_string(width) + " x " +
                         std::to_string(height) + " px; 1 to 2^28 pixels are possible");
    }
    const std::size_t file_size = input_.bytes.size();
    if (height * row_bytes_in_file_ / kMaxExpansion > file_size) {
      throw InvalidInput("is truncated or damaged: its " + std::to_string(file_size) +
                         " bytes cannot hold its pixels");
    }
    const std::size_t size = height * png_get_rowbytes(png_, info_);
    if (const auto wrong =
            beyond_memory_limit(static_cast<double>(size), static_cast<double>(file_size))) {
      throw InvalidInput(*wrong);
    }
    const int depth = png_get_bit_depth(png_, info_) == 16 ? CV_16U : CV_8U;
    return cv::Mat(static_cast<int>(height), static_cast<int>(width),
                   CV_MAKETYPE(depth, png_get_channels(png_, info_)));
  }

  void read_pixels(cv::Mat& image) {
    for (int pass = 0; pass < passes_; ++pass) {
      for (int v = 0; v < image.rows; ++v) png_read_row(png_, image.ptr(v), nullptr);
    }
    png_read_end(png_, nullptr);
  }

  Input input_;
  std::string faults_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::size_t row_bytes_in_file_ = 0;  ///< before a palette and few bits are expanded
  int passes_ = 1;                     ///< more if the rows are interlaced
};

void write_image(png_structp png, png_infop info, const cv::Mat& image) {
  png_set_user_limits(png, kMaxPixels, kMaxPixels);
  png_set_compression_level(png, kCompression);
  // Noise seldom repeats: looking for runs alone takes half the time and makes no larger files.
  png_set_compression_strategy(png, Z_RLE);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols),
               static_cast<png_uint_32>(image.rows), static_cast<int>(8 * image.elemSize1()),
               image.channels() == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  png_set_bgr(png);
  png_set_swap(png);
  for (int v = 0; v < image.rows; ++v) png_write_row(png, image.ptr(v));
  png_write_end(png, info);
}

}  // namespace

cv::Mat decode_png(const std::string& bytes) { return Reader(bytes).read(); }

std::string encode_png(const cv::Mat& image) {
  std::string bytes;
  std::string faults;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &faults, give_up, note);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  const bool is_written = info != nullptr && succeeds(png, [&] {
                            png_set_write_fn(png, &bytes, append_bytes, flush_nothing);
                            write_image(png, info, image);
                          });
  png_destroy_write_struct(&png, &info);
  if (!is_written) throw Error("libpng cannot write the image: " + faults);
  return bytes;
}

}  // namespace palpate::sensing
