// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Writes the bundled sequence of a depth camera, demo/depth_sequence, as docs/depth-camera.md uses
// it: `depth_camera_sequence FOLDER`. A soft cushion on a table rests for four frames, and then
// rises and leans over. A camera like a small RealSense D435 looks down at it at 45 degrees; a wall
// stands behind. Depths have noise that grows with the square of the distance, are lost where the
// second imager does not see the surface, and mix at edges. Frame 7 is lost. truth/ has the surface
// of the cushion without noise, with the same triangles in each frame.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>
#include <ostream>
#include <random>
#include <utility>
#include <vector>

#include "palpate/core/output_file.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/sensing/frame.h"
#include "range_map_scene.h"
#include "test_surfaces.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::TriangleMesh;

constexpr int kFrames = 13, kStill = 4, kLost = 7;
constexpr std::array kTrueFrames{0, 8, 12};
constexpr double kDistance = 450;     // mm, of the middle of the table
constexpr double kNoise = 0.4;        // mm, at this distance
constexpr double kColourNoise = 1.5;  // grey levels
constexpr double kBaseline = 50;      // mm, between the imagers
constexpr double kTwoPi = 2 * std::numbers::pi;
const Vector3d kHalfAxes(75, 60, 50);  // mm, of the cushion

geometry::Camera camera() {
  return {.width = 200, .height = 150, .fx = 260, .fy = 260, .cx = 99.5, .cy = 74.5};
}

/// Maps right, away and up on the table to the frame of the camera.
Eigen::Isometry3d table() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double c = std::sqrt(0.5);
  pose.linear() << 1, 0, 0, 0, -c, -c, 0, c, -c;
  pose.translation() = Vector3d(0, 0, kDistance);
  return pose;
}

/// The position of a point of the cushion on the table.
Vector3d place(const Vector3d& rest, int frame) {
  const double share = std::max(0, frame - kStill + 1) / double{kFrames - kStill};
  const double s = (1 - std::cos(std::numbers::pi * share)) / 2;
  return {rest.x() * (1 + 0.05 * s) + 0.35 * s * rest.z(), rest.y(), rest.z() * (1 + 0.2 * s)};
}

TriangleMesh cushion_at_rest(int levels) {
  TriangleMesh mesh = geometry::test::icosphere(levels, 1);
  mesh.vertices = kHalfAxes.asDiagonal() * mesh.vertices;
  return mesh;
}

TriangleMesh moved(const TriangleMesh& rest, int frame) {
  return geometry::test::deformed(
      rest, [&](const Vector3d& p) -> Vector3d { return table() * place(p, frame); });
}

/// A rectangle of two triangles.
TriangleMesh rectangle(const Vector3d& corner, const Vector3d& right, const Vector3d& up) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << corner, corner + right, corner + right + up, corner + up;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 2, 3;
  return mesh;
}

TriangleMesh scene_of(const TriangleMesh& cushion) {
  const Eigen::Isometry3d pose = table();
  const TriangleMesh top = rectangle(pose * Vector3d(-150, -120, 0), pose.linear().col(0) * 300,
                                     pose.linear().col(1) * 240);
  const TriangleMesh wall =
      rectangle(Vector3d(-1500, -1500, 900), Vector3d(3000, 0, 0), Vector3d(0, 3000, 0));
  return geometry::test::together(geometry::test::together(cushion, top), wall);
}

/// A texture in three colours: waves of random directions and phases, with wave lengths of 10 to
/// 40 mm, around a mean of each colour.
class Texture {
 public:
  Texture(const Vector3d& mean, double rms, unsigned seed) : mean_(mean) {
    constexpr int kWaves = 30;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < kWaves; ++i) {
      const double angle = std::numbers::pi * (i + uniform(random)) / kWaves;
      const double length = 10 * std::pow(4, uniform(random));
      waves_.push_back({kTwoPi / length * Vector2d(std::cos(angle), std::sin(angle)),
                        kTwoPi * Vector3d{uniform(random), uniform(random), uniform(random)}});
    }
    amplitude_ = rms * std::sqrt(2.0 / kWaves);
  }

  /// Blue, green, red.
  [[nodiscard]] Vector3d at(const Vector2d& place) const {
    Vector3d sum = Vector3d::Zero();
    for (const Wave& wave : waves_)
      sum += (wave.phase.array() * 0.15 + wave.number.dot(place) + wave.phase[0]).sin().matrix();
    return mean_ + amplitude_ * sum;
  }

 private:
  struct Wave {
    Vector2d number;  // rad/mm
    Vector3d phase;
  };
  std::vector<Wave> waves_;
  Vector3d mean_;
  double amplitude_;
};

class Shot {
 public:
  explicit Shot(int frame)
      : frame_(frame),
        rest_(cushion_at_rest(6)),
        scene_(scene_of(moved(rest_, frame))),
        query_(scene_) {}

  void write(const fs::path& folder) const {
    const geometry::Camera lens = camera();
    cv::Mat1w depth(lens.height, lens.width, std::uint16_t{0});
    cv::Mat3b color(lens.height, lens.width, cv::Vec3b(0, 0, 0));
    parallel_for(lens.height, [&](int row) {
      std::mt19937 random(1000003U + static_cast<unsigned>(frame_ * 1000 + row));
      std::normal_distribution<double> normal(0, 1);
      for (int column = 0; column < lens.width; ++column) {
        const double z = measured(column, row, random);
        if (z > 0) depth(row, column) = static_cast<std::uint16_t>(std::lround(z));
        const Vector3d light = seen_color(column, row);
        for (int i = 0; i < 3; ++i) {
          color(row, column)[i] = static_cast<std::uint8_t>(
              std::clamp(std::round(light[i] + kColourNoise * normal(random)), 0.0, 255.0));
        }
      }
    });
    const std::string name = fmt::format("{:06}.png", frame_);
    sensing::write_png(folder / "depth" / name, depth);
    sensing::write_png(folder / "color" / name, color);
  }

 private:
  [[nodiscard]] std::optional<geometry::SegmentHit> hit(double column, double row) const {
    const geometry::Camera lens = camera();
    const Vector3d ray((column - lens.cx) / lens.fx, (row - lens.cy) / lens.fy, 1);
    return query_.first_hit(Vector3d::Zero(), 4 * kDistance * ray);
  }

  [[nodiscard]] bool is_seen_twice(const Vector3d& point) const {
    constexpr double kBeside = 3;  // mm, of what is seen instead
    const Vector3d other(-kBaseline, 0, 0);
    const auto first = query_.first_hit(other, other + 1.1 * (point - other));
    return first && (first->position - point).norm() < kBeside;
  }

  /// [mm] 0 where the camera measures nothing. A pixel that shows two surfaces has half a chance to
  /// show neither, and else is somewhere between.
  double measured(int column, int row, std::mt19937& random) const {
    constexpr double kStep = 12, kHalf = 0.4;  // mm; pixels from the middle of one
    std::normal_distribution<double> normal(0, 1);
    std::uniform_real_distribution<double> uniform(0, 1);
    const double noise = normal(random), chance = uniform(random);
    const auto middle = hit(column, row);
    if (!middle || !is_seen_twice(middle->position)) return 0;
    double low = middle->position.z(), high = low, sum = low;
    for (const auto& [dx, dy] :
         {std::pair{-kHalf, 0.0}, {kHalf, 0.0}, {0.0, -kHalf}, {0.0, kHalf}}) {
      const auto side = hit(column + dx, row + dy);
      if (!side) return 0;
      low = std::min(low, side->position.z());
      high = std::max(high, side->position.z());
      sum += side->position.z();
    }
    double z = middle->position.z();
    if (high - low > kStep) {
      if (chance < 0.5) return 0;
      z = sum / 5;
    }
    return z + kNoise * (z / kDistance) * (z / kDistance) * noise;
  }

  [[nodiscard]] Vector3d seen_color(int column, int row) const {
    static const Texture cushion(Vector3d(90, 105, 150), 22, 5), wood(Vector3d(95, 130, 160), 4, 6);
    const auto found = hit(column, row);
    if (!found) return Vector3d::Zero();
    const Eigen::Vector3i corners = scene_.triangles.col(found->at.triangle);
    Vector3d albedo(170, 175, 178);  // of the wall
    if (corners.maxCoeff() < rest_.vertices.cols()) {
      const Vector3d rest = rest_.vertices(Eigen::all, corners) * found->at.barycentric;
      albedo = cushion.at(rest.head<2>());
    } else if (corners.maxCoeff() < rest_.vertices.cols() + 4) {
      albedo = wood.at((table().inverse() * found->position).head<2>());
    }
    const Vector3d a = scene_.vertices.col(corners[0]), b = scene_.vertices.col(corners[1]),
                   c = scene_.vertices.col(corners[2]);
    const Vector3d lamp(-150, -400, 100);
    const double lit =
        std::abs((b - a).cross(c - a).normalized().dot((found->position - lamp).normalized()));
    return (0.4 + 0.6 * lit) * albedo;
  }

  int frame_;
  TriangleMesh rest_, scene_;
  geometry::SurfaceQuery query_;
};

/// The part of the cushion above the table.
TriangleMesh cushion_above_table() {
  const TriangleMesh whole = cushion_at_rest(4);
  TriangleMesh upper;
  std::vector<int> number(static_cast<std::size_t>(whole.vertices.cols()), -1), kept;
  std::vector<Eigen::Vector3i> triangles;
  for (Eigen::Index t = 0; t < whole.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = whole.triangles.col(t);
    if ((whole.vertices(2, corners).array() < 0).all()) continue;
    Eigen::Vector3i renumbered;
    for (int i = 0; i < 3; ++i) {
      int& n = number[static_cast<std::size_t>(corners[i])];
      if (n < 0) {
        n = static_cast<int>(kept.size());
        kept.push_back(corners[i]);
      }
      renumbered[i] = n;
    }
    triangles.push_back(renumbered);
  }
  upper.vertices = whole.vertices(Eigen::all, kept);
  upper.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    upper.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  return upper;
}

void write_sequence(const fs::path& folder) {
  for (const char* part : {"depth", "color", "truth"}) fs::create_directories(folder / part);
  for (int frame = 0; frame < kFrames; ++frame)
    if (frame != kLost) Shot(frame).write(folder);
  for (const int frame : kTrueFrames) {
    geometry::write_mesh(folder / "truth" / fmt::format("{:06}.ply", frame),
                         moved(cushion_above_table(), frame));
  }
  const geometry::Camera lens = camera();
  const std::string intrinsics = fmt::format(
      "{{\n  \"width\": {},\n  \"height\": {},\n  \"ppx\": {},\n  \"ppy\": {},\n  \"fx\": {},\n"
      "  \"fy\": {},\n  \"model\": \"distortion.brown_conrady\",\n"
      "  \"coeffs\": [0.0, 0.0, 0.0, 0.0, 0.0]\n}}\n",
      lens.width, lens.height, lens.cx, lens.cy, lens.fx, lens.fy);
  write_file(folder / "camera.json", [&](std::ostream& out) { out << intrinsics; });
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "depth_camera_sequence FOLDER: writes the sequence into a folder\n");
    return 2;
  }
  palpate::write_sequence(argv[1]);
}
