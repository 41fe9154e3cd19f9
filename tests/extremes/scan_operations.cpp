// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "operations.h"
#include "palpate/geometry/depth_noise.h"
#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/range_map_cloud.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/range_map_selection.h"
#include "palpate/geometry/range_map_smoothing.h"
#include "palpate/geometry/register_scans.h"
#include "palpate/geometry/registration.h"
#include "palpate/geometry/surface_tracker.h"
#include "palpate/geometry/zipper_scans.h"

namespace palpate::extremes {
namespace {

using namespace geometry;
using Eigen::Vector3d;

/// Two views of the sheet: its triangles left of a line, and those right of another.
std::array<Scan, 2> scans_of(const Input& input) {
  std::array<Scan, 2> scans;
  const Vector3d along = input.place.linear().col(0);
  for (int side = 0; side < 2; ++side) {
    Scan& scan = scans[static_cast<std::size_t>(side)];
    scan.mesh = input.sheet;
    Eigen::Index kept = 0;
    for (Eigen::Index t = 0; t < input.sheet.triangles.cols(); ++t) {
      const Vector3d middle =
          input.sheet.vertices(Eigen::all, input.sheet.triangles.col(t)).rowwise().mean();
      const double x =
          (middle - input.place.translation()).dot(along) / (input.length * input.extent);
      if (side == 0 ? x < 57.1 : x > 26.7)
        scan.mesh.triangles.col(kept++) = input.sheet.triangles.col(t);
    }
    scan.mesh.triangles.conservativeResize(3, kept);
    scan.name = side == 0 ? "left" : "right";
  }
  return scans;
}

Results registration(const Input& input, const Change& change) {
  RegistrationOptions options{.search_rotation = 0.1, .search_translation = 0};
  // Points that are turned and moved a little in the object's own frame.
  Eigen::Isometry3d off = Eigen::Isometry3d::Identity();
  off.linear() = Eigen::AngleAxisd(0.03, Vector3d(0.2, 1, 0.4).normalized()).toRotationMatrix();
  off.translation() = input.length * Vector3d(0.6, -0.3, 0.4);
  off = input.place * off * input.place.inverse();
  change(fields_of(options));
  const Registration found = register_points(off * input.cloud, input.ball, options);
  const Eigen::Matrix3Xd back = found.T_target_source * (off * input.cloud);
  // Fits to a noisy cloud differ by what the refinement leaves.
  constexpr double kLeft = 2e-4;
  const bool is_accepted = found.verdict == RegistrationVerdict::accepted;
  const std::string words = is_accepted ? "" : found.reason;
  return {saying(unknown_allowed(number("rms", found.rms, kLength, 0.03)), words),
          saying(unknown_allowed(places("points", back, &Order::cloud, kLeft)), words),
          number("accepted", is_accepted ? 1 : 0)};
}

Results merging(const Input& input, const Change& change) {
  MergeScansOptions options{.spacing = 4 * input.length, .max_memory = 0.5};
  change(fields_of(options));
  const MergedScans merged = merge_scans(scans_of(input), options);
  return {number("area", surface_area(merged.mesh), kArea, kRoughly),
          number("spacing", merged.spacing, kLength)};
}

Results zippering(const Input& input, const Change&) {
  const ZipperedScans joined = zipper_scans(scans_of(input));
  return {number("area", surface_area(joined.mesh), kArea, kRoughly),
          number("spacing", joined.spacing, kLength, 1e-6)};
}

Results scan_registration(const Input& input, const Change& change) {
  RegistrationOptions options{.search_rotation = 0, .search_translation = 0};
  change(fields_of(options));
  const std::vector<Registration> found = register_scans(scans_of(input), options);
  Eigen::VectorXd rms(static_cast<Eigen::Index>(found.size()));
  for (Eigen::Index i = 0; i < rms.size(); ++i) rms[i] = found[static_cast<std::size_t>(i)].rms;
  // The scans agree exactly: what is left is rounding.
  return {unknown_allowed(numbers("rms", rms, kLength, nullptr, kAnything))};
}

/// A range map of a bump, seen by a camera of its own: it does not move with the object.
RangeMap range_map_of_bump(const Input& input, double shift = 0) {
  RangeMap map;
  const int finer = input.extent, width = 48 * finer, height = 36 * finer;
  map.camera = {.width = width, .height = height, .fx = 60.0 * finer, .fy = 60.0 * finer};
  map.camera.cx = (width - 1) / 2.0;
  map.camera.cy = (height - 1) / 2.0;
  map.z.resize(height, width);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double u = static_cast<double>(column) / finer, v = static_cast<double>(row) / finer;
      const double x = (u - 20 - shift) / 9, y = (v - 16) / 8;
      const double z = 300 - 25 * std::exp(-(x * x + y * y) / 2) + 4 * std::sin(0.3 * u + 0.2 * v);
      map.z(row, column) = static_cast<float>(z * input.length);
    }
  }
  for (int u = 5; u < 8; ++u) map.z.col(u).head(4).setConstant(NAN);
  return map;
}

Results map_mesh(const Input& input, const Change& change) {
  RangeMapMeshOptions options;
  change(fields_of(options));
  const RangeMapMesh found = mesh_range_map(range_map_of_bump(input), options);
  return {number("area", surface_area(found.mesh), kArea),
          number("triangles", static_cast<double>(found.mesh.triangles.cols()))};
}

Results map_smoothing(const Input& input, const Change& change) {
  RangeMapSmoothingOptions options;
  change(fields_of(options));
  const RangeMap map = range_map_of_bump(input);
  const ImageF sigma =
      ImageF::Constant(map.z.rows(), map.z.cols(), static_cast<float>(0.2 * input.length));
  const ImageF smooth = smooth_range_map(map.z, sigma, options);
  return {unknown_allowed(numbers("depths", smooth.cast<double>().reshaped().matrix(), kLength))};
}

Results noise_of_depths(const Input& input, const Change&) {
  const RangeMap map = range_map_of_bump(input);
  std::vector<ImageF> still(6, map.z);
  for (std::size_t k = 0; k < still.size(); ++k) {
    for (Eigen::Index i = 0; i < map.z.size(); ++i) {
      const auto n = static_cast<double>(i + 7 * static_cast<Eigen::Index>(k * k));
      still[k].data()[i] += static_cast<float>(0.3 * input.length * std::sin(n * n));
    }
  }
  const DepthNoise noise = depth_noise(still);
  return {number("deviation", noise.deviation(300 * input.length), kLength)};
}

Results camera_of_cloud(const Input& input, const Change&) {
  const Camera camera = fitted_camera(organised_cloud(range_map_of_bump(input)));
  return {number("fx", camera.fx), number("fy", camera.fy), number("cx", camera.cx),
          number("cy", camera.cy)};
}

Results depth_selection(const Input& input, const Change& change) {
  const RangeMap map = range_map_of_bump(input);
  const double nearest =
      map.z.isNaN().select(std::numeric_limits<float>::infinity(), map.z).minCoeff();
  RangeMapSelectionOptions options{.far = nearest + 27 * input.length,
                                   .remove_plane = 4 * input.length};
  change(fields_of(options));
  const RangeMapSelection selection = select_depths(map, options);
  return {
      unknown_allowed(numbers("depths", selection.z.cast<double>().reshaped().matrix(), kLength)),
      number("too far", static_cast<double>(selection.too_far)),
      number("on the plane", static_cast<double>(selection.on_plane))};
}

Results tracking(const Input& input, const Change& change) {
  TrackingOptions options{.nodes = 30};
  change(fields_of(options));
  SurfaceTracker tracker(options, mesh_range_map(range_map_of_bump(input)).mesh);
  const TrackedSurface found = tracker.track(range_map_of_bump(input, 0.5));
  return {number("found", found.lost.empty() ? 1 : 0),
          unknown_allowed(number("rms", found.figures.rms, kLength)),
          unknown_allowed(number("stretch", found.figures.stretch))};
}

}  // namespace

std::vector<Operation> scan_operations() {
  return {
      {"register_points", kOptions | kCloud | kBall, registration, 0, 1e4, 3},
      {"merge_scans", kOptions | kSheet, merging, 0, 64, 3},
      {"zipper_scans", kSheet, zippering, 0, 64},
      {"register_scans", kOptions | kSheet, scan_registration, 0, 1e4, 3},
      {"mesh_range_map", kOptions | kFrame, map_mesh},
      {"smooth_range_map", kOptions | kFrame, map_smoothing},
      {"depth_noise", kFrame, noise_of_depths},
      {"fitted_camera", kFrame, camera_of_cloud},
      {"select_depths", kOptions | kFrame, depth_selection},
      {"SurfaceTracker", kOptions | kFrame, tracking, 0, 0, 3},
  };
}

}  // namespace palpate::extremes
