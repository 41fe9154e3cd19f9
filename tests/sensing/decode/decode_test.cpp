// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "image/image_plane.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

struct Quality {
  double median_error = 1;  ///< relative to the depth
  double coverage = 0;      ///< reconstructed share of the pixels that can be
  double wrong =
      1;  ///< share of the reconstructed pixels off by more than kWrong or where nothing is
};

/// [mm]
constexpr float kWrong = 5;

/// \param possible pixels that are lit and visible.
Quality assess(const geometry::ImageF& z, const geometry::ImageF& truth, const Mask& possible) {
  std::vector<float> errors;
  long reconstructed = 0;
  long covered = 0;
  long wrong = 0;
  for (long i = 0; i < z.size(); ++i) {
    if (!(z.data()[i] > 0)) continue;
    ++reconstructed;
    covered += possible.data()[i];
    const float error = std::abs(z.data()[i] - truth.data()[i]);
    if (!(error <= kWrong)) ++wrong;
    if (error >= 0) errors.push_back(error / truth.data()[i]);
  }
  if (errors.empty()) return {};
  std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2),
                   errors.end());
  return {static_cast<double>(errors[errors.size() / 2]),
          static_cast<double>(covered) / static_cast<double>((possible != 0).count()),
          static_cast<double>(wrong) / static_cast<double>(reconstructed)};
}

void expect_within_targets(const Quality& quality, const std::string& name) {
  EXPECT_LE(quality.median_error, 0.001) << name;
  EXPECT_GE(quality.coverage, 0.9) << name;
  EXPECT_LE(quality.wrong, 0.01) << name;
}

Mask everything(const Rig& rig) { return Mask::Ones(rig.camera.height, rig.camera.width); }

/// Largest relative error allowed at the median of noise-free frames without blur: point-sampled
/// stripes and the mirror frequency, about 0.01 rad.
constexpr double kCleanError = 1e-4;

TEST(Decoder, MeasuresATiltedPlane) {
  for (const bool verging : {false, true}) {
    const Rig rig = make_rig(verging);
    const Pattern pattern = make_pattern(Axis::y, 20, 1024);
    const Scene scene =
        render(rig, pattern, plane(Eigen::Vector3d(0.2, -0.1, 1).normalized(), 680));
    const DecodeResult result = Decoder(rig, pattern, ideal_colors()).decode(scene.frame);
    const Quality quality = assess(result.range.z, scene.z, everything(rig));
    EXPECT_LE(quality.median_error, kCleanError) << verging;
    EXPECT_GE(quality.coverage, 0.9) << verging;
    EXPECT_EQ(quality.wrong, 0) << verging;
    EXPECT_EQ(result.range.camera.fx, rig.camera.fx);
  }
}

TEST(Decoder, MeasuresWithTheSinusoidAlongXAndStripesAlongY) {
  const Rig rig = make_rig(true);
  const Pattern pattern = make_pattern(Axis::x, 20, 768);
  const Scene scene = render(rig, pattern, plane(Eigen::Vector3d(0.1, 0.2, 1).normalized(), 720));
  const DecodeResult result = Decoder(rig, pattern, ideal_colors()).decode(scene.frame);
  const Quality quality = assess(result.range.z, scene.z, everything(rig));
  EXPECT_LE(quality.median_error, kCleanError);
  EXPECT_GE(quality.coverage, 0.85);  // stripes of 25 px are 9 camera pixels
  EXPECT_EQ(quality.wrong, 0);
}

TEST(Decoder, AllowsForTheDistortionOfBothLenses) {
  Rig rig = make_rig(true);
  rig.camera.distortion = {-0.15, 0.08, 1e-3, -5e-4, 0, 0, 0, 0};
  rig.projector.distortion = {0.1, -0.05, -1e-3, 2e-3, 0, 0, 0, 0};
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const Scene scene = render(rig, pattern, plane(Eigen::Vector3d(0, 0.1, 1).normalized(), 700));
  const Quality quality = assess(Decoder(rig, pattern, ideal_colors()).decode(scene.frame).range.z,
                                 scene.z, everything(rig));
  EXPECT_LE(quality.median_error, kCleanError);
  EXPECT_GE(quality.coverage, 0.9);
  EXPECT_LE(quality.wrong, 0.001);
}

TEST(Decoder, CompensatesChromaticShifts) {
  Rig rig = make_rig(true);
  rig.red = {.alpha = 0.997, .beta = 1.002, .gamma = 5e-4};
  rig.blue = {.alpha = 1.003, .beta = 0.998, .gamma = -4e-4};
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const Scene scene = render(rig, pattern, plane(Eigen::Vector3d(0.1, 0.1, 1).normalized(), 600));
  const auto error = [&](const Rig& assumed) {
    return assess(Decoder(assumed, pattern, ideal_colors()).decode(scene.frame).range.z, scene.z,
                  everything(rig))
        .median_error;
  };
  Rig uncompensated = rig;
  uncompensated.red = uncompensated.blue = {};
  EXPECT_LE(error(rig), kCleanError);
  EXPECT_GT(error(uncompensated), 3 * error(rig));
}

TEST(Decoder, KeepsAnObjectApartFromTheWallBehindIt) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const Scene scene = render(rig, pattern, nearer(sphere({0, 0, 600}, 70), plane({0, 0, 1}, 720)));
  const DecodeResult result = Decoder(rig, pattern, ideal_colors()).decode(scene.frame);
  // The sphere's shadow is not rendered, and the part that it hides from the projector is wrong in
  // the frame.
  const Quality quality = assess(result.range.z, scene.z, everything(rig));
  EXPECT_LE(quality.median_error, kCleanError);
  EXPECT_LE(quality.wrong, 0.01);
  EXPECT_NEAR(result.range.z(120, 160), 530, 0.5);
}

TEST(Decoder, EveryPixelHasADepthOrAReason) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const Scene scene = render(rig, pattern, sphere({0, 0, 600}, 90));
  const DecodeResult result = Decoder(rig, pattern, ideal_colors()).decode(scene.frame);
  EXPECT_TRUE(((result.range.z > 0) == (result.reasons == 0)).all());
  EXPECT_LT(result.reasons.maxCoeff(), kReasonCount);
  EXPECT_GT(count(result.reasons, Reason::unlit), 320 * 240 / 4);
  EXPECT_GE(result.regions, 1);
  EXPECT_GT(result.transitions, 100);
  EXPECT_LT(result.unresolved_regions, result.regions);
}

TEST(Decoder, SnakesMeasureWhatTheFloodMeasures) {
  const Rig rig = make_rig(true);
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const Scene scene = render(rig, pattern, nearer(sphere({0, 0, 600}, 70), plane({0, 0, 1}, 720)));
  const DecodeResult flood = Decoder(rig, pattern, ideal_colors()).decode(scene.frame);
  const DecodeResult snakes =
      Decoder(rig, pattern, ideal_colors(), {.segmentation = Segmentation::snakes})
          .decode(scene.frame);
  const Quality quality = assess(snakes.range.z, scene.z, everything(rig));
  EXPECT_LE(quality.median_error, kCleanError);
  EXPECT_LE(quality.wrong, 0.01);
  EXPECT_GE(quality.coverage, assess(flood.range.z, scene.z, everything(rig)).coverage - 0.05);
}

TEST(Decoder, AnAnchorStandsInForStripes) {
  const Rig rig = make_rig(false);
  for (const Axis axis : {Axis::x, Axis::y}) {
    Pattern pattern{.axis = axis, .period = 20, .phase = -1.2, .mean = 0.5, .amplitude = 0.5};
    const Scene scene =
        render(rig, pattern, plane(Eigen::Vector3d(0.1, -0.2, 1).normalized(), 650), 0);
    cv::Mat grey;
    cv::extractChannel(scene.frame, grey, 1);
    const Anchor anchor{.u_px = 101.3, .v_px = 88.8, .z = static_cast<double>(scene.z(89, 101))};
    const Decoder decoder(rig, pattern, {}, {.anchors = {anchor}});
    for (const cv::Mat& frame : {grey, scene.frame}) {
      const Quality quality = assess(decoder.decode(frame).range.z, scene.z, everything(rig));
      EXPECT_LE(quality.median_error, kCleanError);
      EXPECT_GE(quality.coverage, 0.9);
      EXPECT_EQ(quality.wrong, 0);
    }
  }
}

TEST(Decoder, OnlyTheRegionOfTheAnchorIsReconstructed) {
  const Rig rig = make_rig(false);
  const Pattern pattern{.axis = Axis::y, .period = 20, .phase = 0, .mean = 0.5, .amplitude = 0.5};
  const Scene scene =
      render(rig, pattern, nearer(sphere({-100, 0, 600}, 40), sphere({100, 0, 700}, 60)), 0);
  const Anchor anchor{.u_px = 160 + 550 * 100.0 / 640, .v_px = 120, .z = 640};
  const DecodeResult result = Decoder(rig, pattern, {}, {.anchors = {anchor}}).decode(scene.frame);
  EXPECT_GT((result.range.z.rightCols(160) > 0).count(), 1000);
  EXPECT_EQ((result.range.z.leftCols(160) > 0).count(), 0);
  EXPECT_GT(
      (result.reasons.leftCols(160) == static_cast<std::uint8_t>(Reason::no_transition)).count(),
      1000);
}

TEST(Decoder, AnAnchorsOffsetIsNotCarriedOverDepthSteps) {
  const Rig rig = make_rig(false);
  const Pattern pattern{.axis = Axis::y, .period = 20, .phase = 0, .mean = 0.5, .amplitude = 0.4};
  for (const double distance : {500.0, 545.0, 590.0, 620.0}) {
    const Scene scene =
        render(rig, pattern, nearer(sphere({0, 0, distance}, 50), plane({0, 0, 1}, 720)));
    const Anchor on_wall{.u_px = 20, .v_px = 120, .z = static_cast<double>(scene.z(120, 20))};
    const Anchor on_ball{.u_px = 160, .v_px = 120, .z = static_cast<double>(scene.z(120, 160))};
    const auto decoded = [&](const std::vector<Anchor>& anchors) {
      return assess(Decoder(rig, pattern, {}, {.anchors = anchors}).decode(scene.frame).range.z,
                    scene.z, everything(rig));
    };
    const Quality both = decoded({on_wall, on_ball});
    EXPECT_GE(both.coverage, 0.75) << distance;
    EXPECT_LE(both.wrong, 0.005) << distance;
    const Quality wall = decoded({on_wall});
    const Quality ball = decoded({on_ball});
    EXPECT_LE(wall.wrong, 0.005) << distance;
    EXPECT_LE(ball.wrong, 0.02) << distance;
    EXPECT_GE(ball.coverage, 0.02) << distance;
    EXPECT_NEAR(wall.coverage + ball.coverage, both.coverage, 0.02) << distance;
  }
}

TEST(Decoder, ADarkWallThatWasReallyTakenIsDecodedFromAnAnchor) {
  const std::filesystem::path folder = repository("tests/sensing/captures/phase_shifting");
  const Anchor anchor{.u_px = 242, .v_px = 76, .z = 400};
  for (const Segmentation segmentation : {Segmentation::flood, Segmentation::snakes}) {
    const Decoder decoder(read_rig(folder / "wall_rig.yaml"), read_pattern(folder / "pattern.yaml"),
                          {}, {.segmentation = segmentation, .anchors = {anchor}});
    const DecodeResult result = decoder.decode(read_frame(folder / "wall.png"));
    EXPECT_TRUE(((result.range.z > 0) == (result.reasons == 0)).all());
  }
}

TEST(Decoder, ReachesItsTargetsOnTheBundledFrames) {
  const TrainedColors colors = train_colors_from_folder(demo_path("training"));
  const Pattern pattern = read_pattern(demo_path("pattern.yaml"));
  const Decoder decoder(read_rig(demo_path("rig.yaml")), pattern, colors);
  const Decoder verging(read_rig(demo_path("verging/rig.yaml")), pattern, colors);
  const auto check = [](const Decoder& with, const std::string& frame, const std::string& truth) {
    const geometry::ImageF z = geometry::read_depth_tiff(demo_path(truth + ".tiff"));
    const cv::Mat id = read_frame(demo_path(truth + "_id.png"));
    const cv::Mat lit = read_frame(demo_path(truth + "_lit.png"));
    Mask possible(z.rows(), z.cols());
    for (int v = 0; v < id.rows; ++v) {
      for (int u = 0; u < id.cols; ++u) {
        possible(v, u) = id.at<uchar>(v, u) > 0 && lit.at<uchar>(v, u) == 255 ? 1 : 0;
      }
    }
    const DecodeResult result = with.decode(read_frame(demo_path(frame)));
    expect_within_targets(assess(result.range.z, z, possible), frame);
  };
  for (const char* const name : {"duck", "plane", "flag_a", "flag_b"}) {
    check(decoder, std::string("frames/") + name + ".png", std::string("truth/") + name);
  }
  check(verging, "verging/frame.png", "verging/truth");
}

TEST(Decoder, AnObjectHasTheSameDepthsWhateverElseIsLit) {
  Rig rig = make_rig(true);
  rig.camera = {.width = 640, .height = 480, .fx = 1100, .fy = 1100, .cx = 319.5, .cy = 239.5};
  rig.red.alpha = 1.003;
  rig.blue.alpha = 0.997;
  rig.covariance = Eigen::MatrixXd::Identity(kRigParameters, kRigParameters) * 1e-8;
  const Surface ball = sphere({-40, 35, 620}, 45);
  for (const Axis axis : {Axis::x, Axis::y}) {
    const Pattern pattern = make_pattern(axis, 20, axis == Axis::x ? 768 : 1024);
    Scene alone = render(rig, pattern, ball);
    add_noise(alone.frame, 0.005, 1);
    // Lights without a sinusoid; with them, the decoder cannot leave out any part of the frame.
    cv::Mat lights = alone.frame.clone();
    const cv::Point corners[] = {{10, 10}, {rig.camera.width - 10, rig.camera.height - 10}};
    for (const cv::Point& corner : corners)
      cv::circle(lights, corner, 8, cv::Scalar(0, 0, 40000), cv::FILLED);
    for (const bool half : {false, true}) {
      const Decoder decoder(rig, pattern, ideal_colors(), {.half_resolution = half});
      const DecodeResult expected = decoder.decode(lights);
      const DecodeResult result = decoder.decode(alone.frame);
      const auto in_both = result.range.z.isFinite() && expected.range.z.isFinite();
      const auto in_one = result.range.z.isFinite() != expected.range.z.isFinite();
      EXPECT_GT(in_both.count(), half ? 2500 : 10000);
      EXPECT_LE(in_one.count(), in_both.count() / 50);
      // Estimates from samples of the frame decide how doubtful pixels are corrected.
      const auto change = (result.range.z - expected.range.z) / expected.noise;
      EXPECT_LE(
          std::sqrt(in_both.select(change.square(), 0).sum() / static_cast<float>(in_both.count())),
          0.2F);
      const auto ratio = result.noise / expected.noise;
      EXPECT_NEAR(in_both.select(ratio, 0).sum() / static_cast<float>(in_both.count()), 1, 0.15F);
    }
  }
}

TEST(Decoder, NothingOfAnEarlierFrameIsLeftInAResult) {
  const Rig rig = make_rig(true);
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const Decoder decoder(rig, pattern, ideal_colors());
  const Scene ball = render(rig, pattern, sphere({0, 0, 600}, 70));
  const Scene wall = render(rig, pattern, plane({0, 0.1, 1}, 700));
  DecodeResult reused = decoder.decode(wall.frame);
  const float* const memory = reused.range.z.data();
  decoder.decode(ball.frame, reused);
  const DecodeResult fresh = Decoder(rig, pattern, ideal_colors()).decode(ball.frame);
  EXPECT_TRUE((reused.reasons == fresh.reasons).all());
  EXPECT_TRUE((reused.range.z == fresh.range.z || fresh.range.z.isNaN()).all());
  EXPECT_TRUE((reused.range.z.isNaN() == fresh.range.z.isNaN()).all());
  EXPECT_EQ(reused.transitions, fresh.transitions);
  EXPECT_EQ(reused.regions, fresh.regions);
  // Result and decoder exchange their images: those of the first frame are used again.
  decoder.decode(ball.frame, reused);
  EXPECT_EQ(reused.range.z.data(), memory);
  EXPECT_THROW(decoder.decode(cv::Mat(3, 3, CV_8UC3), reused), InvalidInput);
  EXPECT_TRUE((reused.reasons == fresh.reasons).all());
}

TEST(Decoder, GivesTheSameDepthsInSeveralThreads) {
  const Decoder decoder(read_rig(demo_path("rig.yaml")), read_pattern(demo_path("pattern.yaml")),
                        train_colors_from_folder(demo_path("training")));
  const cv::Mat frame = read_frame(demo_path("frames/flag_a.png"));
  const DecodeResult alone = decoder.decode(frame);
  auto other = std::async(std::launch::async, [&] { return decoder.decode(frame); });
  const DecodeResult here = decoder.decode(frame);
  const DecodeResult there = other.get();
  const auto same = [&](const DecodeResult& result) {
    return ((result.range.z == alone.range.z) || (result.range.z.isNaN() && alone.range.z.isNaN()))
        .all();
  };
  EXPECT_TRUE(same(here));
  EXPECT_TRUE(same(there));
}

TEST(Decoder, AFrameWithoutLightIsAllUnknown) {
  const Rig rig = make_rig(false);
  const Decoder decoder(rig, make_pattern(Axis::y, 20, 1024), ideal_colors());
  for (const double grey : {0.0, 30.0, 255.0}) {
    const DecodeResult result = decoder.decode(cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(grey)));
    EXPECT_TRUE(result.range.z.isNaN().all());
    EXPECT_EQ(count(result.reasons, grey < 255 ? Reason::unlit : Reason::saturated), 320 * 240);
    EXPECT_EQ(result.regions, 0);
  }
}

TEST(Decoder, RefusesWrongFrames) {
  const Decoder decoder(make_rig(false), make_pattern(Axis::y, 20, 1024), ideal_colors());
  const std::string message =
      message_of<InvalidInput>([&] { (void)decoder.decode(cv::Mat(320, 240, CV_8UC3)); });
  EXPECT_NE(message.find("240 x 320"), std::string::npos) << message;
  EXPECT_NE(message.find("320 x 240"), std::string::npos) << message;
  EXPECT_THROW((void)decoder.decode(cv::Mat(240, 320, CV_8UC1)), InvalidInput);
  EXPECT_THROW((void)decoder.decode(cv::Mat(240, 320, CV_32FC3)), InvalidInput);
  EXPECT_THROW((void)decoder.decode(cv::Mat()), InvalidInput);
}

TEST(Decoder, RefusesPatternsItCannotUse) {
  const Rig rig = make_rig(false);
  const Pattern striped = make_pattern(Axis::y, 20, 1024);
  const Pattern plain{.axis = Axis::y, .period = 20};
  EXPECT_THROW(Decoder(rig, striped, {}), InvalidInput);
  EXPECT_NE(message_of<InvalidInput>([&] { Decoder(rig, plain, {}); }).find("anchor"),
            std::string::npos);
  EXPECT_NE(message_of<InvalidInput>([&] {
              Decoder(rig, striped, ideal_colors(), {.anchors = {Anchor{100, 100, 700}}});
            }).find("leave them out"),
            std::string::npos);
  EXPECT_THROW(Decoder(rig, plain, {}, {.anchors = {Anchor{400, 100, 700}}}), InvalidInput);
  EXPECT_THROW(Decoder(rig, plain, {}, {.anchors = {Anchor{100, 100, -700}}}), InvalidInput);
  EXPECT_THROW(Decoder(rig, plain, {}, {.anchors = {Anchor{100, std::nan(""), 700}}}),
               InvalidInput);
}

TEST(Decoder, RefusesOptionsOutsideTheirRange) {
  const auto refusal_of = [](const DecodeOptions& options) {
    return message_of<InvalidInput>([&] {
      Decoder(make_rig(false), make_pattern(Axis::y, 20, 1024), ideal_colors(), options);
    });
  };
  EXPECT_EQ(refusal_of({}), "");
  for (const double bad : {std::nan(""), -0.1, 0.0, kInf}) {
    EXPECT_THAT(refusal_of({.window_periods = bad}), HasSubstr("window_periods"));
    EXPECT_THAT(refusal_of({.min_signal = bad}), HasSubstr("min_signal"));
    EXPECT_THAT(refusal_of({.min_modulation = bad}), HasSubstr("min_modulation"));
    EXPECT_THAT(refusal_of({.max_phase_sigma = bad}), HasSubstr("max_phase_sigma"));
    EXPECT_THAT(refusal_of({.min_hue_step = bad}), HasSubstr("min_hue_step"));
    EXPECT_THAT(refusal_of({.min_color_score = bad}), HasSubstr("min_color_score"));
    EXPECT_THAT(refusal_of({.max_phase_variance = bad}), HasSubstr("max_phase_variance"));
    EXPECT_THAT(refusal_of({.max_phase_step = bad}), HasSubstr("max_phase_step"));
    EXPECT_THAT(refusal_of({.min_agreement = bad}), HasSubstr("min_agreement"));
    EXPECT_THAT(refusal_of({.max_sensitivity = bad}), HasSubstr("max_sensitivity"));
  }
  EXPECT_THAT(refusal_of({.color_window_px = 0}), HasSubstr("color_window_px"));
  EXPECT_THAT(refusal_of({.max_phase_step = 3.2}), HasSubstr("max_phase_step"));
  EXPECT_THAT(refusal_of({.min_agreement = 0.5}), HasSubstr("min_agreement"));
}

}  // namespace
}  // namespace palpate::sensing
