// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/range_map_feed.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "palpate/core/error.h"
#include "palpate/geometry/range_map.h"
#include "run_palpate.h"
#include "scratch_folder.h"

namespace palpate::apps {
namespace {

constexpr double kPatience = 0.3;  // [s]

class RangeMapFeedTest : public ::testing::Test {
 protected:
  RangeMapFeedTest() {
    geometry::write_depth_tiff(scratch / "map", geometry::ImageF::Constant(4, 5, 700.0F));
    whole = read_text(scratch / "map");
    fs::create_directory(folder);
  }

  void add(const std::string& name, std::size_t bytes = std::string::npos) const {
    std::ofstream(folder / name, std::ios::binary) << whole.substr(0, bytes);
  }
  [[nodiscard]] RangeMapFeed feed(std::optional<double> patience = kPatience) const {
    return {folder, MapCamera{}, patience};
  }

  ScratchFolder scratch;
  fs::path folder = scratch / "range";
  std::string whole;
};

TEST_F(RangeMapFeedTest, OfAFolderThatDoesNotGrowEnds) {
  add("0.tiff");
  add("1.tiff");
  RangeMapFeed maps = feed(std::nullopt);
  EXPECT_TRUE(maps.wait_for(1, [] { FAIL() << "waits"; }));
  EXPECT_FALSE(maps.wait_for(2, [] { FAIL() << "waits"; }));
  fs::remove(folder / "0.tiff");
  fs::remove(folder / "1.tiff");
  EXPECT_THROW((void)feed(std::nullopt), FileError);
}

TEST_F(RangeMapFeedTest, TakesWhatComesWhenItIsComplete) {
  RangeMapFeed maps = feed();
  int looks = 0;
  // A file that grows at every look is not complete.
  const auto write_slowly = [&] {
    if (++looks <= 4) add("0.tiff", whole.size() - 4 + static_cast<std::size_t>(looks));
  };
  EXPECT_TRUE(maps.wait_for(0, write_slowly));
  EXPECT_GT(looks, 4);
  EXPECT_EQ(read_text(maps.known().front()), whole);
  // One that others follow is.
  add("1.tiff");
  add("2.tiff");
  EXPECT_TRUE(maps.wait_for(1, [] {}));
  EXPECT_EQ(maps.known().size(), 3U);
  EXPECT_TRUE(maps.wait_for(2, [] {}));
  EXPECT_FALSE(maps.wait_for(3, [] {}));
}

TEST_F(RangeMapFeedTest, LeavesOutWhatComesTooLate) {
  add("0.tiff");
  add("2.tiff");
  RangeMapFeed maps = feed();
  EXPECT_TRUE(maps.wait_for(1, [] {}));
  add("1.tiff");
  add("3.tiff");
  EXPECT_TRUE(maps.wait_for(2, [] {}));
  EXPECT_EQ(maps.known().back(), folder / "3.tiff");
  EXPECT_EQ(maps.known().size(), 3U);
}

TEST_F(RangeMapFeedTest, SaysThatNothingCame) {
  RangeMapFeed maps = feed();
  EXPECT_THROW((void)maps.wait_for(0, [] {}), FileError);
}

TEST_F(RangeMapFeedTest, RefusesRangeMapsAmongDepthImages) {
  add("0.tiff");
  RangeMapFeed maps = feed();
  EXPECT_TRUE(maps.wait_for(0, [] {}));
  fs::copy(demo_data() / "depth_sequence/depth/000000.png", folder / "1.png");
  EXPECT_THROW((void)maps.wait_for(1, [] {}), InvalidInput);
}

}  // namespace
}  // namespace palpate::apps
