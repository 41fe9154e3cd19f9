// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/png_image.h"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

std::string encoded(const cv::Mat& image, const std::vector<int>& settings = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes, settings);
  return {bytes.begin(), bytes.end()};
}

/// Smooth with noise, so that filters pay and differ.
cv::Mat scene(int type, int width = 61) {
  cv::Mat image(47, width, type);
  const double most = image.depth() == CV_8U ? 255 : 65535;
  cv::randu(image, 0, most / 8);
  for (int v = 0; v < image.rows; ++v) image.row(v) += cv::Scalar::all(most / 2 * (v % 20) / 20);
  return image;
}

std::string big_endian(std::size_t number) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U})
    bytes += static_cast<char>((number >> shift) & 0xFFU);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  return big_endian(data.size()) + body + big_endian(libdeflate_crc32(0, body.data(), body.size()));
}

/// A file of 8 bit grey whose checksums are right, with these rows (a filter before each).
std::string grey_file(int width, int height, const std::string& rows) {
  std::string packed(rows.size() + 100, '\0');
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  packed.resize(
      libdeflate_zlib_compress(compressor, rows.data(), rows.size(), packed.data(), packed.size()));
  libdeflate_free_compressor(compressor);
  using namespace std::string_literals;
  const std::string header = big_endian(static_cast<std::size_t>(width)) +
                             big_endian(static_cast<std::size_t>(height)) + "\x08\0\0\0\0"s;
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", packed) + chunk("IEND", "");
}

TEST(PngImage, AgreesWithOpenCvForEveryFilterDepthAndNumberOfChannels) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}) {
    for (const int width : {1, 2, 61}) {
      const cv::Mat image = scene(type, width);
      // Levels and strategies of zlib lead libpng to other filters.
      for (const int strategy :
           {cv::IMWRITE_PNG_STRATEGY_DEFAULT, cv::IMWRITE_PNG_STRATEGY_FILTERED,
            cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY}) {
        const std::string bytes =
            encoded(image, {cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY, strategy});
        const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U,
                             const_cast<char*>(bytes.data()));
        const cv::Mat expected = cv::imdecode(buffer, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
        const cv::Mat read = decode_png(bytes);
        ASSERT_EQ(read.type(), expected.type());
        EXPECT_EQ(cv::norm(read, expected, cv::NORM_INF), 0);
      }
    }
  }
}

TEST(PngImage, WritesWhatOpenCvReads) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    for (const int width : {1, 2, 61}) {
      const cv::Mat whole = scene(type, width);
      // The second one is not continuous in memory.
      for (const cv::Mat& image : {whole, whole(cv::Rect(width / 2, 3, width - width / 2, 40))}) {
        const std::string bytes = encode_png(image);
        EXPECT_EQ(find_png_damage(bytes), "");
        const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U,
                             const_cast<char*>(bytes.data()));
        const cv::Mat read = cv::imdecode(buffer, cv::IMREAD_UNCHANGED);
        ASSERT_EQ(read.type(), type);
        ASSERT_EQ(read.size(), image.size());
        EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0);
      }
    }
  }
}

TEST(PngImage, UndoesEachFilterAsTheStandardSays) {
  using namespace std::string_literals;
  // Rows of three pixels, each row with another filter: 10 20 30 | left | above | mean | Paeth.
  const std::string rows =
      "\x00\x0A\x14\x1E"s
      "\x01\x05\x05\x05"s
      "\x02\x01\x01\x01"s
      "\x03\x0A\x0A\x0A"s
      "\x04\x01\x02\x03"s;
  const cv::Mat image = decode_png(grey_file(3, 5, rows));
  // Mean: 10 + 6/2, 10 + (13+11)/2, 10 + (22+16)/2. Paeth: above 13 22 29 is nearest each time.
  const cv::Mat expected =
      (cv::Mat_<unsigned char>(5, 3) << 10, 20, 30, 5, 10, 15, 6, 11, 16, 13, 22, 29, 14, 24, 32);
  EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0) << image;
}

TEST(PngImage, LeavesOtherKindsToOpenCv) {
  using namespace std::string_literals;
  std::string palette = grey_file(1, 1, "\0\0"s);
  palette[8 + 8 + 9] = 3;
  EXPECT_TRUE(decode_png(palette).empty());
  std::string interlaced = grey_file(1, 1, "\0\0"s);
  interlaced[8 + 8 + 12] = 1;
  EXPECT_TRUE(decode_png(interlaced).empty());
}

TEST(PngImage, RefusesDamageThatChecksumsDoNotShow) {
  using namespace std::string_literals;
  const auto refusal = [](const std::string& bytes) {
    EXPECT_EQ(find_png_damage(bytes), "");
    return message_of<InvalidInput>([&] { (void)decode_png(bytes); });
  };
  EXPECT_NE(refusal(grey_file(2, 1, "\x05\0\0"s)).find("filter"), std::string::npos);
  EXPECT_NE(refusal(grey_file(2, 2, "\0\0\0"s)).find("cannot be unpacked"), std::string::npos);
  EXPECT_NE(refusal(grey_file(2, 1, "\0\0\0\0"s)).find("cannot be unpacked"), std::string::npos);
  EXPECT_NE(refusal(grey_file(1 << 14, 1 << 14, "\0"s)).find("cannot hold its pixels"),
            std::string::npos);
  EXPECT_NE(refusal(grey_file(0, 1, "\0"s)).find("0 x 1 px"), std::string::npos);
  EXPECT_NE(refusal(grey_file(1 << 20, 1 << 20, "\0"s)).find("2^28"), std::string::npos);
  EXPECT_NE(refusal("\x89PNG\r\n\x1a\n" + chunk("IEND", "")).find("no header"), std::string::npos);
}

TEST(PngImage, RefusesWhatUnpacksToHundredsOfMegabytesBeforeItTakesThem) {
  std::mt19937 random(1);
  std::string rows(300'000, '\0');  // as many bytes when packed, which could hold 300 MB
  for (char& byte : rows) byte = static_cast<char>(random());
  const std::string message =
      message_of<InvalidInput>([&] { (void)decode_png(grey_file(1 << 14, 1 << 14, rows)); });
  EXPECT_NE(message.find("so compressed that reading it takes 537 MB; the limit is 531 MB"),
            std::string::npos)
      << message;
}

TEST(PngDamage, FindsNothingInWholeFiles) {
  EXPECT_EQ(find_png_damage(read_text(demo_path("frames/duck.png"))), "");
  EXPECT_EQ(find_png_damage(read_text(demo_path("truth/duck_id.png"))), "");
}

TEST(PngDamage, FindsTruncationAndChangedBytes) {
  const std::string whole = read_text(demo_path("truth/duck_lit.png"));
  for (std::size_t length = 0; length < whole.size(); length += 101) {
    EXPECT_NE(find_png_damage(whole.substr(0, length)), "") << length;
  }
  EXPECT_NE(find_png_damage(whole.substr(0, whole.size() - 1)), "");
  for (std::size_t place = 0; place < whole.size(); place += 53) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 4);
    EXPECT_NE(find_png_damage(damaged), "") << place;
  }
}

TEST(PngDamage, AChunkLongerThanAnyFileIsTruncation) {
  std::string huge = read_text(demo_path("truth/duck_lit.png"));
  for (std::size_t i = 8; i < 12; ++i) huge[i] = '\xFF';
  EXPECT_NE(find_png_damage(huge).find("truncated"), std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
