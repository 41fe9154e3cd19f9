// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/hidden_steps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "image/hue.h"
#include "palpate/sensing/decode.h"
#include "setup/triangulation.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr long kStep = 160;     ///< column of the first pixel of the second surface
constexpr long kDisplaced = 7;  ///< px by which the phase's discontinuity is farther to the right

/// Two surfaces whose depths differ by one turn of the phase, seen in their stripes' colours.
struct TwoSurfaces {
  TwoSurfaces() {
    for (int row = 0; row < model.rows(); ++row) {
      for (int column = 0; column < model.columns(); ++column) {
        const double first = *model.phase_at_depth(row, column, 700);
        const auto pixel_with = [&](int turns) {
          std::vector<float> pixels;
          model.stripes_at_phases({{.row = row, .column = column, .phase = first}}, turns, pixels);
          return stripes.color(pixels[0]);
        };
        color_of_first(row, column) = pixel_with(0);
        color_of_second(row, column) = pixel_with(1);
        const int seen =
            column < kStep ? color_of_first(row, column) : color_of_second(row, column);
        // Near an edge, any colour may be seen.
        hue(row, column) = static_cast<float>(std::max(seen, 0) * std::numbers::pi / 3);
        const bool second = column >= kStep + kDisplaced;
        phase(row, column) = static_cast<float>(first + (second ? kFullTurn : 0));
      }
    }
  }

  [[nodiscard]] Mask hidden() const {
    Mask marked;
    find_hidden_steps(channels, phase, hue, classifier, stripes, model, marked);
    return marked;
  }

  Pattern pattern = make_pattern(Axis::y, 20, 1024);
  DecoderGeometry model{make_rig(false), pattern};
  HueClassifier classifier{pattern, ideal_colors()};
  StripeColors stripes{pattern};
  Labels color_of_first{model.rows(), model.columns()};
  Labels color_of_second{model.rows(), model.columns()};
  Plane phase{model.rows(), model.columns()};
  Plane hue{model.rows(), model.columns()};
  std::vector<Demodulated> channels{
      3,
      {Plane::Ones(model.rows(), model.columns()), Plane::Zero(model.rows(), model.columns()), {}}};
};

TEST(HiddenSteps, PixelsThatFitTheOtherSurfaceAreMarked) {
  const TwoSurfaces scene;
  const Mask marked = scene.hidden();
  long displaced = 0;
  for (long row = 0; row < marked.rows(); ++row) {
    // From the discontinuity to the left, as long as the second surface's colours are seen.
    bool fits = true;
    for (long column = kStep + kDisplaced - 1; column >= kStep; --column) {
      const int color = scene.color_of_second(row, column);
      fits = fits && (color < 0 || scene.classifier.best(scene.hue(row, column)) == color);
      if (!fits) break;
      EXPECT_EQ(marked(row, column), 1) << row << ' ' << column;
      ++displaced;
    }
  }
  EXPECT_EQ(displaced, kDisplaced * marked.rows());
}

TEST(HiddenSteps, PixelsThatShowTheirOwnColorAreNotMarked) {
  const TwoSurfaces scene;
  const Mask marked = scene.hidden();
  for (long row = 0; row < marked.rows(); ++row) {
    bool own = false;
    for (long column = kStep - 1; column >= 0; --column) {
      const int first = scene.color_of_first(row, column),
                second = scene.color_of_second(row, column);
      own = own || (first >= 0 && second >= 0 && first != second);
      if (!own) continue;
      EXPECT_EQ(marked(row, column), 0) << row << ' ' << column;
    }
    EXPECT_TRUE(own);
  }
}

TEST(HiddenSteps, AStepThatChangesTheBrightnessIsSeen) {
  TwoSurfaces scene;
  for (Demodulated& channel : scene.channels)
    channel.re.rightCols(channel.re.cols() - kStep - kDisplaced) *= 2.0F;
  EXPECT_EQ(scene.hidden().cast<int>().sum(), 0);
}

TEST(HiddenSteps, OtherDiscontinuitiesAreSeen) {
  TwoSurfaces scene;
  scene.phase.rightCols(scene.phase.cols() - kStep - kDisplaced) += 1.5F;
  EXPECT_EQ(scene.hidden().cast<int>().sum(), 0);
}

TEST(HiddenSteps, DepthsBesideThemAreNotGuessed) {
  const Rig rig = make_rig(false);
  const Pattern pattern = make_pattern(Axis::y, 20, 1024);
  const Triangulation exact(rig);
  // Bars of 60 px, of which every second one is farther away by one period.
  const Surface bars = [&](const Eigen::Vector2d& ray) {
    const auto bar = static_cast<int>((rig.camera.fx * ray.x() + rig.camera.cx) / 60);
    if (bar % 2 == 0) return 700.0;
    const Eigen::Vector3d direction = exact.direction(ray);
    return exact.depth(direction, Axis::y, exact.project(direction, 700).y() + pattern.period);
  };
  Scene scene = render(rig, pattern, bars);
  add_noise(scene.frame, 0.01, 1);
  const geometry::ImageF z = Decoder(rig, pattern, ideal_colors()).decode(scene.frame).range.z;
  constexpr float kOff = 5;  // mm: a period is more than 20
  const long known = z.isFinite().count();
  EXPECT_GE(known, z.size() * 3 / 4);
  EXPECT_LE(((z - scene.z).abs() > kOff).count(), known / 500);
}

}  // namespace
}  // namespace palpate::sensing
