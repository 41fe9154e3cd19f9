// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// Tissue that is pressed along z: a spring in series with a spring beside a damper, all of them
/// stiffening, k x + b x^2. Not the law of `RateTerm`: forces do not fade exponentially.
struct Tissue {
  double stiffness = 0.4;    ///< [N/mm] of the first spring
  double delayed = 0.9;      ///< [N/mm] of the second one
  double stiffening = 0.15;  ///< [1/mm] b / k
  double damping = 0.12;     ///< [N s/mm]

  [[nodiscard]] double spring(double k, double x) const { return k * x * (1 + stiffening * x); }
};

struct TissueMoment {
  double time = 0, depth = 0, force = 0;
};

/// The forces of a motion from rest at depth 0, integrated in steps of 0.1 ms (Heun), every
/// `sample` seconds.
inline std::vector<TissueMoment> press_tissue(const Tissue& tissue,
                                              const std::function<double(double)>& depth,
                                              double duration, double sample) {
  constexpr double kStep = 1e-4;
  std::vector<TissueMoment> moments;
  double late = 0;  // [mm] of the second spring
  const auto rate = [&](double u, double z) {
    return (tissue.spring(tissue.stiffness, u - z) - tissue.spring(tissue.delayed, z)) /
           tissue.damping;
  };
  const auto steps = std::lround(duration / kStep), every = std::lround(sample / kStep);
  for (long k = 0; k <= steps; ++k) {
    const double time = static_cast<double>(k) * kStep, u = depth(time);
    if (k % every == 0) moments.push_back({time, u, tissue.spring(tissue.stiffness, u - late)});
    const double first = rate(u, late);
    const double second = rate(depth(time + kStep), late + kStep * first);
    late += kStep * (first + second) / 2;
  }
  return moments;
}

/// Presses and returns at a constant speed, as far as [mm].
inline std::function<double(double)> in_and_out(double speed, double deepest) {
  return [speed, deepest](double time) {
    return std::max(0.0, deepest - std::abs(speed * time - deepest));
  };
}

/// Lowers the tool in 1 s to `middle`, and moves it up and down from there.
inline std::function<double(double)> swinging(double middle, double size, double hertz) {
  return [=](double time) {
    const double down = std::min(time, 1.0);
    const double swing = std::sin(2 * std::numbers::pi * hertz * (time - 1));
    return middle * down + (time > 1 ? size * swing : 0);
  };
}

/// Amplitude and phase of the force against the depth at a frequency, over whole periods at the
/// end.
struct Response {
  double ratio = 0;  ///< [N/mm]
  double lead = 0;   ///< [rad] by which force leads depth
};
inline Response response_of(const std::vector<TissueMoment>& moments, double hertz, int periods) {
  const double begin = moments.back().time - periods / hertz;
  double depth_sine = 0, depth_cosine = 0, force_sine = 0, force_cosine = 0;
  double depth_mean = 0, force_mean = 0, count = 0;
  for (const TissueMoment& moment : moments) {
    if (moment.time <= begin) continue;
    depth_mean += moment.depth;
    force_mean += moment.force;
    count += 1;
  }
  depth_mean /= count;
  force_mean /= count;
  for (const TissueMoment& moment : moments) {
    if (moment.time <= begin) continue;
    const double angle = 2 * std::numbers::pi * hertz * moment.time;
    depth_sine += (moment.depth - depth_mean) * std::sin(angle);
    depth_cosine += (moment.depth - depth_mean) * std::cos(angle);
    force_sine += (moment.force - force_mean) * std::sin(angle);
    force_cosine += (moment.force - force_mean) * std::cos(angle);
  }
  return {.ratio = std::hypot(force_sine, force_cosine) / std::hypot(depth_sine, depth_cosine),
          .lead = std::remainder(
              std::atan2(force_cosine, force_sine) - std::atan2(depth_cosine, depth_sine),
              2 * std::numbers::pi)};
}

/// Nine contacts on the flat surface of sheet_model.h, 30 mm apart, whose stiffness changes along
/// x; each was pressed by 4 mm at two speeds and swung at 2.5 Hz, recorded at 20 Hz with noise.
inline probing::Acquisition tissue_acquisition(const Tissue& tissue, double noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, noise);
  probing::Acquisition acquisition;
  double now = 0;
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d place(30.0 * (i % 3 - 1), 30.0 * (i / 3 - 1), 700);
    acquisition.contacts.push_back({i, place, {0, 0, -1}});
    const double scale = 1 + 0.2 * (i % 3 - 1);
    const auto record = [&](const std::function<double(double)>& depth, double duration) {
      for (const TissueMoment& moment : press_tissue(tissue, depth, duration, 0.05)) {
        const Eigen::Vector3d tool = place + Eigen::Vector3d(0, 0, moment.depth);
        const auto id = static_cast<long long>(acquisition.samples.size());
        acquisition.samples.push_back({.id = id,
                                       .contact = i,
                                       .group = id,
                                       .force = {0, 0, scale * moment.force + normal(random)},
                                       .a = tool,
                                       .b = tool,
                                       .time = now + moment.time});
      }
      now += duration + 10;
    };
    record(in_and_out(4, 4), 2);
    record(in_and_out(16, 4), 0.5);
    record(swinging(3, 1, 2.5), 3);
  }
  return acquisition;
}

}  // namespace palpate::haptics
