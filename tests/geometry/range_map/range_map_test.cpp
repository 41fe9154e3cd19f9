// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map.h"

#include <gtest/gtest.h>
#include <tiffio.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <vector>

#include "file_testing.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "repository.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

const fs::path kTruth = repository("demo/truth");

/// Values that use every bit of the mantissa, with holes.
ImageF awkward_image(Eigen::Index rows, Eigen::Index cols) {
  ImageF z(rows, cols);
  for (Eigen::Index i = 0; i < z.size(); ++i)
    z.data()[i] = i % 7 == 3 ? kFloatNaN : 1000.1F + 0.37F * std::sin(0.7F * static_cast<float>(i));
  return z;
}

bool same_pixels(const ImageF& a, const ImageF& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (std::isnan(a.data()[i]) && std::isnan(b.data()[i])) continue;
    if (std::bit_cast<std::uint32_t>(a.data()[i]) != std::bit_cast<std::uint32_t>(b.data()[i]))
      return false;
  }
  return true;
}

struct Layout {
  const char* mode = "w";  // "wb": big endian
  std::uint16_t compression = COMPRESSION_NONE;
  std::uint16_t predictor = PREDICTOR_NONE;
  std::uint32_t tile = 0;  // edge, 0 = strips
};

void write_foreign_tiff(const fs::path& path, const ImageF& z, const Layout& layout) {
  TIFF* file = TIFFOpen(path.c_str(), layout.mode);
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(z.cols()));
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(z.rows()));
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 32);
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(file, TIFFTAG_COMPRESSION, layout.compression);
  if (layout.predictor != PREDICTOR_NONE) TIFFSetField(file, TIFFTAG_PREDICTOR, layout.predictor);
  if (layout.tile > 0) {
    TIFFSetField(file, TIFFTAG_TILEWIDTH, layout.tile);
    TIFFSetField(file, TIFFTAG_TILELENGTH, layout.tile);
    const auto edge = static_cast<Eigen::Index>(layout.tile);
    for (Eigen::Index row = 0; row < z.rows(); row += edge)
      for (Eigen::Index col = 0; col < z.cols(); col += edge) {
        ImageF tile = ImageF::Zero(edge, edge);
        for (Eigen::Index r = 0; r < std::min(edge, z.rows() - row); ++r)
          for (Eigen::Index c = 0; c < std::min(edge, z.cols() - col); ++c)
            tile(r, c) = z(row + r, col + c);
        TIFFWriteTile(file, tile.data(), static_cast<std::uint32_t>(col),
                      static_cast<std::uint32_t>(row), 0, 0);
      }
  } else {
    TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, 3);
    ImageF copy = z;
    for (Eigen::Index row = 0; row < z.rows(); ++row)
      TIFFWriteScanline(file, copy.row(row).data(), static_cast<std::uint32_t>(row));
  }
  TIFFClose(file);
}

TEST(RangeMap, RoundTripsEveryBit) {
  const ScratchFolder folder;
  for (const auto& [rows, cols] : {std::pair{1, 1}, {37, 53}, {300, 411}}) {
    const ImageF z = awkward_image(rows, cols);
    write_depth_tiff(folder / "z.tiff", z);
    EXPECT_TRUE(same_pixels(read_depth_tiff(folder / "z.tiff"), z));
  }
}

TEST(RangeMap, WhatItWritesIsReadByOpenCv) {
  const ScratchFolder folder;
  const ImageF z = awkward_image(37, 53);
  write_depth_tiff(folder / "z.tiff", z);
  const cv::Mat image = cv::imread((folder / "z.tiff").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_32FC1);
  EXPECT_TRUE(same_pixels(Eigen::Map<const ImageF>(image.ptr<float>(), image.rows, image.cols), z));
}

TEST(RangeMap, ReadsStripsTilesCompressionsAndBothByteOrders) {
  const ScratchFolder folder;
  const ImageF z = awkward_image(41, 37);
  for (const Layout layout :
       {Layout{}, Layout{.mode = "wb"}, Layout{.mode = "wb", .compression = COMPRESSION_LZW},
        Layout{.compression = COMPRESSION_LZW, .predictor = PREDICTOR_FLOATINGPOINT},
        Layout{.compression = COMPRESSION_PACKBITS},
        Layout{.mode = "w8", .compression = COMPRESSION_ADOBE_DEFLATE}, Layout{.tile = 16},
        Layout{.mode = "wb", .tile = 32}}) {
    write_foreign_tiff(folder / "z.tiff", z, layout);
    EXPECT_TRUE(same_pixels(read_depth_tiff(folder / "z.tiff"), z))
        << layout.mode << " " << layout.compression << " " << layout.tile;
  }
}

TEST(RangeMap, ValuesThatAreNoDepthBecomeNan) {
  const ScratchFolder folder;
  ImageF z(1, 5);
  z << 1000.1F, 0, -3, std::numeric_limits<float>::infinity(), kFloatNaN;
  write_depth_tiff(folder / "z.tiff", z);
  const ImageF read = read_depth_tiff(folder / "z.tiff");
  EXPECT_EQ(read(0), 1000.1F);
  for (Eigen::Index i = 1; i < 5; ++i) EXPECT_TRUE(std::isnan(read(i))) << i;
}

TEST(RangeMap, ReadsTheBundledTruthAsOpenCvDoes) {
  for (const char* name : {"duck", "flag_a", "flag_b", "plane"}) {
    const fs::path path = kTruth / (std::string(name) + ".tiff");
    const ImageF z = read_depth_tiff(path);
    const cv::Mat image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type(), CV_32FC1);
    EXPECT_TRUE(
        same_pixels(z, Eigen::Map<const ImageF>(image.ptr<float>(), image.rows, image.cols)));
    EXPECT_EQ(z.rows(), 480);
    EXPECT_EQ(z.cols(), 640);
    const auto known = !z.isNaN();
    EXPECT_GT(known.count(), z.size() / 10);
    EXPECT_GT(known.select(z, std::numeric_limits<float>::infinity()).minCoeff(), 300);
    EXPECT_LT(known.select(z, 0).maxCoeff(), 3000);
  }
}

TEST(RangeMap, RefusesWhatIsMissingEmptyOrNoTiff) {
  const ScratchFolder folder;
  write_text(folder / "empty.tiff", "");
  write_text(folder / "text.tiff", "depth,1,2,3\n");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder / "none.tiff")), FileError,
                        "none.tiff: no such file");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder.path())), FileError,
                        "no such file");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder / "empty.tiff")), FileError,
                        "empty.tiff: is not a TIFF file");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder / "text.tiff")), FileError,
                        "1 channel of 32 bit floating-point");
}

TEST(RangeMap, RefusesATruncatedFileWhereverItEnds) {
  const ScratchFolder folder;
  // Uncompressed with the directory in front, as streaming writers do, and ours with it at the end.
  write_foreign_tiff(folder / "foreign.tiff", awkward_image(41, 37), {});
  write_depth_tiff(folder / "own.tiff", awkward_image(41, 37));
  for (const char* name : {"foreign.tiff", "own.tiff"}) {
    const std::string whole = read_text(folder / name);
    for (std::size_t size = 0; size < whole.size(); size += 97) {
      write_text(folder / "part.tiff", whole.substr(0, size));
      EXPECT_THROW(static_cast<void>(read_depth_tiff(folder / "part.tiff")), FileError) << size;
    }
  }
}

// The length of an image is changed: libtiff uses any bytes as the tiles that are missing.
TEST(RangeMap, RefusesAFileOfTilesThatAreNotInIt) {
  const ScratchFolder folder;
  write_foreign_tiff(folder / "z.tiff", awkward_image(16, 16), {.tile = 16});
  std::string bytes = read_text(folder / "z.tiff");
  const std::string length = {'\x01', '\x01', '\x03', 0, 1, 0, 0, 0, 16, 0};  // tag 257, one SHORT
  const std::size_t at = bytes.find(length);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + 8, 2, "\x60\xea");  // 60,000
  write_text(folder / "z.tiff", bytes);
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder / "z.tiff")), FileError,
                        "tile 1 of 3750 is not in the file");
}

TEST(RangeMap, SaysWhichRowsOfDamagedDataAreLost) {
  const ScratchFolder folder;
  write_foreign_tiff(folder / "z.tiff", awkward_image(41, 37),
                     {.compression = COMPRESSION_ADOBE_DEFLATE});
  std::string bytes = read_text(folder / "z.tiff");
  bytes.replace(8, 40, 40, '\x55');  // the first strip follows the header of 8 bytes
  write_text(folder / "z.tiff", bytes);
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder / "z.tiff")), FileError,
                        "cannot be read from row 0 of 41 on");
}

TEST(RangeMap, RefusesOtherSampleTypesAndSaysWhatTheyAre) {
  const ScratchFolder folder;
  cv::imwrite((folder / "gray.tiff").string(), cv::Mat(4, 5, CV_8UC1, cv::Scalar(3)));
  cv::imwrite((folder / "depth.tiff").string(), cv::Mat(4, 5, CV_16UC1, cv::Scalar(3)));
  cv::imwrite((folder / "double.tiff").string(), cv::Mat(4, 5, CV_64FC1, cv::Scalar(3)));
  cv::imwrite((folder / "color.tiff").string(), cv::Mat(4, 5, CV_32FC3, cv::Scalar(3)),
              {cv::IMWRITE_TIFF_COMPRESSION, COMPRESSION_NONE});
  const auto check = [&](const char* name, const char* words) {
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder / name)), FileError, words);
  };
  check("gray.tiff", "1 channel of 8 bit unsigned integer; a range map is");
  check("depth.tiff", "1 channel of 16 bit unsigned integer");
  check("double.tiff", "1 channel of 64 bit floating-point");
  check("color.tiff", "3 channels of 32 bit floating-point");
}

TEST(RangeMap, RefusesAHeaderThatAsksForMoreMemoryThanAnyRangeMap) {
  const ScratchFolder folder;
  TIFF* file = TIFFOpen((folder / "huge.tiff").c_str(), "w");
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 2000000000U);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, 2000000000U);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 32);
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, 2000000000U);
  TIFFClose(file);
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(folder / "huge.tiff")), FileError,
                        "huge.tiff");
}

TEST(RangeMap, KeepsTheOldFileWhenTheDiskIsFull) {
  const ScratchFolder folder;
  const ImageF z = awkward_image(100, 100);
  write_depth_tiff(folder / "z.tiff", z);
  const std::string old = read_text(folder / "z.tiff");
  // From no room at all to a file that lacks only its end.
  for (std::size_t room = 0; room < old.size(); room += 1 + old.size() / 17) {
    const FullDisk disk(room);
    EXPECT_THROWS_MESSAGE(write_depth_tiff(folder / "z.tiff", z), OutputError, "unchanged");
  }
  const FullDisk disk(old.size() - 1);
  EXPECT_THROWS_MESSAGE(write_depth_tiff(folder / "z.tiff", z), OutputError, "unchanged");
  EXPECT_EQ(read_text(folder / "z.tiff"), old);
  EXPECT_EQ(folder.entries(), 1);
}

TEST(RangeMap, ThreadsReadAndWriteSideBySideAndErrorsStayWithTheirFile) {
  const ScratchFolder folder;
  write_text(folder / "text.tiff", "depth,1,2,3\n");
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread)
    threads.emplace_back([&folder, thread] {
      const ImageF z = awkward_image(31 + thread, 17);
      const fs::path path = folder / ("z" + std::to_string(thread) + ".tiff");
      for (int repeat = 0; repeat < 20; ++repeat) {
        write_depth_tiff(path, z);
        EXPECT_TRUE(same_pixels(read_depth_tiff(path), z));
        EXPECT_THROW(static_cast<void>(read_depth_tiff(folder / "text.tiff")), FileError);
      }
    });
  for (std::thread& thread : threads) thread.join();
}

TEST(RangeMap, RefusesToWriteNothing) {
  const ScratchFolder folder;
  EXPECT_THROWS_MESSAGE(write_depth_tiff(folder / "z.tiff", ImageF()), InvalidInput,
                        "without pixels");
}

Camera small_camera() {
  return {.width = 5,
          .height = 4,
          .fx = 6.1,
          .fy = 5.9,
          .cx = 2.1,
          .cy = 1.7,
          .distortion = {-0.1, 0.02}};
}

TEST(BackProject, EachPointProjectsToItsPixelAtItsDepth) {
  RangeMap map{awkward_image(4, 5), small_camera()};
  const Eigen::Matrix3Xd points = back_project(map);
  ASSERT_EQ(points.cols(), 20);
  constexpr double kPixelRounding = 1e-12;
  for (int row = 0; row < 4; ++row)
    for (int col = 0; col < 5; ++col) {
      const Eigen::Vector3d point = points.col(row * 5 + col);
      if (std::isnan(map.z(row, col))) {
        EXPECT_TRUE(point.array().isNaN().all());
        continue;
      }
      EXPECT_EQ(point.z(), static_cast<double>(map.z(row, col)));
      const Eigen::Vector2d pixel = distort(map.camera, point.hnormalized());
      EXPECT_NEAR(pixel.x(), col, kPixelRounding);
      EXPECT_NEAR(pixel.y(), row, kPixelRounding);
    }
}

TEST(BackProject, RefusesACameraOfAnotherSize) {
  const RangeMap map{awkward_image(5, 4), small_camera()};
  EXPECT_THROWS_MESSAGE(static_cast<void>(back_project(map)), InvalidInput,
                        "depths are 4 x 5 px, but the camera is 5 x 4 px");
}

}  // namespace
}  // namespace palpate::geometry
