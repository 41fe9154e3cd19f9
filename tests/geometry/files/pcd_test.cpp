// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <lzf.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

constexpr int kCloudWidth = 40;
constexpr int kCloudHeight = 3;
constexpr int kPoints = kCloudWidth * kCloudHeight;

/// Every seventh point is unknown.
Eigen::Vector3d point(int i) {
  if (i % 7 == 2) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {double{0.7F * static_cast<float>(i)}, -1000.1 - i, double{0.1F}};
}

/// x and z are float, y double, with colour in front, and descriptors between them.
std::string header(const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS rgb x fpfh y _ z\nSIZE 4 4 2 8 1 4\nTYPE U F I F U F\n"
         "COUNT 1 1 3 1 1 1\nWIDTH 40\nHEIGHT 3\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 120\nDATA " +
         data + "\n";
}

std::string binary() {
  std::string bytes;
  for (int i = 0; i < kPoints; ++i) {
    put<std::uint32_t>(bytes, 0xff00ff);
    put(bytes, static_cast<float>(point(i).x()));
    for (std::int16_t k = 0; k < 3; ++k) put(bytes, k);
    put(bytes, point(i).y());
    put<std::uint8_t>(bytes, 0);
    put(bytes, static_cast<float>(point(i).z()));
  }
  return header("binary") + bytes;
}

std::string compressed_part() {
  std::string bytes;
  for (int i = 0; i < kPoints; ++i) put<std::uint32_t>(bytes, 0xff00ff);
  for (int i = 0; i < kPoints; ++i) put(bytes, static_cast<float>(point(i).x()));
  for (int i = 0; i < kPoints; ++i)
    for (std::int16_t k = 0; k < 3; ++k) put(bytes, k);
  for (int i = 0; i < kPoints; ++i) put(bytes, point(i).y());
  for (int i = 0; i < kPoints; ++i) put<std::uint8_t>(bytes, 0);
  for (int i = 0; i < kPoints; ++i) put(bytes, static_cast<float>(point(i).z()));
  std::string packed(bytes.size(), '\0');
  packed.resize(lzf_compress(bytes.data(), static_cast<unsigned>(bytes.size()), packed.data(),
                             static_cast<unsigned>(packed.size())));
  std::string part;
  put(part, static_cast<std::uint32_t>(packed.size()));
  put(part, static_cast<std::uint32_t>(bytes.size()));
  return part + packed;
}

std::string ascii() {
  std::string text = header("ascii");
  for (int i = 0; i < kPoints; ++i) {
    const auto word = [](double value) {
      std::array<char, 40> digits;
      return std::string(digits.data(), static_cast<std::size_t>(std::snprintf(
                                            digits.data(), digits.size(), "%.17g ", value)));
    };
    text += "16711935 " + word(point(i).x()) + "0 1 2 " + word(point(i).y()) + "0 " +
            word(point(i).z());
    text.back() = '\n';
  }
  return text;
}

Eigen::Matrix3Xd read_pcd(const std::string& content) {
  const ScratchFolder folder;
  write_text(folder / "points.pcd", content);
  return read_points(folder / "points.pcd");
}

void expect_pcd_refused(const std::string& content, const std::string& words) {
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_pcd(content)), FileError, words);
}

TEST(Pcd, ReadsAllThreeKindsAlikeAndKeepsUnknownPoints) {
  for (const std::string& content :
       {ascii(), binary(), header("binary_compressed") + compressed_part()}) {
    const Eigen::Matrix3Xd points = read_pcd(content);
    ASSERT_EQ(points.cols(), kPoints);
    for (int i = 0; i < kPoints; ++i) {
      if (point(i).hasNaN())
        EXPECT_TRUE(points.col(i).array().isNaN().all()) << i;
      else
        EXPECT_EQ(points.col(i), point(i)) << i;
    }
  }
}

TEST(Pcd, CountAndHeightMayBeLeftOut) {
  const Eigen::Matrix3Xd points = read_pcd(
      "VERSION .5\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 0.1");
  ASSERT_EQ(points.cols(), 2);
  EXPECT_EQ(points.col(1), Eigen::Vector3d(4, 5, 0.1));
}

TEST(Pcd, RefusesEveryTruncation) {
  const ScratchFolder folder;
  const auto refuse = [&](const std::string& part) {
    overwrite(folder / "points.pcd", part);
    EXPECT_THROW(static_cast<void>(read_points(folder / "points.pcd")), FileError) << part.size();
  };
  for (const std::string& whole : {binary(), header("binary_compressed") + compressed_part()})
    for (std::size_t size = 0; size < whole.size(); size += 13) refuse(whole.substr(0, size));
  const std::string text = ascii();
  for (std::size_t size = 0; size + 10 < text.size(); size += 101) refuse(text.substr(0, size));
}

TEST(Pcd, TellsHowMuchOfATruncatedFileIsThere) {
  constexpr std::size_t kPointBytes = 27;
  expect_pcd_refused(binary().substr(0, header("binary").size() + 50 * kPointBytes + 9),
                     "holds 50 of 120 points");
  const std::string text = ascii();
  expect_pcd_refused(text.substr(0, text.size() - text.size() / 3),
                     " of 120 points; it is truncated");
}

TEST(Pcd, AHugeCountTakesNoMemory) {
  for (const std::string& whole :
       {ascii(), binary(), header("binary_compressed") + compressed_part()}) {
    const std::string wide = replaced(whole, "WIDTH 40", "WIDTH 4000000000");
    expect_pcd_refused(wide, "POINTS is 120, but WIDTH x HEIGHT is 4000000000 x 3");
    expect_pcd_refused(
        replaced(replaced(wide, "POINTS 120", "POINTS 4000000000"), "HEIGHT 3", "HEIGHT 1"),
        "4000000000");
  }
  expect_pcd_refused(replaced(ascii(), "POINTS 120", "POINTS 99999999999999999999"),
                     "POINTS is \"999999");
  expect_pcd_refused(replaced(ascii(), "COUNT 1 1 3", "COUNT 1 1 3000000000"),
                     "COUNT is \"3000000000\"");
}

TEST(Pcd, RefusesADamagedCompressedPart) {
  std::string part = compressed_part();
  for (std::size_t i = 8; i < part.size(); ++i) part[i] = '\xff';  // references before the start
  expect_pcd_refused(header("binary_compressed") + part, "compressed part is damaged");
  std::string sizes = compressed_part();
  sizes[0] = '\1';
  sizes[1] = sizes[2] = '\0';
  expect_pcd_refused(header("binary_compressed") + sizes, "1 compressed bytes cannot hold 3240");
}

TEST(Pcd, RefusesAWrongHeader) {
  expect_pcd_refused("a letter\nto a friend\n", "is not a PCD file");
  expect_pcd_refused(replaced(ascii(), "DATA ascii", "DATA morse"), "DATA is \"morse\"");
  expect_pcd_refused(replaced(ascii(), " y ", " v "), "no field y");
  expect_pcd_refused(replaced(ascii(), "SIZE 4 4 2", "SIZE 4 3 2"),
                     "field x is of TYPE F and SIZE 3");
  expect_pcd_refused(replaced(ascii(), "TYPE U F", "TYPE U"), "as many words");
  expect_pcd_refused(replaced(ascii(), "-1003.1", "much"), "field y: \"much");
  expect_pcd_refused(replaced(replaced(ascii(), "WIDTH 40", "WIDTH 0"), "POINTS 120", "POINTS 0"),
                     "no points");
}

TEST(Pcd, IsNoMesh) {
  const ScratchFolder folder;
  write_text(folder / "points.pcd", binary());
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "points.pcd")), FileError,
                        "without a surface");
}

}  // namespace
}  // namespace palpate::geometry
