// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/track_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "palpate/core/error.h"
#include "run_palpate.h"
#include "scratch_folder.h"

namespace palpate::apps {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const std::vector<fs::path> kMaps = {"range/0.tiff", "range/1.tiff", "range/2.tiff"};

const auto kKeep = [](const TrackedFrame& /*frame*/, const fs::path& /*map*/) { return true; };

TEST(TrackRecord, KeepsFramesWithFiguresThatAreNotKnown) {
  const ScratchFolder scratch;
  {
    TrackRecord record(scratch.path(), {{"--nodes", 9}}, kMaps);
    record.add({.range_map = "0.tiff",
                .fingerprint = "a",
                .lost = {},
                .figures = {.rms = kNan,
                            .p95 = kNan,
                            .max = kNan,
                            .measured = 0.5,
                            .sigma_across = kNan,
                            .sigma_along = 0.25}});
    record.add({.range_map = "1.tiff", .fingerprint = "b", .lost = "nothing is there"});
    record.write();
  }
  TrackRecord again(scratch.path(), {{"--nodes", 9}}, kMaps);
  again.resume(kKeep);
  ASSERT_EQ(again.kept(), 2U);
  const geometry::TrackingFigures& figures = again.frames()[0].figures;
  for (const double figure : {figures.rms, figures.p95, figures.max, figures.sigma_across})
    EXPECT_TRUE(std::isnan(figure));
  EXPECT_EQ(figures.measured, 0.5);
  EXPECT_EQ(figures.sigma_along, 0.25);
  EXPECT_EQ(again.frames()[1].lost, "nothing is there");
  EXPECT_EQ(lost_frames(scratch.path()), std::vector<std::string>{"1.tiff"});
}

TEST(TrackRecord, ClaimsTheMeshesOfRangeMapsThatCameWhileItWasWritten) {
  const ScratchFolder scratch;
  {
    TrackRecord record(scratch.path(), Json::object(), {kMaps.front()});
    for (const fs::path& map : kMaps)
      record.add({.range_map = map.filename().string(), .fingerprint = "a", .lost = {}});
    record.write();
  }
  for (const char* const mesh : {"0.ply", "2.ply"}) write_text(scratch / mesh, "");
  const std::vector<fs::path> claimed = tracked_files(scratch.path());
  EXPECT_EQ(std::set<fs::path>(claimed.begin(), claimed.end()),
            (std::set<fs::path>{"0.ply", "2.ply"}));
  write_text(scratch / "3.ply", "");
  EXPECT_THROW((void)tracked_files(scratch.path()), InvalidInput);
}

}  // namespace
}  // namespace palpate::apps
