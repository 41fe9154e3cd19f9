// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Frames that do not fit their rig, pattern or colours, and frames that do.
#include "palpate/sensing/decode_verdict.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/decode.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// All inputs of a decoder.
struct Inputs {
  Rig rig = make_rig(false);
  Pattern pattern = make_pattern(Axis::y, 20, 1024);
  TrainedColors colors = ideal_colors();
  cv::Mat frame;
};

/// A sphere in front of a tilted wall.
Surface usual_surface() { return nearer(plane({0.1, 0.15, 1}, 740), sphere({20, 10, 700}, 60)); }

/// A small object off the centre, in the dark.
Surface small_surface() { return sphere({45, -30, 650}, 60); }

Inputs usual_inputs(const Surface& surface = usual_surface()) {
  Inputs inputs;
  inputs.frame = render(inputs.rig, inputs.pattern, surface).frame;
  add_noise(inputs.frame, 0.005, 1);
  return inputs;
}

DecodeEvidence evidence_of(const Inputs& inputs, const DecodeOptions& options = {}) {
  return Decoder(inputs.rig, inputs.pattern, inputs.colors, options).decode(inputs.frame).evidence;
}

DecodeJudgement judgement_of(const Inputs& inputs, const DecodeOptions& options = {}) {
  return judge(evidence_of(inputs, options));
}

void swap_channels(cv::Mat& frame, int a, int b) {
  std::vector<cv::Mat> channels;
  cv::split(frame, channels);
  std::swap(channels[static_cast<std::size_t>(a)], channels[static_cast<std::size_t>(b)]);
  cv::merge(channels, frame);
}

/// Takes row `from(row)` for each row.
void take_rows(cv::Mat& frame, const std::function<int(int)>& from) {
  const cv::Mat before = frame.clone();
  for (int row = 0; row < frame.rows; ++row) before.row(from(row)).copyTo(frame.row(row));
}

/// Shifts the rows from `first` on to the right, as if data were lost in transfer.
void tear(cv::Mat& frame, int first, int columns) {
  const cv::Mat before = frame.clone();
  const cv::Range rows(first, frame.rows);
  const int kept = frame.cols - columns;
  before(rows, {0, kept}).copyTo(frame(rows, {columns, frame.cols}));
  before(rows, {kept, frame.cols}).copyTo(frame(rows, {0, columns}));
}

/// Multiplies red, green, blue.
void paint(cv::Mat& frame, const Eigen::Vector3d& reflectance) {
  cv::multiply(frame, cv::Scalar(reflectance.z(), reflectance.y(), reflectance.x()), frame);
}

struct Fault {
  const char* name;
  std::function<void(Inputs&)> apply;
  DecodeVerdict verdict;
  const char* words;  ///< in the reason
};

class DecodeVerdictOfFaults : public ::testing::TestWithParam<Fault> {};

TEST_P(DecodeVerdictOfFaults, IsTheirLikelyCause) {
  for (const bool small : {false, true}) {
    Inputs inputs = usual_inputs(small ? small_surface() : usual_surface());
    GetParam().apply(inputs);
    const DecodeJudgement judgement = judgement_of(inputs);
    EXPECT_FALSE(judgement.usable());
    // On a small object, a shift that varies over the frame is about the same everywhere.
    if (small && judgement.verdict == DecodeVerdict::shifted_sinusoid) continue;
    EXPECT_STREQ(to_string(judgement.verdict), to_string(GetParam().verdict)) << judgement.reason;
    EXPECT_NE(judgement.reason.find(GetParam().words), std::string::npos) << judgement.reason;
  }
}

const Fault kFaults[] = {
    {"RedAndBlueSwapped", [](Inputs& in) { swap_channels(in.frame, 0, 2); },
     DecodeVerdict::wrong_channels, "red and blue are swapped in the frames"},
    {"GreenAndBlueSwapped", [](Inputs& in) { swap_channels(in.frame, 0, 1); },
     DecodeVerdict::wrong_channels, "green and blue are swapped in the frames"},
    {"TrainedRedAndBlueSwapped",
     [](Inputs& in) {
       for (TrainedColor& color : in.colors.colors) {
         color.mean = std::fmod(10 * std::numbers::pi / 3 - color.mean, 2 * std::numbers::pi);
       }
     },
     DecodeVerdict::wrong_channels, "red and blue are swapped in the trained colours"},
    {"Negative", [](Inputs& in) { cv::bitwise_not(in.frame, in.frame); },
     DecodeVerdict::wrong_channels, "negatives"},
    {"TrainedHues30DegreesOff",
     [](Inputs& in) {
       for (TrainedColor& color : in.colors.colors) color.mean += std::numbers::pi / 6;
     },
     DecodeVerdict::wrong_colors, "train them again"},
    {"Mirrored", [](Inputs& in) { cv::flip(in.frame, in.frame, 1); }, DecodeVerdict::turned_frames,
     "mirrored"},
    {"Flipped", [](Inputs& in) { cv::flip(in.frame, in.frame, 0); }, DecodeVerdict::turned_frames,
     "flipped"},
    {"Rotated", [](Inputs& in) { cv::flip(in.frame, in.frame, -1); }, DecodeVerdict::turned_frames,
     "rotated by 180 degrees"},
    {"FieldsSwapped", [](Inputs& in) { take_rows(in.frame, [](int row) { return row ^ 1; }); },
     DecodeVerdict::wrong_rows, "interlaced"},
    {"RowsDoubled", [](Inputs& in) { take_rows(in.frame, [](int row) { return row & ~1; }); },
     DecodeVerdict::wrong_rows, "doubled"},
    {"StripesReversed",
     [](Inputs& in) { std::reverse(in.pattern.stripes.begin(), in.pattern.stripes.end()); },
     DecodeVerdict::reversed_stripes, "reverse order"},
    {"OtherStripes",
     [](Inputs& in) {
       constexpr int kOther[] = {1, 0, 4, 3, 2, 5};
       for (int& stripe : in.pattern.stripes) stripe = kOther[stripe];
     },
     DecodeVerdict::wrong_pattern, "nothing to do with each other"},
    {"PhaseOff", [](Inputs& in) { in.pattern.phase += std::numbers::pi / 2; },
     DecodeVerdict::shifted_sinusoid, "0.25 of a period"},
    {"PeriodOff", [](Inputs& in) { in.pattern.period *= 1.03; }, DecodeVerdict::wrong_rig,
     "period"},
    {"ProjectorFocalLengthOff",
     [](Inputs& in) {
       in.rig.projector.fx *= 1.02;
       in.rig.projector.fy *= 1.02;
     },
     DecodeVerdict::wrong_rig, "rig seems to be another"},
    {"CameraFocalLengthOff",
     [](Inputs& in) {
       in.rig.camera.fx *= 1.02;
       in.rig.camera.fy *= 1.02;
     },
     DecodeVerdict::wrong_rig, "rig seems to be another"},
    {"PrincipalPointOff", [](Inputs& in) { in.rig.projector.cy += 9; },
     DecodeVerdict::shifted_sinusoid, "principal point"},
};
INSTANTIATE_TEST_SUITE_P(All, DecodeVerdictOfFaults, ::testing::ValuesIn(kFaults),
                         [](const auto& test) { return test.param.name; });

TEST(DecodeVerdict, NamesTheRowsOfATornFrame) {
  for (const Axis axis : {Axis::x, Axis::y}) {
    for (const int columns : {3, 10}) {
      Inputs inputs{.pattern = make_pattern(axis, 20, axis == Axis::x ? 768 : 1024), .frame = {}};
      inputs.frame = render(inputs.rig, inputs.pattern, usual_surface()).frame;
      add_noise(inputs.frame, 0.005, 1);
      tear(inputs.frame, 160, columns);
      const DecodeJudgement judgement = judgement_of(inputs);
      EXPECT_EQ(judgement.verdict, DecodeVerdict::torn_frames)
          << (axis == Axis::x ? 'x' : 'y') << columns << ' ' << judgement.reason;
      EXPECT_NE(judgement.reason.find("rows 160 to 239"), std::string::npos) << judgement.reason;
    }
  }
}

// 20 px are three periods: stripes and sinusoid agree on both sides, as at a step of depth.
TEST(DecodeVerdict, CannotNoticeATearByWholePeriods) {
  Inputs inputs;
  inputs.rig.T_projector_camera.translation().z() = 0;
  inputs.frame = render(inputs.rig, inputs.pattern, plane({0, 0, 1}, 740)).frame;
  tear(inputs.frame, 160, 20);
  EXPECT_EQ(judgement_of(inputs).verdict, DecodeVerdict::accepted);
}

/// A rig in which a baseline 10 mm off along x shifts the sinusoid by a period at this depth.
Inputs rig_with_whole_period_at(double z) {
  Inputs inputs;
  inputs.rig.T_projector_camera.translation().z() = 0;
  const Eigen::Vector3d& t = inputs.rig.T_projector_camera.translation();
  inputs.pattern.period = inputs.rig.projector.fy * t.y() / z * 10 / (t.x() + 10);
  return inputs;
}

DecodeEvidence seen(Inputs inputs, const Surface& surface, double baseline_off) {
  inputs.frame = render(inputs.rig, inputs.pattern, surface).frame;
  add_noise(inputs.frame, 0.005, 1);
  inputs.rig.T_projector_camera.translation().x() += baseline_off;
  return evidence_of(inputs);
}

// At most places the shift is close to a whole period, but it depends on the depth.
TEST(DecodeVerdict, TellsAWrongBaselineFromHowTheShiftDependsOnTheDepth) {
  const Inputs inputs = rig_with_whole_period_at(825);
  const Surface slope = plane({0.25, 0, 1}, 825);
  EXPECT_EQ(judge(seen(inputs, slope, 0)).verdict, DecodeVerdict::accepted);
  const DecodeJudgement judgement = judge(seen(inputs, slope, 10));
  EXPECT_EQ(judgement.verdict, DecodeVerdict::wrong_rig) << judgement.reason;
  EXPECT_NE(judgement.reason.find("baseline"), std::string::npos) << judgement.reason;
}

TEST(DecodeVerdict, TellsAWrongBaselineFromASequenceOfFramesThatFitOneByOne) {
  const Inputs inputs = rig_with_whole_period_at(825);
  DecodeEvidence right, wrong;
  for (const double z : {790, 825, 862}) {
    right += seen(inputs, plane({0, 0, 1}, z), 0);
    const DecodeEvidence one = seen(inputs, plane({0, 0, 1}, z), 10);
    EXPECT_EQ(judge(one).verdict, DecodeVerdict::accepted) << z << judge(one).reason;
    wrong += one;
  }
  EXPECT_EQ(judge(right).verdict, DecodeVerdict::accepted) << judge(right).reason;
  EXPECT_EQ(judge(wrong).verdict, DecodeVerdict::wrong_rig) << judge(wrong).reason;
}

TEST(DecodeVerdict, AcceptsFramesThatFit) {
  for (const bool verging : {false, true}) {
    for (const Axis axis : {Axis::x, Axis::y}) {
      Inputs inputs{.rig = make_rig(verging),
                    .pattern = make_pattern(axis, 20, axis == Axis::x ? 768 : 1024),
                    .frame = {}};
      inputs.frame = render(inputs.rig, inputs.pattern, usual_surface()).frame;
      for (const double noise : {0.0, 0.02}) {
        add_noise(inputs.frame, noise, 2);
        const DecodeJudgement judgement = judgement_of(inputs);
        EXPECT_EQ(judgement.verdict, DecodeVerdict::accepted)
            << verging << ' ' << (axis == Axis::x ? 'x' : 'y') << ' ' << judgement.reason;
      }
    }
  }
}

TEST(DecodeVerdict, AcceptsFramesThatFitHoweverTheyAreDecoded) {
  const Inputs inputs = usual_inputs();
  for (const DecodeOptions& options :
       {DecodeOptions{.half_resolution = true}, DecodeOptions{.window_periods = 4},
        DecodeOptions{.segmentation = Segmentation::snakes}}) {
    const DecodeJudgement judgement = judgement_of(inputs, options);
    EXPECT_EQ(judgement.verdict, DecodeVerdict::accepted) << judgement.reason;
  }
}

// A period of four pixels shows the same at every other row.
TEST(DecodeVerdict, TakesAPeriodOfFourPixelsNotForInterlacedRows) {
  Inputs inputs{.pattern = make_pattern(Axis::y, 4 * 1500.0 / 550, 1024), .frame = {}};
  inputs.rig.T_projector_camera.translation().z() = 0;
  inputs.frame = render(inputs.rig, inputs.pattern, plane({0, 0, 1}, 720)).frame;
  const DecodeEvidence evidence = evidence_of(inputs);
  EXPECT_EQ(judge(evidence).verdict, DecodeVerdict::accepted) << judge(evidence).reason;
}

// The stripes alone, which lie along the rows, show it then.
TEST(DecodeVerdict, TellsSwappedFieldsUnderASinusoidAlongTheRows) {
  for (const bool verging : {false, true}) {
    Inputs inputs{.rig = make_rig(verging), .pattern = make_pattern(Axis::x, 20, 768), .frame = {}};
    inputs.frame = render(inputs.rig, inputs.pattern, usual_surface()).frame;
    cv::GaussianBlur(inputs.frame, inputs.frame, {0, 0}, 0.6);  // a lens
    for (const double noise : {0.0, 0.01}) {
      add_noise(inputs.frame, noise, 4);
      EXPECT_EQ(judgement_of(inputs).verdict, DecodeVerdict::accepted);
      Inputs swapped = inputs;
      swapped.frame = inputs.frame.clone();
      take_rows(swapped.frame, [](int row) { return row ^ 1; });
      EXPECT_EQ(judgement_of(swapped).verdict, DecodeVerdict::wrong_rows)
          << judgement_of(swapped).reason;
    }
  }
}

TEST(DecodeVerdict, TellsASinusoidAlongTheOtherAxisFromOneThatIsOutOfFocus) {
  Inputs inputs = usual_inputs();
  inputs.frame = render(make_rig(true), inputs.pattern, usual_surface()).frame;
  inputs.rig = make_rig(true);
  Inputs turned = inputs;
  turned.pattern = make_pattern(Axis::x, 20, 768);
  const DecodeJudgement judgement = judgement_of(turned);
  EXPECT_EQ(judgement.verdict, DecodeVerdict::wrong_pattern) << judgement.reason;
  EXPECT_NE(judgement.reason.find("other axis"), std::string::npos) << judgement.reason;
  cv::GaussianBlur(inputs.frame, inputs.frame, {0, 0}, 5);
  EXPECT_EQ(judgement_of(inputs).verdict, DecodeVerdict::too_little) << judgement_of(inputs).reason;
}

TEST(DecodeVerdict, RefusesNothingThatIsTooLittleToJudgeBy) {
  const auto expect_too_little = [](const Inputs& inputs, const char* what) {
    const DecodeJudgement judgement = judgement_of(inputs);
    EXPECT_EQ(judgement.verdict, DecodeVerdict::too_little) << what << ": " << judgement.reason;
    EXPECT_TRUE(judgement.usable());
  };
  Inputs inputs = usual_inputs();
  const cv::Mat usual = inputs.frame.clone();
  inputs.frame.setTo(0);
  expect_too_little(inputs, "dark");
  usual(cv::Rect(140, 100, 24, 24)).copyTo(inputs.frame(cv::Rect(140, 100, 24, 24)));
  expect_too_little(inputs, "a small object");
  for (const Eigen::Vector3d& paint_of :
       {Eigen::Vector3d(1, 0.05, 0.05), Eigen::Vector3d(1, 0.2, 0.2),
        Eigen::Vector3d(0.1, 1, 0.1)}) {
    usual.copyTo(inputs.frame);
    paint(inputs.frame, paint_of);
    expect_too_little(inputs, "a coloured surface");
  }
}

TEST(DecodeVerdict, HasNothingToSayOfAPatternWithoutStripes) {
  Inputs inputs;
  inputs.pattern.colors.clear();
  inputs.pattern.stripes.clear();
  inputs.pattern.stripe_edges.clear();
  inputs.frame = render(inputs.rig, inputs.pattern, usual_surface()).frame;
  const DecodeJudgement judgement =
      judgement_of(inputs, {.anchors = {Anchor{.u_px = 160, .v_px = 120, .z = 640}}});
  EXPECT_EQ(judgement.verdict, DecodeVerdict::too_little);
}

TEST(DecodeVerdict, JudgesASequenceByTheSumOfItsFrames) {
  const Inputs right = usual_inputs();
  Inputs wrong = right;
  wrong.frame = right.frame.clone();
  cv::flip(wrong.frame, wrong.frame, 0);
  DecodeEvidence all;
  for (int i = 0; i < 4; ++i) all += evidence_of(right);
  EXPECT_EQ(judge(all).verdict, DecodeVerdict::accepted);
  all += evidence_of(wrong);
  EXPECT_EQ(judge(all).verdict, DecodeVerdict::accepted) << judge(all).reason;
  DecodeEvidence most_wrong = evidence_of(right);
  for (int i = 0; i < 4; ++i) most_wrong += evidence_of(wrong);
  EXPECT_EQ(judge(most_wrong).verdict, DecodeVerdict::turned_frames);
}

// Two views of unknown scale: stripes and sinusoid agree for any length of the baseline.
TEST(DecodeVerdict, CannotNoticeABaselineThatIsTooLongAsAWhole) {
  Inputs inputs = usual_inputs();
  const double agreement = evidence_of(inputs).agreement;
  inputs.rig.T_projector_camera.translation() *= 1.06;
  EXPECT_NEAR(evidence_of(inputs).agreement, agreement, 0.01 * agreement);
}

}  // namespace
}  // namespace palpate::sensing
