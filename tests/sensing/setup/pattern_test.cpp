// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "code_blocks.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

TEST(Pattern, ReadsTheBundledPattern) {
  const Pattern pattern = read_pattern(demo_path("pattern.yaml"));
  ASSERT_EQ(pattern.colors.size(), 6U);
  EXPECT_EQ(pattern.colors[5].name, "M");
  EXPECT_EQ(pattern.colors[5].rgb, Eigen::Vector3d(1, 0, 1));
  ASSERT_EQ(pattern.stripes.size(), 31U);
  EXPECT_EQ(pattern.stripes[1], 5);
  EXPECT_EQ(pattern.stripe_edges[15], 528.5);
  EXPECT_EQ(pattern.axis, Axis::y);
  EXPECT_EQ(pattern.period, 10);
  EXPECT_EQ(pattern.phase, 0);
  EXPECT_EQ(pattern.mean, 0.575);
  EXPECT_EQ(pattern.amplitude, 0.425);
  EXPECT_FALSE(pattern.projector_size);
}

TEST(Pattern, ReadsTheNodeForSeveralImagesThatThePageShows) {
  const std::vector<std::string> blocks = code_blocks("docs/multishot.md", "yaml");
  ASSERT_EQ(blocks.size(), 1u);
  const ScratchFolder folder;
  const Pattern pattern = read_pattern(
      written(folder, "p.yaml",
              "%YAML:1.0\n---\naxis: x\nperiod_px: 40\nphase: 0\nmean: 0.5\namplitude: 0.5\n"
              "projector_size: [ 640, 480 ]\n" +
                  blocks[0]));
  ASSERT_TRUE(pattern.multishot);
  EXPECT_EQ(pattern.multishot->shifts.size(), 4u);
  EXPECT_EQ(pattern.multishot->code_bits, 7);
}

TEST(Pattern, MayHaveNoStripes) {
  const ScratchFolder folder;
  const Pattern pattern = read_pattern(
      written(folder, "p.yaml",
              "%YAML:1.0\n---\naxis: x\nperiod_px: 60\nphase: 1.5\nmean: 0.5\namplitude: 0.5\n"));
  EXPECT_TRUE(pattern.stripes.empty());
  EXPECT_EQ(pattern.axis, Axis::x);
  EXPECT_EQ(pattern.period, 60);
}

TEST(Pattern, SaysWhatSeveralImagesOfAStillSceneShow) {
  const ScratchFolder folder;
  Pattern pattern{.axis = Axis::x, .period = 31.0 / 3, .phase = -0.1, .amplitude = 0.4};
  pattern.multishot = Multishot{{0, 2.0 / 3, 2.5, 4.1}, 7, 31.0 / 6, -0.5};
  write_pattern(folder / "p.yaml", pattern);
  const Pattern read = read_pattern(folder / "p.yaml");
  ASSERT_TRUE(read.multishot);
  EXPECT_EQ(read.multishot->shifts, pattern.multishot->shifts);
  EXPECT_EQ(read.multishot->code_bits, 7);
  EXPECT_EQ(read.multishot->code_cell, 31.0 / 6);
  EXPECT_EQ(read.multishot->code_start, -0.5);
  EXPECT_FALSE(read_pattern(demo_path("pattern.yaml")).multishot);

  const auto refused = [&](auto change) {
    Pattern wrong = pattern;
    change(wrong);
    EXPECT_THROW(check_pattern(wrong, "p"), InvalidInput);
  };
  refused([](Pattern& p) { p.multishot->shifts = {0, 1}; });
  refused([](Pattern& p) { p.multishot->shifts = {0, 0.1, 0.2}; });  // determine nothing
  refused([](Pattern& p) { p.multishot->shifts = {0, kNaN, 4}; });
  refused([](Pattern& p) { p.multishot->code_bits = 0; });
  refused([](Pattern& p) { p.multishot->code_cell = p.period; });
  refused([](Pattern& p) { p.multishot->code_cell = kNaN; });
  refused([](Pattern& p) { p.multishot->code_start = kInf; });
  Pattern striped = read_pattern(demo_path("pattern.yaml"));
  striped.multishot = pattern.multishot;
  EXPECT_THROW(check_pattern(striped, "p"), InvalidInput);
}

TEST(Pattern, SurvivesAFileExactly) {
  const ScratchFolder folder;
  Pattern pattern = read_pattern(demo_path("pattern.yaml"));
  pattern.axis = Axis::x;
  pattern.period = 31.0 / 3;
  pattern.phase = -0.1;
  pattern.colors[1].rgb = {1, 1.0 / 3, 0.1};
  pattern.colors[1].name = "H020";
  pattern.colors[2].name = "2 dark, \"green\": \\#";
  pattern.stripe_edges[3] = 131 + 1.0 / 7;
  const auto same = [](const Pattern& a, const Pattern& b) {
    bool equal = a.stripes == b.stripes && a.stripe_edges == b.stripe_edges && a.axis == b.axis &&
                 a.period == b.period && a.phase == b.phase && a.mean == b.mean &&
                 a.amplitude == b.amplitude && a.projector_size == b.projector_size &&
                 a.colors.size() == b.colors.size();
    for (std::size_t i = 0; equal && i < a.colors.size(); ++i)
      equal = a.colors[i].name == b.colors[i].name && a.colors[i].rgb == b.colors[i].rgb;
    return equal;
  };
  write_pattern(folder / "p.yaml", pattern);
  EXPECT_TRUE(same(read_pattern(folder / "p.yaml"), pattern));
  pattern.projector_size = Eigen::Vector2i(1024, 768);
  pattern.colors.clear();
  pattern.stripes.clear();
  pattern.stripe_edges.clear();
  write_pattern(folder / "p.yaml", pattern);
  EXPECT_TRUE(same(read_pattern(folder / "p.yaml"), pattern));
  pattern.colors = {{"G", {0, 1, 0}}};  // the pattern with which a colour is trained
  pattern.stripes = {0};
  write_pattern(folder / "p.yaml", pattern);
  EXPECT_TRUE(same(read_pattern(folder / "p.yaml"), pattern));
}

TEST(Pattern, FitsItsProjectorAlone) {
  Pattern pattern = read_pattern(demo_path("pattern.yaml"));
  const geometry::Camera wide{.width = 1024, .height = 768};
  EXPECT_NO_THROW(check_pattern_fits(pattern, wide, "p"));
  // Of stripes across x the last edge lies at 990.5.
  EXPECT_THROW(check_pattern_fits(pattern, {.width = 991, .height = 768}, "p"), InvalidInput);
  EXPECT_NO_THROW(check_pattern_fits(pattern, {.width = 992, .height = 1}, "p"));
  pattern.projector_size = Eigen::Vector2i(1024, 768);
  EXPECT_NO_THROW(check_pattern_fits(pattern, wide, "p"));
  EXPECT_THROW(check_pattern_fits(pattern, {.width = 1280, .height = 768}, "p"), InvalidInput);
}

TEST(Pattern, IsNotWrittenIfItIsWrong) {
  const ScratchFolder folder;
  EXPECT_THROW(write_pattern(folder / "p.yaml", {.period = 0}), InvalidInput);
  Pattern colorful = make_pattern(Axis::y, 10, 1024);
  for (std::size_t i = colorful.colors.size(); i <= kMostPatternColors; ++i) {
    colorful.colors.push_back({"color " + std::to_string(i), {1, 0.5, 0}});
  }
  const std::string message =
      message_of<InvalidInput>([&] { write_pattern(folder / "p.yaml", colorful); });
  EXPECT_NE(message.find("colors: there are 64; at most 63 are possible"), std::string::npos)
      << message;
  EXPECT_FALSE(std::filesystem::exists(folder / "p.yaml"));
}

TEST(Pattern, RefusesWrongFilesAndNamesTheKey) {
  const ScratchFolder folder;
  const std::string text = read_text(demo_path("pattern.yaml"));
  const auto refusal_of = [&](const std::string& from, const std::string& to) {
    const auto path = written(folder, "bad_pattern.yaml", replaced(text, from, to));
    std::string message = message_of<FileError>([&] { (void)read_pattern(path); });
    EXPECT_THAT(message, HasSubstr("bad_pattern.yaml"));
    return message;
  };
  EXPECT_THAT(refusal_of("period_px: 10.0", "period_px: 0.0"), HasSubstr("period_px"));
  EXPECT_THAT(refusal_of("period_px: 10.0", "period_px: -10.0"), HasSubstr("period_px"));
  EXPECT_THAT(refusal_of("period_px: 10.0", "period_px: .Inf"), HasSubstr("period_px"));
  EXPECT_THAT(refusal_of("period_px: 10.0", "period_px: ten"), HasSubstr("period_px"));
  EXPECT_THAT(refusal_of("axis: y", "axis: z"), HasSubstr("axis"));
  EXPECT_THAT(refusal_of("amplitude: 0.425", "amplitude: 0.525"), HasSubstr("amplitude"));
  EXPECT_THAT(refusal_of("phase", "phaze"), HasSubstr("phase"));
  EXPECT_THAT(refusal_of("stripes: [ 0, 5", "stripes: [ 0, 6"), HasSubstr("stripes[1]"));
  EXPECT_THAT(refusal_of("stripes: [ 0, 5", "stripes: [ 5, 5"), HasSubstr("stripes[1]"));
  EXPECT_THAT(refusal_of("stripes: [ 0, 5, 4, 0, 4", "stripes: [ 0, 5, 0, 5, 4"),
              HasSubstr("stripes[3]"));
  EXPECT_THAT(refusal_of("stripes: [ 0, 5", "stripes: [ 0.5, 5"), HasSubstr("stripes[0]"));
  EXPECT_THAT(refusal_of("[ 32.5, 65.5", "[ 65.5, 32.5"), HasSubstr("stripe_edges_px[1]"));
  EXPECT_THAT(refusal_of("[ 32.5, ", "[ "), HasSubstr("stripe_edges_px"));
  EXPECT_THAT(refusal_of("name: Y", "name: R"), HasSubstr("colors[1]"));
  EXPECT_THAT(refusal_of("rgb: [ 1, 1, 0 ]", "rgb: [ 1, 1, 1 ]"), HasSubstr("colors[1]"));
  EXPECT_THAT(refusal_of("rgb: [ 1, 1, 0 ]", "rgb: [ 1, 1 ]"), HasSubstr("colors[1].rgb"));
  EXPECT_THAT(refusal_of("stripes: [", "stripez: ["), HasSubstr("colors but no stripes"));
}

TEST(Pattern, RefusesMissingAndForeignFiles) {
  const ScratchFolder folder;
  EXPECT_THROW((void)read_pattern(folder / "none.yaml"), FileError);
  EXPECT_THROW((void)read_pattern(written(folder, "empty.yaml", "")), FileError);
  EXPECT_THROW((void)read_pattern(demo_path("rig.yaml")), FileError);
}

}  // namespace
}  // namespace palpate::sensing
