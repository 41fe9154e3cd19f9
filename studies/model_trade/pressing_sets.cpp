// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "pressing_sets.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr double kInclusionX = 8, kInclusionY = -5;  // [mm]
constexpr double kMargin = 4;                        // [mm] of the surface around the places
constexpr int kVertices = 61;                        // along a side of the surface
constexpr int kQueries = 400;
constexpr double kPositionNoise = 0.005;  // [mm]
constexpr double kPeriod = 0.35;          // [s] between records

double height(double x, double y) {
  return 600 + 0.004 * x * x - 0.003 * y * y + 1.5 * std::sin(x / 14) * std::cos(y / 17);
}

Vector3d outwards(double x, double y) {
  constexpr double kStep = 1e-4;
  return Vector3d((height(x + kStep, y) - height(x - kStep, y)) / (2 * kStep),
                  (height(x, y + kStep) - height(x, y - kStep)) / (2 * kStep), -1)
      .normalized();
}

Vector3d place(double x, double y) { return {x, y, height(x, y)}; }

class Waves {
 public:
  Waves(const PressingKind& kind, unsigned seed) : kind_(kind) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
    for (Eigen::Vector2d& wave : waves_) wave = {angle(random), angle(random)};
  }
  [[nodiscard]] double at(double x, double y) const {
    double sum = 0;
    for (const Eigen::Vector2d& wave : waves_) {
      const double along = std::cos(wave.x()) * x + std::sin(wave.x()) * y;
      sum += std::cos(2 * std::numbers::pi * along / kind_.wavelength + wave.y());
    }
    return kind_.waves * std::sqrt(2.0 / kWaves) * sum;
  }

 private:
  static constexpr int kWaves = 8;
  const PressingKind& kind_;
  std::array<Eigen::Vector2d, kWaves> waves_;  // direction and phase
};

double force_of(const PressingKind& kind, const Waves& waves, double x, double y, double depth) {
  if (!(depth > 0)) return 0;
  const double square = std::pow(x - kInclusionX, 2) + std::pow(y - kInclusionY, 2);
  const double stiffness =
      kind.stiffness *
      (1 + (kind.contrast - 1) * std::exp(-square / (2 * kind.width * kind.width))) *
      std::exp(waves.at(x, y));
  return stiffness * (depth + depth * depth / kind.hardening);
}

Vector3d rounded_to(const Vector3d& value, double digit) {
  return (value / digit).array().round() * digit;
}

// A surface over a grid of corners.
geometry::TriangleMesh grid_surface(const std::vector<Vector3d>& corners, int side) {
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = corners[i];
  mesh.triangles.resize(3, 2 * (side - 1) * (side - 1));
  Eigen::Index column = 0;
  for (int j = 0; j + 1 < side; ++j) {
    for (int i = 0; i + 1 < side; ++i) {
      const int a = j * side + i;
      mesh.triangles.col(column++) << a, a + side + 1, a + 1;
      mesh.triangles.col(column++) << a, a + side, a + side + 1;
    }
  }
  return mesh;
}

geometry::TriangleMesh true_surface(const PressingKind& kind) {
  std::vector<Vector3d> corners;
  const double from = -kind.side / 2 - kMargin, step = (kind.side + 2 * kMargin) / (kVertices - 1);
  for (int j = 0; j < kVertices; ++j)
    for (int i = 0; i < kVertices; ++i) corners.push_back(place(from + step * i, from + step * j));
  return grid_surface(corners, kVertices);
}

}  // namespace

std::vector<PressingKind> pressing_kinds() {
  const PressingKind phantom{.name = "phantom"};
  const PressingKind tissue{.name = "tissue",
                            .stiffness = 0.06,
                            .contrast = 3,
                            .width = 7,
                            .hardening = 3,
                            .noise = 0.006,
                            .bias = 0.01,
                            .late = 0.5,
                            .way_back = 0.2};
  const PressingKind tilted{.name = "tilted",
                            .stiffness = 0.18,
                            .contrast = 5,
                            .width = 8,
                            .hardening = 5,
                            .noise = 0.02,
                            .bias = 0.05,
                            .late = 0.2,
                            .least_tilt = 8,
                            .most_tilt = 20};
  std::vector<PressingKind> kinds = {phantom, tissue, tilted};
  const auto add = [&](PressingKind kind, const std::string& name, const auto& change) {
    kind.name = name;
    change(kind);
    kinds.push_back(kind);
  };
  add(phantom, "three depths", [](auto& k) { k.depths = 3, k.step = 1.1; });
  add(phantom, "pitch 10 mm", [](auto& k) { k.pitch = 10; });
  add(phantom, "steep inclusion", [](auto& k) { k.contrast = 12, k.width = 4; });
  add(tilted, "tilted 30 degrees", [](auto& k) { k.least_tilt = 25, k.most_tilt = 35; });
  add(phantom, "rounded to 1 um", [](auto& k) { k.position_digit = k.force_digit = 1e-3; });
  add(phantom, "rounded to 0.1 mm, 0.01 N",
      [](auto& k) { k.position_digit = 0.1, k.force_digit = 0.01; });
  add(phantom, "noise 0.12 N", [](auto& k) { k.noise = 0.12; });
  add(phantom, "one depth", [](auto& k) { k.depths = 1, k.step = 2; });
  add(phantom, "no offsets", [](auto& k) { k.bias = k.late = 0; });
  add(phantom, "surface of the places", [](auto& k) { k.known_surface = false; });
  add(tissue, "patchy tissue", [](auto& k) { k.waves = 0.6, k.wavelength = 20; });
  add(phantom, "patchy, 10 mm apart, no offsets",
      [](auto& k) { k.waves = 0.5, k.wavelength = 30, k.pitch = 10, k.bias = k.late = 0; });
  add(tilted, "tilted, pulled across", [](auto& k) { k.dragged = -0.25; });
  add(phantom, "5000 places", [](auto& k) { k.pitch = 0.85; });
  return kinds;
}

PressingSet make_pressing_set(const PressingKind& kind, unsigned seed) {
  PressingSet set;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  const auto noise = [&](double deviation) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Vector3d(deviation * Vector3d(x, y, z));
  };
  const double tilt = uniform(kind.least_tilt, kind.most_tilt) * std::numbers::pi / 180;
  const double azimuth = uniform(0, 2 * std::numbers::pi);
  const Waves waves(kind, seed);
  const Vector3d bias = kind.bias * Vector3d(0.3, -0.5, 0.8);
  const int side = static_cast<int>(kind.side / kind.pitch + 1e-9) + 1;
  double time = 0;
  std::vector<Vector3d> touches;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = -kind.side / 2 + kind.pitch * (column + uniform(-0.2, 0.2));
      const double y = -kind.side / 2 + kind.pitch * (row + uniform(-0.2, 0.2));
      const Vector3d out = outwards(x, y), into = -out;
      const Vector3d across =
          out.cross(Vector3d(std::cos(azimuth), std::sin(azimuth), 0)).normalized();
      const Vector3d push = std::cos(tilt) * into + std::sin(tilt) * across;
      const long long id = row * side + column;
      touches.push_back(
          rounded_to(place(x, y) + uniform(0, kind.late) * into, kind.position_digit));
      set.acquisition.contacts.push_back(
          {.id = id, .position = touches.back(), .normal = rounded_to(out, 1e-4)});
      const auto record = [&](double depth, double share) {
        const double force = share * force_of(kind, waves, x, y, depth);
        probing::Sample sample;
        sample.id = sample.group = static_cast<long long>(set.acquisition.samples.size());
        sample.contact = id;
        Vector3d whole = force * into + bias + noise(kind.noise);
        if (tilt > 0) whole += kind.dragged * force * (push - push.dot(into) * into);
        sample.force = rounded_to(whole, kind.force_digit);
        sample.a = sample.b =
            rounded_to(place(x, y) + depth / push.dot(into) * push + noise(kPositionNoise),
                       kind.position_digit);
        sample.time = time;
        time += kPeriod;
        set.acquisition.samples.push_back(sample);
      };
      for (int d = 1; d <= kind.depths; ++d) record(kind.step * d, 1);
      for (int d = kind.depths; kind.way_back > 0 && d >= 1; --d)
        record(kind.step * d, 1 - kind.way_back);
    }
  }
  set.surface = kind.known_surface ? true_surface(kind) : grid_surface(touches, side);
  for (int q = 0; q < kQueries; ++q) {
    const double reach = kind.side / 2 - 2;
    const double x = uniform(-reach, reach), y = uniform(-reach, reach);
    const double depth = uniform(0.3, std::min(3.4, kind.depths * kind.step));
    const Vector3d into = -outwards(x, y);
    set.truth.push_back({place(x, y), depth * into, force_of(kind, waves, x, y, depth) * into});
  }
  return set;
}

}  // namespace palpate::bench
