// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Accuracy of tracked points of a surface, for docs/non-rigid-tracking.md. Surfaces that deform by
// closed formulas are seen as depth images (640 x 480 at 700 mm, noise of 0.5 mm), with or without
// a texture, tracked from the first image on, and compared with the true place of each
// material point. `tracking_truth 0.03 breathing dent` does that with a stiffness of 0.03 and
// the sequences of these names, `tracking_truth` with the default and all of them.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/surface_tracker.h"
#include "range_map_scene.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kFrames = 12;
constexpr double kNoise = 0.5;           // mm
constexpr double kDistance = 700;        // mm
constexpr double kIntensityNoise = 1.5;  // grey levels
constexpr double kTwoPi = 2 * std::numbers::pi;

/// A sum of waves over x and y.
class Waves {
 public:
  /// Waves of random directions and phases, with an RMS of `rms`.
  Waves(int count, double shortest, double longest, double rms, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < count; ++i) {
      const double angle = std::numbers::pi * (i + uniform(random)) / count;
      const double length = shortest * std::pow(longest / shortest, uniform(random));
      waves_.push_back(
          {kTwoPi / length * Vector2d(std::cos(angle), std::sin(angle)), kTwoPi * uniform(random)});
    }
    amplitude_ = rms * std::sqrt(2.0 / count);
  }

  [[nodiscard]] double at(const Vector2d& place) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.number.dot(place) + wave.phase);
    return amplitude_ * sum;
  }

 private:
  struct Wave {
    Vector2d number;  // rad/mm
    double phase;
  };
  std::vector<Wave> waves_;
  double amplitude_;
};

/// Relief of +-`height`, of which each wave has `length`.
Waves relief(double height, double length, unsigned seed) {
  return {2, length, length, height / 2, seed};
}

struct Sequence {
  std::string name;
  TriangleMesh rest;  ///< fine, in the first frame
  std::function<Vector3d(const Vector3d& rest, int frame)> place;
  bool has_texture = false;
  bool has_tool = false;  ///< a rod stands on the middle after the first frame
  unsigned seed = 1;
};

/// Moves the vertices of a surface along its normals.
TriangleMesh with_relief(TriangleMesh mesh, const Waves& waves) {
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Vector2d place = mesh.vertices.col(v).head<2>();
    mesh.vertices.col(v) += waves.at(place) * normals.col(v);
  }
  return mesh;
}

TriangleMesh ellipsoid(const Vector3d& half_axes) {
  TriangleMesh mesh = test::icosphere(7, 1);
  mesh.vertices = (half_axes.asDiagonal() * mesh.vertices).colwise() + Vector3d(0, 0, kDistance);
  return mesh;
}

/// A plane across the optical axis, facing the camera.
TriangleMesh plate(double width, double height) {
  constexpr double kStep = 0.7;  // mm
  TriangleMesh mesh =
      test::flat_sheet(static_cast<int>(width / kStep), static_cast<int>(height / kStep), kStep);
  mesh.vertices.colwise() += Vector3d(-width / 2, -height / 2, kDistance);
  mesh.triangles.row(0).swap(mesh.triangles.row(1));
  return mesh;
}

/// Grows and shrinks about its middle, by `growth` along each axis.
auto breathing(const Vector3d& growth) {
  return [growth](const Vector3d& rest, int frame) -> Vector3d {
    const Vector3d scale = Vector3d::Ones() + std::sin(kTwoPi * frame / kFrames) * growth;
    const Vector3d middle(0, 0, kDistance);
    return middle + scale.cwiseProduct(rest - middle);
  };
}

/// Rolls up about y to a radius, and twists about x, more from frame to frame.
auto bending(double radius, double twist) {
  return [=](const Vector3d& rest, int frame) -> Vector3d {
    const double share = frame / (kFrames - 1.0);
    if (share == 0) return rest;
    const double r = radius / share, angle = rest.x() / r, height = r - (rest.z() - kDistance);
    const Vector3d bent(height * std::sin(angle), rest.y(), r - height * std::cos(angle));
    const double turn = share * twist * rest.x() / 100;
    return Vector3d(0, 0, kDistance) + Eigen::AngleAxisd(turn, Vector3d::UnitX()) * bent;
  };
}

/// Waves that run along x without stretching: the slope is a sine of the length of arc.
auto waving(double slope, double length) {
  return [=](const Vector3d& rest, int frame) -> Vector3d {
    constexpr int kSteps = 200;
    const double amplitude = slope * std::min(1.0, frame / 4.0), ds = rest.x() / kSteps;
    double x = 0, z = kDistance;
    double angle = 0;
    for (int i = 0; i < kSteps; ++i) {
      angle = amplitude * std::sin(kTwoPi * ((i + 0.5) * ds / length - frame / 14.0));
      x += std::cos(angle) * ds;
      z += std::sin(angle) * ds;
    }
    const double above = rest.z() - kDistance;
    return {x - above * std::sin(angle), rest.y(), z + above * std::cos(angle)};
  };
}

/// A dent in a soft block.
auto dented(double depth, double width) {
  return [=](const Vector3d& rest, int frame) -> Vector3d {
    const double share = frame / (kFrames - 1.0);
    const double r2 = rest.head<2>().squaredNorm() / (width * width);
    return rest + Vector3d(0, 0, share * depth * std::exp(-r2 / 2));
  };
}

/// Depths and intensities of a frame.
struct Picture {
  RangeMap map;
  ImageF intensity;
};

Camera camera() {
  return {.width = 640, .height = 480, .fx = 600, .fy = 600, .cx = 319.5, .cy = 239.5};
}

/// The texture is lit from the camera, by a lamp that is not steady.
Picture picture_of(const Sequence& sequence, const TriangleMesh& moved, int frame) {
  const Waves texture(40, 5, 25, 25, sequence.seed + 50);
  TriangleMesh scene = moved;
  if (sequence.has_tool && frame > 0) {
    const Vector3d tip = sequence.place({0, 0, kDistance}, frame);
    scene = test::together(moved, test::rod(tip, tip + Vector3d(-60, -90, -150), 4));
  }
  const SurfaceQuery query(scene);
  const Eigen::Matrix2Xd rays = pixel_rays(camera());
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  const ImageF none = ImageF::Constant(camera().height, camera().width, unknown);
  Picture picture{{none, camera()}, none};
  parallel_for(camera().height, [&](int row) {
    std::mt19937 random(sequence.seed * 1000003 + static_cast<unsigned>(frame * 1000 + row));
    std::normal_distribution<double> normal(0, 1);
    for (int col = 0; col < camera().width; ++col) {
      const Vector3d ray = rays.col(row * camera().width + col).homogeneous();
      const auto hit = query.first_hit(Vector3d::Zero(), 2 * kDistance * ray);
      if (!hit) continue;
      picture.map.z(row, col) = static_cast<float>(hit->position.z() + kNoise * normal(random));
      double albedo = 60;
      const Eigen::Vector3i corners = scene.triangles.col(hit->at.triangle);
      if (corners.maxCoeff() < sequence.rest.vertices.cols()) {
        const Vector3d rest = sequence.rest.vertices(Eigen::all, corners) * hit->at.barycentric;
        albedo = 120 + texture.at(rest.head<2>());
      }
      const Vector3d a = scene.vertices.col(corners[0]), b = scene.vertices.col(corners[1]),
                     c = scene.vertices.col(corners[2]);
      const double shade =
          std::abs((b - a).cross(c - a).normalized().dot(hit->position.normalized()));
      const double lamp = 1 + 0.1 * std::sin(2.0 * frame);
      picture.intensity(row, col) = static_cast<float>(std::clamp(
          std::round(lamp * shade * albedo + kIntensityNoise * normal(random)), 0.0, 255.0));
    }
  });
  return picture;
}

std::vector<Sequence> sequences() {
  const Vector3d organ(90, 70, 60), other_organ(75, 60, 50);
  const Vector3d growth(0.08, 0.08, 0.08), other_growth(0.07, 0.04, 0.05);
  const TriangleMesh sheet = plate(200, 150);
  return {
      {"breathing", with_relief(ellipsoid(organ), relief(2, 35, 1)), breathing(growth)},
      {"bending", with_relief(sheet, relief(2, 35, 2)), bending(250, 0.3)},
      {"dent", with_relief(sheet, relief(2, 35, 3)), dented(15, 20), false, true},
      {"waving", with_relief(sheet, relief(2, 35, 4)), waving(0.4, 110)},
      {"smooth-breathing", ellipsoid(organ), breathing(growth)},
      {"smooth-waving", sheet, waving(0.4, 110)},
      {"textured-breathing", ellipsoid(organ), breathing(growth), true},
      {"textured-bending", sheet, bending(250, 0.3), true},
      {"textured-dent", sheet, dented(15, 20), true, true},
      {"textured-waving", sheet, waving(0.4, 110), true},
      // Not used for tuning.
      {"other-breathing", with_relief(ellipsoid(other_organ), relief(1.6, 28, 11)),
       breathing(other_growth), false, false, 12},
      {"other-waving", with_relief(plate(180, 180), relief(2.2, 30, 13)), waving(0.5, 140), false,
       false, 14},
      {"other-textured", ellipsoid(other_organ), breathing(other_growth), true, false, 15},
  };
}

/// The true positions of the vertices of the reference on the fine surface.
class Truth {
 public:
  Truth(const Sequence& sequence, const Eigen::Matrix3Xd& reference)
      : sequence_(sequence), on_(closest_points(SurfaceQuery(sequence.rest), reference)) {
    const Eigen::Matrix3Xd normals = vertex_normals(sequence.rest);
    above_.resize(reference.cols());
    for (Eigen::Index v = 0; v < reference.cols(); ++v)
      above_[v] =
          interpolated(normals, v).normalized().dot(reference.col(v) - on_.positions.col(v));
  }

  [[nodiscard]] TriangleMesh surface(int frame) const {
    return test::deformed(sequence_.rest,
                          [&](const Vector3d& rest) { return sequence_.place(rest, frame); });
  }

  /// Distance of a vertex from its place, across the surface and along it. Across it, noise of the
  /// reference is no error.
  struct Error {
    double across, along;
  };
  [[nodiscard]] Error error(const TriangleMesh& surface, const Eigen::Matrix3Xd& normals,
                            const Eigen::Matrix3Xd& found, Eigen::Index v) const {
    const Vector3d normal = interpolated(normals, v).normalized();
    const Vector3d off = found.col(v) - interpolated(surface.vertices, v);
    return {off.dot(normal) - above_[v], (off - off.dot(normal) * normal).norm()};
  }

 private:
  [[nodiscard]] Vector3d interpolated(const Eigen::Matrix3Xd& values, Eigen::Index v) const {
    return values(Eigen::all, sequence_.rest.triangles.col(on_.triangles[v])) *
           on_.barycentric.col(v);
  }

  const Sequence& sequence_;
  ClosestPoints on_;
  Eigen::VectorXd above_;
};

void print_row(const Sequence& sequence, const TrackingOptions& options) {
  const Picture first = picture_of(sequence, sequence.rest, 0);
  const TriangleMesh reference = mesh_range_map(first.map).mesh;
  const Truth truth(sequence, reference.vertices);
  SurfaceTracker tracker(options, reference);
  std::vector<double> across, along, moved, sigma_across, sigma_along;
  std::string lost;
  double seconds = 0;
  int steps = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const TriangleMesh surface = truth.surface(frame);
    const Picture picture = picture_of(sequence, surface, frame);
    const std::clock_t start = std::clock();
    const TrackedSurface found =
        tracker.track(picture.map, {}, sequence.has_texture ? picture.intensity : ImageF());
    seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    steps += found.figures.iterations;
    if (!found.lost.empty()) lost += fmt::format(" {}", frame);
    if (!found.lost.empty() || frame == 0) continue;
    const Eigen::Matrix3Xd normals = vertex_normals(surface);
    for (Eigen::Index v = 0; v < reference.vertices.cols(); ++v) {
      if (found.surface.sight[static_cast<std::size_t>(v)] != VertexSight::seen) continue;
      const Truth::Error error = truth.error(surface, normals, found.surface.vertices, v);
      across.push_back(std::abs(error.across));
      along.push_back(error.along);
      moved.push_back(truth.error(surface, normals, reference.vertices, v).along);
      sigma_across.push_back(found.surface.sigma_across[v]);
      sigma_along.push_back(found.surface.sigma_along[v]);
    }
  }
  fmt::print(
      "| {} | {:.2f} | {:.2f}; {:.2f} | {:.2f} | {:.2f} | {:.2f}; {:.2f} | {:.2f} | {:.2f} | "
      "{:.2f} "
      "| {:.0f} |{}\n",
      sequence.name, quantile(moved, 0.5), quantile(across, 0.5), quantile(across, 0.95),
      quantile(sigma_across, 0.5),
      error_statistics(across).rms / error_statistics(sigma_across).rms, quantile(along, 0.5),
      quantile(along, 0.95), quantile(sigma_along, 0.5),
      error_statistics(along).rms / error_statistics(sigma_along).rms, seconds / kFrames,
      static_cast<double>(steps) / kFrames, lost.empty() ? "" : " lost:" + lost);
  std::fflush(stdout);
}

}  // namespace
}  // namespace palpate::geometry

int main(int argc, char** argv) {
  using namespace palpate::geometry;
  std::vector<std::string> wanted(argv + 1, argv + argc);
  TrackingOptions options;
  if (!wanted.empty() && std::isdigit(wanted.front().front()) != 0) {
    options.stiffness = std::stod(wanted.front());
    wanted.erase(wanted.begin());
  }
  fmt::print(
      "| sequence | motion along [mm] | error across: median; 95 % [mm] | stated [mm] | quotient "
      "of "
      "RMS | error along: median; 95 % [mm] | stated [mm] | quotient of RMS | processor time a "
      "frame "
      "[s] | steps a frame |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Sequence& sequence : sequences()) {
    if (wanted.empty() || std::ranges::find(wanted, sequence.name) != wanted.end())
      print_row(sequence, options);
  }
}
