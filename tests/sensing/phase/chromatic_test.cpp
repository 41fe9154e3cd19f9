// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/chromatic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

TEST(Chromatic, LagAgreesWithTheErratumOfEquation3_16) {
  const Rig rig = make_rig(false);
  Pattern pattern = make_pattern(Axis::y, 10, 1024);
  pattern.phase = 0;
  geometry::Camera projector = rig.projector;
  projector.cy = 0;  // the thesis counts the phase from the optical axis
  const ChromaticShift red{.alpha = 0.998, .beta = 1.003, .gamma = 4e-4};
  const double omega = 2 * std::numbers::pi * projector.fy / pattern.period;
  const double y_red = 0.0713;
  const double y_panel = 0.21;
  const double theta_red = omega * (y_red - y_panel);
  // theta(alpha y_r) = beta theta_r(y_r) + omega ((alpha - beta) y_r - gamma)
  const double theta = red.beta * theta_red + omega * ((red.alpha - red.beta) * y_red - red.gamma);
  const double phase_green = omega * red.alpha * y_red - theta;
  const double pixel = projector.fy * (red.beta * y_panel + red.gamma);
  EXPECT_NEAR(omega * y_panel + chromatic_lag(red, projector, pattern).at(pixel), phase_green,
              1e-9);
}

TEST(Chromatic, NoShiftMeansNoLagAndNoResampling) {
  const Rig rig = make_rig(false);
  const ChromaticLag lag = chromatic_lag({}, rig.projector, make_pattern(Axis::y, 10, 1024));
  EXPECT_EQ(lag.slope, 0);
  EXPECT_EQ(lag.offset, 0);
  EXPECT_TRUE(channel_shift(rig.camera, 1, geometry::pixel_rays(rig.camera), {}).none());
}

TEST(Chromatic, ResamplingBringsARescaledChannelBack) {
  const geometry::Camera camera{
      .width = 30, .height = 80, .fx = 500, .fy = 500, .cx = 14.5, .cy = 39.5};
  const double alpha = 1.02;
  const double carrier = 0.86;
  const double phase = 0.3;
  // Green shows cos(carrier v + phase); the channel shows at c + (v - c) / alpha the same as green
  // at v.
  Demodulated channel{Plane(80, 30), Plane(80, 30), Plane::Zero(80, 30)};
  for (long row = 0; row < 80; ++row) {
    const double green_row = camera.cy + alpha * (static_cast<double>(row) - camera.cy);
    const double baseband = carrier * (green_row - static_cast<double>(row)) + phase;
    channel.re.row(row) = static_cast<float>(std::cos(baseband));
    channel.im.row(row) = static_cast<float>(std::sin(baseband));
  }
  for (const bool transposed : {false, true}) {
    geometry::Camera shown = camera;
    if (transposed) std::swap(shown.width, shown.height), std::swap(shown.cx, shown.cy);
    const Plane zero = Plane::Zero(80, 30);
    const ChannelModel model =
        channel_model(channel_shift(shown, alpha, geometry::pixel_rays(shown),
                                    {.transposed = transposed, .along = carrier}),
                      {}, zero);
    const Demodulated dark{zero, zero, zero};
    Combined moved;
    combine_channels({dark, channel, dark}, {zero, {model, model}}, moved);
    for (long row = 2; row < 78; ++row) {
      // Bilinear interpolation of a phase that turns by 0.017 rad a pixel.
      EXPECT_NEAR(std::atan2(moved.im(row, 15), moved.re(row, 15)), phase, 1e-4) << row;
    }
  }
}

TEST(Chromatic, APartIsCombinedAsInTheWholeImage) {
  geometry::Camera camera{
      .width = 130, .height = 120, .fx = 200, .fy = 200, .cx = 64.5, .cy = 59.5};
  camera.distortion = {-0.1, 0.02, 1e-3, -1e-3, 0, 0, 0, 0};
  const Plane pixel = Plane::Random(120, 130);
  std::vector<Demodulated> channels(3);
  for (Demodulated& channel : channels)
    channel = {Plane::Random(120, 130), Plane::Random(120, 130), Plane::Zero(120, 130)};
  ChromaticModel model{.expected_pixel = pixel, .channels = {}};
  for (const std::size_t i : {0U, 1U}) {
    model.channels[i] = channel_model(
        channel_shift(camera, i == 0 ? 1.02 : 0.985, geometry::pixel_rays(camera), {.along = 0.8}),
        {.slope = 0.1, .offset = 0.2}, pixel);
  }
  Combined whole;
  combine_channels(channels, model, whole);
  for (const ImagePart part : {ImagePart{32, 16, 61, 77}, ImagePart{0, 48, 120, 82}}) {
    std::vector<Demodulated> of_part;
    for (const Demodulated& channel : channels)
      of_part.push_back({part_of(channel.re, part), part_of(channel.im, part), {}});
    Combined combined;
    combine_channels(of_part, part_of(model, part), combined);
    // Beside the border, a channel's place may be outside the part.
    const auto inner = [](const auto& image) {
      return image.block(3, 3, image.rows() - 6, image.cols() - 6).eval();
    };
    for (const auto& [image, expected] : {std::pair{&combined.re, &whole.re},
                                          {&combined.im, &whole.im},
                                          {&combined.shares.red, &whole.shares.red},
                                          {&combined.shares.blue, &whole.shares.blue}}) {
      EXPECT_TRUE((inner(*image) == inner(Plane(part_of(*expected, part)))).all());
    }
  }
}

TEST(Chromatic, SharesSumToOneWithGreen) {
  const Plane one = Plane::Constant(4, 5, 1.0F);
  ChromaticModel model;
  for (ChannelModel& channel : model.channels) {
    channel.cosine = one;
    channel.sine = 0 * one;
  }
  const std::vector<Demodulated> channels = {
      {3 * one, one, one}, {one, 2 * one, one}, {0 * one, one, one}};
  Combined combined;
  combine_channels(channels, model, combined);
  EXPECT_EQ(combined.re(2, 2), 4);
  EXPECT_EQ(combined.im(2, 2), 4);
  EXPECT_FLOAT_EQ(combined.shares.red(2, 2), (1 * 4 + 2 * 4) / 32.0F);
  EXPECT_FLOAT_EQ(combined.shares.blue(2, 2), 4 / 32.0F);
}

constexpr long kComparedRows = 60;
constexpr long kComparedColumns = 200;

/// Green and red that fit a model, and blue that runs ahead of it; with noise.
struct Compared {
  /// \param ahead [rad]
  explicit Compared(const Plane& ahead) {
    const Plane zero = Plane::Zero(kComparedRows, kComparedColumns);
    model.expected_pixel = zero;
    model.channels[0] = channel_model({}, {.slope = 0.02, .offset = 0.3}, zero);
    model.channels[1] = channel_model({}, {.slope = -0.01, .offset = -0.1}, zero);
    add(zero + 1.5F);
    add(zero + 1.5F - 0.3F - 0.06F);
    add(ahead + 1.5F + 0.1F + 0.03F);
  }
  [[nodiscard]] ChromaticError error(const Plane& phase) const {
    // The surface is not where the lags were taken: the projector pixel is 3 farther.
    return remaining_error(channels, model, phase, {.along = 0, .offset = 0, .per_pixel = 0.5},
                           PhaseTexture::disturbs);
  }
  [[nodiscard]] ChromaticError error() const {
    return error(Plane::Constant(kComparedRows, kComparedColumns, 1.5F));
  }

 private:
  void add(const Plane& phase) {
    Demodulated signal{phase, phase, Plane::Ones(phase.rows(), phase.cols())};
    for (long i = 0; i < phase.size(); ++i) {
      const float angle = phase.data()[i] + noise_(generator_);
      signal.re.data()[i] = std::cos(angle);
      signal.im.data()[i] = std::sin(angle);
    }
    channels.push_back(std::move(signal));
  }
  std::mt19937 generator_{1};
  std::normal_distribution<float> noise_{0, 0.05F};
  ChromaticModel model{};
  std::vector<Demodulated> channels;
};

TEST(Chromatic, WhatTheModelLeavesIsFoundAndNoiseIsNot) {
  constexpr float kLeft = 0.06F;  // rad that blue runs ahead
  const Compared compared(Plane::Constant(kComparedRows, kComparedColumns, kLeft));
  const ChromaticError error = compared.error();
  // Twice 0.05^2 of noise, averaged over a few thousand pixels.
  EXPECT_NEAR(error.red, 0, 3e-4);
  EXPECT_NEAR(error.blue, kLeft * kLeft, 8e-4);
  const Plane unknown =
      Plane::Constant(kComparedRows, kComparedColumns, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(compared.error(unknown).blue, 0);
}

TEST(Chromatic, WhatTheModelLeavesIsFoundIfItVariesOverTheFrame) {
  constexpr float kDeviation = 0.1F;  // rad
  std::mt19937 generator(2);
  std::normal_distribution<float> left(0, kDeviation);
  Plane ahead(kComparedRows, kComparedColumns);
  for (long row = 0; row < kComparedRows; ++row) ahead.row(row).setConstant(left(generator));
  const double expected = static_cast<double>(ahead.col(0).square().mean());
  EXPECT_NEAR(Compared(ahead).error().blue, expected, 0.15 * expected);
}

TEST(Chromatic, FewEdgesDoNotCountForTheWholeFrame) {
  constexpr float kLeft = 0.06F, kAtEdges = 0.45F;  // rad
  Plane ahead = Plane::Constant(kComparedRows, kComparedColumns, kLeft);
  for (const long column : {30L, 130L}) ahead.middleCols(column, 20) += kAtEdges - kLeft;
  const double mean = static_cast<double>(ahead.square().mean());
  EXPECT_LT(Compared(ahead).error().blue, mean / 3);
}

}  // namespace
}  // namespace palpate::sensing
