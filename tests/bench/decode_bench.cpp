// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Decoding of one frame, whole and stage by stage, each beside what OpenCV has for that job: six
// separable low-pass filters (the least that any demodulation does), its unwrapping of phases, its
// conversion to HSV, its disparities to points, box sums and an erosion.
#include "palpate/sensing/decode.h"

#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/phase_unwrapping.hpp>

#include "decode/plausibility.h"
#include "decode/workspace.h"
#include "image/hue.h"
#include "paired.h"
#include "palpate/sensing/frame.h"
#include "phase/modulation.h"
#include "phase/wrapped_phase.h"
#include "repository.h"

namespace {

namespace sensing = palpate::sensing;
using sensing::Plane;
using sensing::Workspace;

/// The decoder's stages with its default options, on a bundled frame.
struct Stages {
  Stages() {
    cv::setNumThreads(1);
    demodulate();
    unwrap();
    find_depths();
  }

  void demodulate() {
    sensing::split_frame(frame, model.carrier().transposed, work.channels);
    sensing::find_lit(
        work.channels,
        {.colored = true, .radius = (filter.radius + 1) / 2, .min_signal = options.min_signal},
        work.lit);
    sensing::demodulate(work.channels, work.lit, filter, work.demodulated);
    sensing::combine_channels(work.demodulated.channels, model.chromatic(), work.combined);
  }
  void unwrap() {
    const sensing::FloodLimits limits{options.max_phase_variance, options.max_phase_step};
    sensing::find_modulated(work.combined, work.lit, options.min_modulation, work.modulated);
    sensing::find_wrapped_phase(work.combined.re, work.combined.im, work.wrapped);
    sensing::phase_variance(work.wrapped, work.modulated, work.variance);
    sensing::grow_regions(work.wrapped, work.variance, limits, work.unwrapping, work.regions);
  }
  void read_colors() {
    sensing::find_hues(work.demodulated.channels[1].mean, work.demodulated.channels[0].mean,
                       work.demodulated.channels[2].mean, work.hue);
    sensing::find_transitions(work.hue, work.lit, edges, classifier,
                              {.min_hue_step = options.min_hue_step,
                               .window_px = options.color_window_px,
                               .min_color_score = options.min_color_score},
                              work.transitions);
    model.phases_at_edges(work.transitions, work.guesses);
  }
  void find_depths() {
    work.reasons.setZero(model.rows(), model.columns());
    model.find_surfaces(work.regions.phase, work.combined.shares, options.max_sensitivity,
                        work.surfaces, work.reasons);
  }
  void judge() {
    sensing::erode(work.lit, 2, work.inner);
    sensing::find_breaks(work.regions.phase, 2, {filter.radius / 2, 2}, work.breaks);
    sensing::compare_colors(work.surfaces.stripe_pixel, work.hue, colors, classifier, work.says);
    for (const long nearby : {16L, 6L}) {
      sensing::find_contradictions(work.surfaces.stripe_pixel, work.says, options.min_agreement,
                                   nearby, work.contradicting);
    }
  }

  std::filesystem::path demo = palpate::repository("demo");
  cv::Mat frame = sensing::read_frame(demo / "frames/duck.png");
  sensing::TrainedColors trained = sensing::train_colors_from_folder(demo / "training");
  sensing::DecodeOptions options;
  sensing::DecoderGeometry model{sensing::read_rig(demo / "rig.yaml"),
                                 sensing::read_pattern(demo / "pattern.yaml")};
  sensing::Decoder decoder{model.rig(), model.pattern(), trained};
  sensing::DemodulationFilter filter = sensing::make_filter(model.carrier().along);
  sensing::HueClassifier classifier{model.pattern(), trained};
  sensing::StripeEdges edges{model.pattern()};
  sensing::StripeColors colors{model.pattern()};
  Workspace work;
};

/// An image of OpenCV's with the same values.
cv::Mat copy_of(const Plane& plane) {
  cv::Mat mat;
  cv::eigen2cv(plane.matrix().eval(), mat);
  return mat;
}

void low_pass_six_times(const cv::Mat& channel, cv::Mat& filtered) {
  constexpr int kKernelLength = 15;  // px, two periods of the pattern in the image
  const cv::Mat kernel = cv::getGaussianKernel(kKernelLength, kKernelLength / 6.0, CV_32F);
  for (int i = 0; i < 6; ++i) {  // real and imaginary, three channels
    cv::sepFilter2D(channel, filtered, CV_32F, kernel, kernel);
  }
  benchmark::DoNotOptimize(filtered.data);
}

void decode_against_opencv_low_pass(benchmark::State& state) {
  const Stages stages;
  const cv::Mat channel = copy_of(stages.work.channels[0]);
  sensing::DecodeResult result;
  cv::Mat filtered;
  palpate::bench::run_paired(
      state, [&] { stages.decoder.decode(stages.frame, result); },
      [&] { low_pass_six_times(channel, filtered); });
}
BENCHMARK(decode_against_opencv_low_pass)->Unit(benchmark::kMillisecond);

void demodulation_against_opencv_low_pass(benchmark::State& state) {
  Stages stages;
  const cv::Mat channel = copy_of(stages.work.channels[0]);
  cv::Mat filtered;
  palpate::bench::run_paired(
      state, [&] { stages.demodulate(); }, [&] { low_pass_six_times(channel, filtered); });
}
BENCHMARK(demodulation_against_opencv_low_pass)->Unit(benchmark::kMillisecond);

void unwrapping_against_opencv(benchmark::State& state) {
  Stages stages;
  const cv::Mat wrapped = copy_of(stages.work.wrapped);
  cv::phase_unwrapping::HistogramPhaseUnwrapping::Params size;
  size.width = wrapped.cols;
  size.height = wrapped.rows;
  const auto peer = cv::phase_unwrapping::HistogramPhaseUnwrapping::create(size);
  cv::Mat unwrapped;
  palpate::bench::run_paired(
      state, [&] { stages.unwrap(); }, [&] { peer->unwrapPhaseMap(wrapped, unwrapped); });
}
BENCHMARK(unwrapping_against_opencv)->Unit(benchmark::kMillisecond);

void colors_against_opencv_hsv(benchmark::State& state) {
  Stages stages;
  const auto& means = stages.work.demodulated.channels;
  cv::Mat bgr, hsv;
  cv::merge(
      std::vector<cv::Mat>{copy_of(means[2].mean), copy_of(means[0].mean), copy_of(means[1].mean)},
      bgr);
  palpate::bench::run_paired(
      state, [&] { stages.read_colors(); }, [&] { cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV); });
}
BENCHMARK(colors_against_opencv_hsv)->Unit(benchmark::kMillisecond);

void depths_against_opencv_reprojection(benchmark::State& state) {
  Stages stages;
  const cv::Mat disparity = copy_of(stages.work.regions.phase);
  const cv::Mat q =
      (cv::Mat_<double>(4, 4) << 1, 0, 0, -320, 0, 1, 0, -240, 0, 0, 0, 800, 0, 0, 1 / 150.0, 0);
  cv::Mat points;
  palpate::bench::run_paired(
      state, [&] { stages.find_depths(); }, [&] { cv::reprojectImageTo3D(disparity, points, q); });
}
BENCHMARK(depths_against_opencv_reprojection)->Unit(benchmark::kMillisecond);

void checks_against_opencv_box_filters(benchmark::State& state) {
  Stages stages;
  stages.read_colors();
  const cv::Mat mask(static_cast<int>(stages.model.rows()),
                     static_cast<int>(stages.model.columns()), CV_8U, stages.work.lit.data());
  const cv::Mat square = cv::Mat::ones(5, 5, CV_8U);
  cv::Mat sums, inner;
  palpate::bench::run_paired(
      state, [&] { stages.judge(); },
      [&] {
        cv::erode(mask, inner, square);
        for (int i = 0; i < 2; ++i) {  // how many are compared, how many agree
          cv::boxFilter(mask, sums, CV_32S, cv::Size(33, 33), {-1, -1}, false, cv::BORDER_CONSTANT);
        }
      });
}
BENCHMARK(checks_against_opencv_box_filters)->Unit(benchmark::kMillisecond);

}  // namespace
