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
#include "refusal.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

std::string encoded(const cv::Mat& image, const std::vector<int>& settings = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes, settings);
  return {bytes.begin(), bytes.end()};
}

/// Smooth with noise, so that filters are useful and differ.
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

enum class Kind : char { grey = 0, colour = 2, palette = 3 };

/// A file with 8 bit a sample whose checksums are right, with these rows (a filter before each) and
/// chunks before them.
std::string file_of(int width, int height, const std::string& rows, Kind kind = Kind::grey,
                    bool is_interlaced = false, const std::string& chunks = {}) {
  std::string packed(rows.size() + 100, '\0');
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  packed.resize(
      libdeflate_zlib_compress(compressor, rows.data(), rows.size(), packed.data(), packed.size()));
  libdeflate_free_compressor(compressor);
  const std::string header =
      big_endian(static_cast<std::size_t>(width)) + big_endian(static_cast<std::size_t>(height)) +
      '\x08' + static_cast<char>(kind) + '\0' + '\0' + static_cast<char>(is_interlaced);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunks + chunk("IDAT", packed) +
         chunk("IEND", "");
}

std::string refusal_of(const std::string& bytes) {
  return refusal([&] { return decode_png(bytes); });
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
  const cv::Mat image = decode_png(file_of(3, 5, rows));
  // Mean: 10 + 6/2, 10 + (13+11)/2, 10 + (22+16)/2. Paeth: above 13 22 29 is nearest each time.
  const cv::Mat expected =
      (cv::Mat_<unsigned char>(5, 3) << 10, 20, 30, 5, 10, 15, 6, 11, 16, 13, 22, 29, 14, 24, 32);
  EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0) << image;
}

TEST(PngImage, GivesTheColoursOfAPaletteAndDropsTheirTransparency) {
  using namespace std::string_literals;
  const std::string chunks = chunk("PLTE", "\x01\x02\x03\x0A\x14\x1E"s) + chunk("tRNS", "\0\x80"s);
  const cv::Mat image = decode_png(file_of(3, 1, "\0\1\0\1"s, Kind::palette, false, chunks));
  ASSERT_EQ(image.type(), CV_8UC3);
  const cv::Mat expected = (cv::Mat_<cv::Vec3b>(1, 3) << cv::Vec3b(30, 20, 10), cv::Vec3b(3, 2, 1),
                            cv::Vec3b(30, 20, 10));
  EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0) << image;
}

TEST(PngImage, PutsInterlacedRowsInTheirPlaces) {
  // Begin and step of the seven passes along both sides (PNG specification, 8.2).
  constexpr int kPasses[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                 {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
  const cv::Mat image = scene(CV_8UC1);
  std::string rows;
  for (const auto& [u0, v0, du, dv] : kPasses) {
    for (int v = v0; v < image.rows; v += dv) {
      rows += '\0';
      for (int u = u0; u < image.cols; u += du) rows += static_cast<char>(image.at<uchar>(v, u));
    }
  }
  const cv::Mat read = decode_png(file_of(image.cols, image.rows, rows, Kind::grey, true));
  ASSERT_EQ(read.size(), image.size());
  EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0);
}

TEST(PngImage, ReadsBlackAndWhiteOfOneBit) {
  cv::Mat image = scene(CV_8UC1) > 100;
  const cv::Mat read = decode_png(encoded(image, {cv::IMWRITE_PNG_BILEVEL, 1}));
  ASSERT_EQ(read.type(), CV_8UC1);
  EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0);
}

TEST(PngImage, RefusesDamageThatChecksumsDoNotShow) {
  using namespace std::string_literals;
  const auto expect = [](const std::string& bytes, const std::string& words) {
    EXPECT_NE(refusal_of(bytes).find(words), std::string::npos) << refusal_of(bytes);
  };
  expect(file_of(2, 1, "\x05\0\0"s), "filter");
  expect(file_of(2, 2, "\0\0\0"s), "Not enough image data");
  expect(file_of(2, 1, "\0\0\0\0"s), "Too much image data");
  expect(file_of(1 << 14, 1 << 14, "\0"s), "cannot hold its pixels");
  expect(file_of(0, 1, "\0"s), "Image width is zero");
  expect(file_of(1 << 20, 1 << 20, "\0"s), "2^28");
  expect("\x89PNG\r\n\x1a\n" + chunk("IEND", ""), "IEND: out of place");
}

TEST(PngImage, RefusesWhatUnpacksToHundredsOfMegabytesBeforeItTakesThem) {
  std::mt19937 random(1);
  std::string rows(800'000, '\0');  // as many bytes when packed, which could hold 826 MB
  for (char& byte : rows) byte = static_cast<char>(random());
  const std::string message = refusal_of(file_of(1 << 14, 1 << 14, rows, Kind::colour));
  EXPECT_NE(message.find("so compressed that reading it takes 805 MB; the limit is 563 MB"),
            std::string::npos)
      << message;
}

TEST(PngImage, DoesNotUnpackTextsAndProfiles) {
  using namespace std::string_literals;
  // A text of 1 MB that is damaged inside: it is not read.
  const std::string chunks = chunk("zTXt", "note\0\0"s + std::string(1'000'000, '\1'));
  const cv::Mat image = decode_png(file_of(1, 1, "\0\7"s, Kind::grey, false, chunks));
  EXPECT_EQ(image.at<uchar>(0, 0), 7);
}

TEST(PngImage, RefusesTruncatedFilesAndChangedBytes) {
  const std::string whole = read_text(demo_path("truth/duck_lit.png"));
  EXPECT_FALSE(decode_png(whole).empty());
  for (std::size_t length = 0; length < whole.size(); length += 101) {
    EXPECT_EQ(refusal_of(whole.substr(0, length)).find("is truncated"), 0) << length;
  }
  EXPECT_EQ(refusal_of(whole.substr(0, whole.size() - 1)), "is truncated: it ends after " +
                                                               std::to_string(whole.size() - 1) +
                                                               " bytes without the closing chunk");
  for (std::size_t place = 0; place < whole.size(); place += 53) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 4);
    EXPECT_NE(refusal_of(damaged), "") << place;
  }
}

TEST(PngImage, SaysWhereAFileIsDamaged) {
  std::string damaged = read_text(demo_path("truth/duck_lit.png"));
  damaged[damaged.size() - 1] ^= 1;  // the checksum of the closing chunk
  EXPECT_EQ(refusal_of(damaged),
            "is damaged before byte " + std::to_string(damaged.size()) + ": IEND: CRC error");
}

}  // namespace
}  // namespace palpate::sensing
