// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Several images of a still scene, rendered ray by ray with nothing of the decoder's code.
#include "palpate/sensing/multishot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "decode/period_code.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/sensing/gray_code.h"
#include "palpate/sensing/pattern_design.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

constexpr double kShotFullWell = 12000;  // electrons
constexpr double kShotReadNoise = 20;

/// The rig of `make_rig` with a camera of a quarter of the pixels.
Rig small_rig(bool verging) {
  Rig rig = make_rig(verging);
  rig.camera = {.width = 160, .height = 120, .fx = 275, .fy = 275, .cx = 79.5, .cy = 59.5};
  return rig;
}

Pattern shots(const Rig& rig, Axis axis, double period, int steps) {
  const Pattern single{.axis = axis, .period = period, .phase = 0.7, .mean = 0.5, .amplitude = 0.5};
  return multishot_pattern(single, steps, {rig.projector.width, rig.projector.height});
}

/// The light of image k at a projector pixel along the axis.
double light_of(const Pattern& pattern, std::size_t k, double pixel) {
  const Multishot& multishot = *pattern.multishot;
  if (k < multishot.shifts.size()) {
    const double angle = 2 * std::numbers::pi * pixel / pattern.period + pattern.phase;
    return pattern.mean + pattern.amplitude * std::cos(angle + multishot.shifts[k]);
  }
  const int bit = multishot.code_bits - 1 - static_cast<int>(k - multishot.shifts.size());
  const auto cell = static_cast<unsigned>((pixel + 0.5) / multishot.code_cell);
  const bool bright = (((cell ^ (cell >> 1)) >> bit) & 1U) != 0;
  return pattern.mean + (bright ? pattern.amplitude : -pattern.amplitude);
}

struct Shots {
  std::vector<cv::Mat> images;  ///< 16 bit, one channel
  geometry::ImageF z;           ///< truth; NaN also where the projector's light ends
};

struct ShotCamera {
  double ambient = 0.05;
  double gain = 0.8;
  double gamma = 1;         ///< value = light ^ gamma
  bool noise = false;       ///< shot and read noise
  unsigned seed = 7;        ///< of the noise
  double displacement = 0;  ///< [mm] of the surface along z from one image to the next
};

Shots take(const Rig& rig, const Pattern& pattern, const Surface& surface,
           const ShotCamera& camera = {}) {
  const std::size_t count =
      pattern.multishot->shifts.size() + static_cast<std::size_t>(pattern.multishot->code_bits);
  Shots shots{{}, geometry::ImageF(rig.camera.height, rig.camera.width)};
  for (std::size_t k = 0; k < count; ++k)
    shots.images.emplace_back(rig.camera.height, rig.camera.width, CV_16U);
  std::mt19937 generator(camera.seed);
  std::normal_distribution<double> normal;
  const int axis = pattern.axis == Axis::x ? 0 : 1;
  for (int v = 0; v < rig.camera.height; ++v) {
    for (int u = 0; u < rig.camera.width; ++u) {
      const Eigen::Vector2d ray = geometry::undistort(rig.camera, {u, v});
      const double z = surface(ray);
      for (std::size_t k = 0; k < count; ++k) {
        const double now = z + camera.displacement * static_cast<double>(k);
        const Eigen::Vector3d point = rig.T_projector_camera * (now * ray.homogeneous());
        const Eigen::Vector2d pixel = geometry::distort(rig.projector, point.hnormalized());
        const bool lit = pixel.x() > -0.5 && pixel.y() > -0.5 &&
                         pixel.x() < rig.projector.width - 0.5 &&
                         pixel.y() < rig.projector.height - 0.5;
        double value =
            camera.ambient + (lit ? camera.gain * light_of(pattern, k, pixel[axis]) : 0.0);
        value = std::pow(std::min(value, 1.0), camera.gamma);
        if (camera.noise) {
          const double electrons = value * kShotFullWell;
          value += std::sqrt(electrons + kShotReadNoise * kShotReadNoise) / kShotFullWell *
                   normal(generator);
        }
        shots.images[k].at<ushort>(v, u) =
            static_cast<ushort>(std::lround(65535 * std::clamp(value, 0.0, 1.0)));
        if (k == 0) shots.z(v, u) = lit ? static_cast<float>(z) : kFloatNaN;
      }
    }
  }
  return shots;
}

struct Errors {
  long known = 0;
  long lit = 0;
  double largest = 0;  ///< relative to the depth
  double score = 0;    ///< RMS of error / sigma
};

Errors compare(const MultishotResult& result, const geometry::ImageF& truth) {
  Errors errors;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    if (!std::isnan(truth.data()[i])) ++errors.lit;
    const auto z = static_cast<double>(result.decoded.range.z.data()[i]);
    if (std::isnan(z)) continue;
    const auto wanted = static_cast<double>(truth.data()[i]);
    const double error = std::isnan(wanted) ? z : z - wanted;  // a depth of nothing is wrong
    const double score = error / static_cast<double>(result.decoded.sigma.data()[i]);
    ++errors.known;
    errors.largest = std::max(errors.largest, std::abs(error) / z);
    errors.score += score * score;
  }
  errors.score = std::sqrt(errors.score / static_cast<double>(errors.known));
  return errors;
}

TEST(Multishot, MeasuresStillSurfacesExactlyForAnyNumberOfStepsAndEitherAxis) {
  const Surface scene = nearer(sphere({10, 5, 700}, 70), plane({0.2, -0.1, 1}, 760));
  struct Case {
    bool verging;
    Axis axis;
    int steps;
  };
  for (const Case& now : {Case{false, Axis::y, 3}, Case{false, Axis::x, 8}, Case{true, Axis::y, 5},
                          Case{true, Axis::x, 4}, Case{false, Axis::y, 12}}) {
    const Rig rig = small_rig(now.verging);
    const Pattern pattern = shots(rig, now.axis, 37.3, now.steps);
    const Shots seen = take(rig, pattern, scene);
    const MultishotResult result = MultishotDecoder(rig, pattern).decode(seen.images);
    const Errors errors = compare(result, seen.z);
    EXPECT_LT(errors.largest, 1e-5) << now.steps << " steps";
    EXPECT_GT(errors.known, 0.9 * static_cast<double>(errors.lit)) << now.steps << " steps";
  }
}

TEST(Multishot, ReachesTheCramerRaoBoundAndKnowsItsErrors) {
  const Rig rig = small_rig(false);
  constexpr double kFarAway = 700;
  for (const int steps : {3, 4, 6, 12}) {
    Pattern pattern = shots(rig, Axis::y, 30, steps);
    const ShotCamera camera{.noise = true};
    const Shots seen = take(rig, pattern, plane({0, 0, 1}, kFarAway), camera);
    const MultishotResult result = MultishotDecoder(rig, pattern).decode(seen.images);
    // Parallel axes: dz / dpixel = z^2 / (f t) up to the projector's offset along z.
    const Eigen::Vector3d t = rig.T_projector_camera.translation();
    const double forward = kFarAway + t.z();
    const double value = camera.ambient + camera.gain * pattern.mean;
    const double variance =
        (value * kShotFullWell + kShotReadNoise * kShotReadNoise) / (kShotFullWell * kShotFullWell);
    const double sigma_phase = std::sqrt(2 * variance / steps) / (camera.gain * pattern.amplitude);
    double sum = 0;
    long count = 0;
    for (int v = 0; v < rig.camera.height; ++v) {
      const double ray = (v - rig.camera.cy) / rig.camera.fy;
      const double phase_per_mm = 2 * std::numbers::pi / pattern.period * rig.projector.fy *
                                  std::abs(ray * t.z() - t.y()) / (forward * forward);
      for (int u = 0; u < rig.camera.width; ++u) {
        const auto error = static_cast<double>(result.decoded.range.z(v, u)) - kFarAway;
        if (std::isnan(error)) continue;
        sum += std::pow(error * phase_per_mm / sigma_phase, 2);
        ++count;
      }
    }
    ASSERT_GT(count, 15000);
    EXPECT_NEAR(std::sqrt(sum / static_cast<double>(count)), 1, 0.05) << steps << " steps";
    EXPECT_NEAR(compare(result, seen.z).score, 1, 0.1) << steps << " steps";
  }
}

TEST(Multishot, KeepsTheHarmonicsOfAResponseOutOfThePhase) {
  const Rig rig = small_rig(false);
  const auto largest = [&](int steps) {
    const Pattern pattern = shots(rig, Axis::y, 37.3, steps);
    const Shots seen = take(rig, pattern, plane({0, 0, 1}, 700), {.gain = 0.9, .gamma = 2.2});
    return compare(MultishotDecoder(rig, pattern).decode(seen.images), seen.z).largest;
  };
  EXPECT_GT(largest(3), 1e-3);  // the second harmonic
  EXPECT_LT(largest(8), 3e-5);
}

TEST(Multishot, UsesTheExposuresInWhichAPixelIsNotClipped) {
  const Rig rig = small_rig(false);
  const Pattern pattern = shots(rig, Axis::y, 30, 4);
  const Surface surface = plane({0, 0, 1}, 700);
  const Shots dark =
      take(rig, pattern, surface, {.ambient = 0.01, .gain = 0.1, .noise = true, .seed = 1});
  const Shots bright =
      take(rig, pattern, surface, {.ambient = 0.08, .gain = 0.8, .noise = true, .seed = 2});
  Shots clipped =
      take(rig, pattern, surface, {.ambient = 0.16, .gain = 1.6, .noise = true, .seed = 3});
  const auto decode = [&](std::vector<const Shots*> sets) {
    std::vector<cv::Mat> images;
    for (const Shots* set : sets)
      images.insert(images.end(), set->images.begin(), set->images.end());
    return MultishotDecoder(rig, pattern, {.exposures = static_cast<int>(sets.size())})
        .decode(images);
  };
  const auto median_sigma = [](const MultishotResult& result) {
    const auto& sigma = result.decoded.sigma;
    std::vector<float> known;
    std::copy_if(sigma.data(), sigma.data() + sigma.size(), std::back_inserter(known),
                 [](float value) { return value > 0; });
    std::nth_element(known.begin(), known.begin() + static_cast<long>(known.size() / 2),
                     known.end());
    return known[known.size() / 2];
  };
  const MultishotResult one = decode({&bright});
  const MultishotResult other = decode({&dark});
  const MultishotResult three = decode({&clipped, &bright, &dark});
  EXPECT_GT(count(decode({&clipped}).decoded.reasons, Reason::saturated), 1000);
  EXPECT_EQ(count(three.decoded.reasons, Reason::saturated), 0);
  EXPECT_LT(compare(three, bright.z).largest, 0.01);
  EXPECT_NEAR(compare(three, bright.z).score, 1, 0.1);
  EXPECT_LT(median_sigma(three), median_sigma(one));
  EXPECT_LT(median_sigma(one), 0.5F * median_sigma(other));
}

TEST(Multishot, NoticesThatTheSceneMoved) {
  const Rig rig = small_rig(false);
  const Surface surface = plane({0, 0, 1}, 700);
  for (const int steps : {4, 5, 8}) {
    const Pattern pattern = shots(rig, steps == 5 ? Axis::x : Axis::y, 30, steps);
    const auto disagreement = [&](double displacement) {
      const Shots seen = take(rig, pattern, surface, {.noise = true, .displacement = displacement});
      return MultishotDecoder(rig, pattern).decode(seen.images).disagreement;
    };
    EXPECT_LT(disagreement(0), kStillDisagreement / 4) << steps << " steps";
    EXPECT_GT(disagreement(2), kStillDisagreement) << steps << " steps";
  }
  const Pattern three = shots(rig, Axis::y, 30, 3);
  EXPECT_TRUE(std::isnan(
      MultishotDecoder(rig, three).decode(take(rig, three, surface).images).disagreement));
}

TEST(Multishot, NoticesThatTheImagesOfTheCodeAreInAnotherOrder) {
  for (const bool verging : {false, true}) {
    const Rig rig = small_rig(verging);
    const Pattern pattern = shots(rig, verging ? Axis::y : Axis::x, 16, 4);
    // Two depths: a step is no jump of the code, though at a few pixels it may look like one.
    const Surface surface = [](const Eigen::Vector2d& ray) {
      return (ray.x() + ray.y() < 0 ? 600.0 : 640.0) + 40 * ray.x();
    };
    const Shots right = take(rig, pattern, surface, {.noise = true});
    const MultishotDecoder decoder(rig, pattern);
    EXPECT_LT(decoder.decode(right.images).code_jumps, kOrderedCodeJumps / 4);
    const auto sinusoids = static_cast<long>(pattern.multishot->shifts.size());
    std::vector<cv::Mat> reversed = right.images;
    std::reverse(reversed.begin() + sinusoids, reversed.end());
    EXPECT_GT(decoder.decode(reversed).code_jumps, 10 * kOrderedCodeJumps);
    // The bits that are swapped must differ within the picture.
    for (int bit = 2; bit + 1 < pattern.multishot->code_bits; ++bit) {
      std::vector<cv::Mat> swapped = right.images;
      std::swap(swapped[static_cast<std::size_t>(sinusoids + bit)],
                swapped[static_cast<std::size_t>(sinusoids + bit + 1)]);
      EXPECT_GT(decoder.decode(swapped).code_jumps, kOrderedCodeJumps) << "bit " << bit;
    }
  }
}

TEST(Multishot, GivesNoDepthWhereThereIsNoLightOrTheCodeContradictsThePhase) {
  const Rig rig = small_rig(false);
  const Pattern pattern = shots(rig, Axis::y, 30, 4);
  Shots seen = take(rig, pattern, plane({0, 0, 1}, 700));
  const cv::Rect shadow(20, 20, 30, 30);
  for (cv::Mat& image : seen.images) image(shadow).setTo(0.05 * 65535);
  // A highest bit that is misread everywhere in a place: a reflection, or a mixed-up image.
  const cv::Rect misread(80, 20, 30, 30);
  cv::Mat place = seen.images[4](misread);
  for (auto& value : cv::Mat_<ushort>(place)) value = static_cast<ushort>(2 * 0.45 * 65535 - value);
  const MultishotResult result = MultishotDecoder(rig, pattern).decode(seen.images);
  EXPECT_EQ(count(result.decoded.reasons, Reason::unlit), shadow.area());
  EXPECT_EQ(count(result.decoded.reasons, Reason::ambiguous_offset), misread.area());
  EXPECT_LT(compare(result, seen.z).largest, 1e-5);
  for (const double level : {0.0, 0.5, 1.0}) {  // the projector is off, or everything is clipped
    for (cv::Mat& image : seen.images) image.setTo(level * 65535);
    EXPECT_TRUE(MultishotDecoder(rig, pattern).decode(seen.images).decoded.range.z.isNaN().all());
  }
}

TEST(Multishot, RefusesImagesThatDoNotFit) {
  const Rig rig = small_rig(false);
  const Pattern pattern = shots(rig, Axis::y, 30, 4);
  const MultishotDecoder decoder(rig, pattern);
  std::vector<cv::Mat> images = take(rig, pattern, plane({0, 0, 1}, 700)).images;
  EXPECT_EQ(decoder.images(), static_cast<int>(images.size()));
  EXPECT_THROW((void)decoder.decode(std::span(images).first(4)), InvalidInput);
  std::vector<cv::Mat> other = images;
  other[2] = cv::Mat(10, 10, CV_16U);
  EXPECT_THROW((void)decoder.decode(other), InvalidInput);
  other[2] = cv::Mat(120, 160, CV_8U);
  EXPECT_THROW((void)decoder.decode(other), InvalidInput);
  EXPECT_THROW(MultishotDecoder(rig, make_pattern(Axis::y, 10, 1024)), InvalidInput);
  EXPECT_THROW(MultishotDecoder(rig, pattern, {.exposures = 0}), InvalidInput);
}

/// Reading of a pixel at a place: full contrast, except for the bits at whose edge it is.
CodeReading reading_at(const Multishot& multishot, double pixel, double blur) {
  CodeReading reading;
  for (int bit = multishot.code_bits - 1; bit >= 0; --bit) {
    const auto value = [&](double place) {
      const auto cell = static_cast<unsigned>((place - multishot.code_start) / multishot.code_cell);
      return ((gray_code_of(cell) >> bit) & 1U) != 0 ? 1.0 : -1.0;
    };
    double sum = 0;
    for (int i = -10; i <= 10; ++i) sum += value(pixel + blur * i / 10);
    reading.append(static_cast<float>(sum / 21), bit);
  }
  return reading;
}

TEST(PeriodCode, ResolvesEveryPlaceAlsoAtItsEdgesWhateverTheNoiseSaysThere) {
  for (const double cell : {15.0, 22.5, 4.0}) {
    Pattern pattern{.axis = Axis::x, .period = 30, .phase = 1.1};
    pattern.multishot = Multishot{{0, 2, 4}, 9, cell, -0.5};
    const PeriodCode code(pattern);
    for (double pixel = 3; pixel < 500; pixel += 0.1) {
      const double phase = 2 * std::numbers::pi * pixel / 30 + pattern.phase;
      const double wrapped = std::remainder(phase, 2 * std::numbers::pi);
      CodeReading reading = reading_at(*pattern.multishot, pixel, 1.5);
      ASSERT_NEAR(code.absolute(wrapped, reading).value_or(kNaN), phase, 1e-9) << pixel;
      if (!(reading.margin < 0.45F)) continue;
      reading.code ^= 1U << reading.weakest;  // noise at the edge
      ASSERT_NEAR(code.absolute(wrapped, reading).value_or(kNaN), phase, 1e-9) << pixel;
    }
  }
}

TEST(PeriodCode, RefusesAnyBitThatIsMisread) {
  Pattern pattern{.axis = Axis::x, .period = 30, .phase = 1.1};
  pattern.multishot = Multishot{{0, 2, 4}, 6, 15, -0.5};
  const PeriodCode code(pattern);
  for (double pixel = 0; pixel < 950; pixel += 0.1) {
    const double cells = (pixel + 0.5) / 15;
    if (std::abs(cells - std::round(cells)) < 0.04) continue;
    const double phase = 2 * std::numbers::pi * pixel / 30 + pattern.phase;
    for (int bit = 0; bit < 6; ++bit) {
      CodeReading reading = reading_at(*pattern.multishot, pixel, 0.1);
      reading.code ^= 1U << bit;
      ASSERT_FALSE(code.absolute(std::remainder(phase, 2 * std::numbers::pi), reading)) << pixel;
    }
  }
}

}  // namespace
}  // namespace palpate::sensing
