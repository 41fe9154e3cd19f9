// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Patterns without stripes: what one anchor tells, and what it does not.
#include "decode/anchored_regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "palpate/error.h"
#include "palpate/sensing/frame.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

constexpr double kWallDistance = 720;  // [mm]
/// Depths beyond this share of a period's are off by a period.
constexpr double kPeriodShare = 0.4;

Pattern plain() {
  return {.axis = Axis::y, .period = 20, .phase = 0, .mean = 0.5, .amplitude = 0.4};
}

/// [mm] Change of the depth at the wall for a turn of the phase, in the middle of the image.
double period_depth(const Rig& rig) {
  const double baseline = rig.T_projector_camera.translation().y();
  return plain().period * kWallDistance * kWallDistance / (rig.projector.fy * baseline);
}

/// A tilted card before the wall; light falls off with the square of the distance.
Scene card_before_wall(const Rig& rig, double before) {
  const Surface wall = plane({0, 0.05, 1}, kWallDistance);
  const Surface card = plane({0.1, -0.1, 1}, kWallDistance - before);
  Scene scene = render(rig, plain(), [&](const Eigen::Vector2d& ray) {
    const bool hit = std::abs(ray.x() + 0.02) < 0.13 && std::abs(ray.y()) < 0.1;
    return hit ? card(ray) : wall(ray);
  });
  for (int v = 0; v < rig.camera.height; ++v) {
    for (int u = 0; u < rig.camera.width; ++u) {
      const double nearer = kWallDistance / static_cast<double>(scene.z(v, u));
      for (int channel = 0; channel < 3; ++channel) {
        auto& value = scene.frame.at<cv::Vec<ushort, 3>>(v, u)[channel];
        value = static_cast<ushort>(std::lround(value * 0.6 * nearer * nearer));
      }
    }
  }
  add_noise(scene.frame, 0.005, 3);
  return scene;
}

Anchor anchor_at(const Scene& scene, int u, int v) {
  return {.u_px = static_cast<double>(u),
          .v_px = static_cast<double>(v),
          .z = static_cast<double>(scene.z(v, u))};
}

struct Score {
  long known = 0;
  double wrong = 0;  ///< share of them
};
Score score(const geometry::ImageF& z, const geometry::ImageF& truth, double wrong_from) {
  const auto known = z > 0;
  const long count = known.count();
  const long wrong = (known && !((z - truth).abs() < static_cast<float>(wrong_from))).count();
  return {count, static_cast<double>(wrong) / static_cast<double>(std::max(1L, count))};
}

TEST(AnchoredRegions, StepsOfAnySizeEndWhatAnAnchorTells) {
  const Rig rig = make_rig(false);
  const double period = period_depth(rig);
  for (const double periods : {1.0, 1.35, 1.5, 1.8, 2.0, 2.3, 3.0, 4.6}) {
    const Scene scene = card_before_wall(rig, periods * period);
    const Anchor wall = anchor_at(scene, 20, 120), card = anchor_at(scene, 150, 120);
    for (const auto& anchors : {std::vector{wall}, std::vector{card}, std::vector{wall, card}}) {
      const DecodeResult result =
          Decoder(rig, plain(), {}, {.anchors = anchors}).decode(scene.frame);
      const Score found = score(result.range.z, scene.z, kPeriodShare * period);
      EXPECT_LE(found.wrong, 0.01) << periods << ' ' << anchors.size() << ' ' << anchors[0].u_px;
      EXPECT_GE(found.known, 5000) << periods << ' ' << anchors.size() << ' ' << anchors[0].u_px;
    }
  }
}

TEST(AnchoredRegions, ASmoothReliefIsOneSurface) {
  const Rig rig = make_rig(false);
  // Waves of 6 mm, more than a tenth of a period.
  const Surface relief = [](const Eigen::Vector2d& ray) {
    return 700 + 6 * std::sin(40 * ray.x()) * std::cos(30 * ray.y());
  };
  Scene scene = render(rig, plain(), relief);
  add_noise(scene.frame, 0.005, 3);
  const DecodeResult result =
      Decoder(rig, plain(), {}, {.anchors = {anchor_at(scene, 160, 120)}}).decode(scene.frame);
  const Score found = score(result.range.z, scene.z, 2);
  EXPECT_LE(found.wrong, 0.001);
  EXPECT_GE(static_cast<double>(found.known), 0.95 * static_cast<double>(scene.z.size()));
}

/// A real capture, and its depths at every `spacing`th pixel, from other images of the scene.
struct Capture {
  explicit Capture(const std::string& name, int true_spacing)
      : spacing(true_spacing),
        rig(read_rig(folder() / (name + "_rig.yaml"))),
        pattern(read_pattern(folder() / "pattern.yaml")),
        frame(read_frame(folder() / (name + ".png"))),
        depth(read_frame(folder() / (name + "_depth.png"))) {}
  static std::filesystem::path folder() {
    return repository("tests/sensing/captures/phase_shifting");
  }
  /// 0 if unknown.
  [[nodiscard]] double z(int row, int column) const {
    return depth.at<ushort>(row / spacing, column / spacing) / 100.0;
  }
  [[nodiscard]] Anchor anchor(int column, int row) const {
    return {static_cast<double>(column), static_cast<double>(row), z(row, column)};
  }
  [[nodiscard]] Score score(const std::vector<Anchor>& anchors, Segmentation segmentation) const {
    const DecodeResult result =
        Decoder(rig, pattern, {}, {.segmentation = segmentation, .anchors = anchors}).decode(frame);
    Score score;
    long wrong = 0;
    for (int row = 0; row < frame.rows; row += spacing) {
      for (int column = 0; column < frame.cols; column += spacing) {
        const double found = static_cast<double>(result.range.z(row, column));
        if (!(found > 0) || z(row, column) == 0) continue;
        ++score.known;
        wrong += std::abs(found - z(row, column)) > kHalfPeriod ? 1 : 0;
      }
    }
    score.wrong = static_cast<double>(wrong) / static_cast<double>(std::max(1L, score.known));
    return score;
  }
  static constexpr double kHalfPeriod = 10;  ///< [mm] nearly
  int spacing;
  Rig rig;
  Pattern pattern;
  cv::Mat frame;
  cv::Mat depth;
};

TEST(AnchoredRegions, ADarkWallThatWasReallyTakenIsMeasured) {
  const Capture wall("wall", 8);
  for (const Segmentation segmentation : {Segmentation::flood, Segmentation::snakes}) {
    const Score found = wall.score({wall.anchor(240, 80)}, segmentation);
    EXPECT_EQ(found.wrong, 0);
    EXPECT_GE(found.known, 600);  // of 1,140
  }
}

TEST(AnchoredRegions, ARealCanAndTheWallBehindItAreTwoSurfaces) {
  const Capture can("can", 4);
  const Anchor on_wall = can.anchor(40, 60), on_can = can.anchor(200, 120);
  const Score wall = can.score({on_wall}, Segmentation::flood);
  EXPECT_LE(wall.wrong, 0.01);
  EXPECT_GE(wall.known, 700);
  const Score front = can.score({on_can}, Segmentation::flood);
  EXPECT_LE(front.wrong, 0.01);
  EXPECT_GE(front.known, 300);
  const Score both = can.score({on_wall, on_can}, Segmentation::flood);
  EXPECT_LE(both.wrong, 0.01);
  EXPECT_EQ(both.known, wall.known + front.known);
}

TEST(AnchoredRegions, ContradictingAnchorsOfOneSurfaceAreRefusedByName) {
  const Rig rig = make_rig(false);
  const Scene scene = render(rig, plain(), plane({0, 0, 1}, kWallDistance));
  const Anchor one = anchor_at(scene, 100, 120);
  Anchor two = anchor_at(scene, 200, 120);
  const auto decoded = [&] {
    return Decoder(rig, plain(), {}, {.anchors = {one, two}}).decode(scene.frame);
  };
  two.z += 5;  // within the same period
  EXPECT_GT((decoded().range.z > 0).count(), 30000);
  two.z = 640;
  const std::string refusal = message_of<InvalidInput>(decoded);
  EXPECT_NE(refusal.find("100,120,720"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("200,120,640"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("2 whole periods"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace palpate::sensing
