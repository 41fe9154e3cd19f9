// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "range_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/sensing/reason_image.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::view {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// Folders of maps of a plane at depth z: 64 x 48 px.
struct Maps {
  ScratchFolder folder;

  fs::path add(const std::string& name, int count, float z) {
    const fs::path maps = folder / name;
    fs::create_directories(maps);
    write_text(maps / "rig.yaml",
               "%YAML:1.0\n---\ncamera_size: [ 64, 48 ]\n"
               "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
               "   data: [ 80, 0, 32, 0, 80, 24, 0, 0, 1 ]\n"
               "camera_distortion: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
               "   data: [ 0, 0, 0, 0, 0 ]\n");
    for (int i = 0; i < count; ++i)
      write(maps / ("00000" + std::to_string(i) + ".tiff"), z + static_cast<float>(i));
    return maps;
  }
  static void write(const fs::path& path, float z, int rows = 48, int cols = 64) {
    geometry::write_depth_tiff(path, geometry::ImageF::Constant(rows, cols, z));
  }
};

TEST(RangeSequence, ReadsTheMapAndWhatTheLayerNeeds) {
  Maps maps;
  const fs::path path = maps.add("range", 3, 700);
  Maps::write(path / "000001_sigma.tiff", 0.25F);
  sensing::write_reasons(path / "000001_reasons.tiff", sensing::ReasonImage::Constant(48, 64, 2));
  const fs::path other = maps.add("other", 3, 699.5F);
  const RangeSequence sequence(path, other, {});
  ASSERT_EQ(sequence.size(), 3u);
  EXPECT_EQ(sequence.name(2), "000002.tiff");
  EXPECT_FALSE(sequence.has(MapLayer::deviation)) << "not beside the first";
  EXPECT_EQ(sequence.read(2, MapLayer::depth).map.z(10, 20), 702);
  EXPECT_EQ(sequence.read(1, MapLayer::deviation).deviation(0, 0), 0.25F);
  EXPECT_EQ(sequence.read(1, MapLayer::reason).reasons(5, 5), 2);
  const RangeFrame compared = sequence.read(1, MapLayer::difference);
  ASSERT_TRUE(compared.score.has_value());
  EXPECT_EQ(compared.score->difference(40, 50), 0.5F);
  EXPECT_EQ(sequence.span(MapLayer::difference).high, 2);
  EXPECT_THAT(refusal([&] { return sequence.read(2, MapLayer::deviation); }),
              HasSubstr("000002_sigma.tiff"));
}

TEST(RangeSequence, ComparesAllMapsWithOne) {
  Maps maps;
  const fs::path path = maps.add("range", 2, 700);
  Maps::write(maps.folder / "truth.tiff", 700);
  const RangeSequence sequence(path, maps.folder / "truth.tiff", {});
  EXPECT_EQ(sequence.read(0, MapLayer::difference).score->difference(7, 7), 0);
  EXPECT_EQ(sequence.read(1, MapLayer::difference).score->difference(7, 7), 1);
}

TEST(RangeSequence, RefusesWhatDoesNotBelongTogether) {
  Maps maps;
  const fs::path path = maps.add("range", 3, 700), two = maps.add("two", 2, 700);
  EXPECT_THAT(refusal([&] { return RangeSequence(path, two, {}); }),
              HasSubstr("two has 2 range maps"));
  Maps::write(maps.folder / "small.tiff", 700, 20, 30);
  const RangeSequence sequence(path, maps.folder / "small.tiff", {});
  EXPECT_THAT(refusal([&] { return sequence.read(0, MapLayer::difference); }),
              ::testing::AllOf(HasSubstr("small.tiff: has 30 x 20 pixels"), HasSubstr("64 x 48")));
}

}  // namespace
}  // namespace palpate::view
