// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Eight range maps of a sphere on a block with a step become one surface, beside VDBFusion's method
// on OpenVDB, on one thread. Both start from range maps. Errors are distances of the vertices from
// the analytic surface [mm].
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "paired.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/range_map_mesh.h"
#include "scan_fusion_peers.h"

namespace {

using Eigen::Vector3d;
using namespace palpate::geometry;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadius = 28;       // [mm]
const Vector3d kCentre(-16, 0, 45);  // of the sphere, which sinks into the block by 3 mm
constexpr double kTruncation = 3;    // [voxels], the default of MergeScansOptions::reach
constexpr double kDistance = 400, kPixel = 0.63;  // [mm] of the cameras, and a pixel there
constexpr double kSmooth = 4;  // [mm] vertices this far from edges are on smooth parts

struct Box {
  Vector3d centre, half;
};
/// The block and its step, one inside the other as far as both go.
const std::array<Box, 2> kBoxes = {
    {{Vector3d(0, 0, 10), Vector3d(55, 38, 10)}, {Vector3d(36, 0, 16), Vector3d(19, 38, 16)}}};

Eigen::Array3d beyond(const Box& box, const Vector3d& p) {
  return (p - box.centre).array().abs() - box.half.array();
}

double distance_to(const Box& box, const Vector3d& p) {
  const Eigen::Array3d q = beyond(box, p);
  return q.max(0).matrix().norm() + std::min(q.maxCoeff(), 0.0);
}

double distance_to_sphere(const Vector3d& p) { return (p - kCentre).norm() - kRadius; }

/// [mm] from the object, negative inside.
double distance_to_object(const Vector3d& p) {
  return std::min({distance_to_sphere(p), distance_to(kBoxes[0], p), distance_to(kBoxes[1], p)});
}

/// Returns true if only one smooth surface is near.
bool is_on_smooth_part(const Vector3d& p) {
  Eigen::Index near = std::abs(distance_to_sphere(p)) < kSmooth ? 1 : 0;
  for (const Box& box : kBoxes) {
    if (distance_to(box, p) < kSmooth) near += (beyond(box, p).abs() < kSmooth).count();
  }
  return near == 1;
}

/// First crossing of a ray from outside; infinite if there is none.
double first_crossing(const Vector3d& eye, const Vector3d& along) {
  double nearest = kInfinity;
  const Vector3d to_centre = kCentre - eye;
  const double middle = along.dot(to_centre) / along.squaredNorm();
  const double inside = (kRadius * kRadius - (to_centre - middle * along).squaredNorm());
  if (inside > 0) nearest = middle - std::sqrt(inside / along.squaredNorm());
  for (const Box& box : kBoxes) {
    const Eigen::Array3d a = (box.centre - box.half - eye).array() / along.array();
    const Eigen::Array3d b = (box.centre + box.half - eye).array() / along.array();
    const double enters = a.min(b).maxCoeff();
    if (enters < a.max(b).minCoeff()) nearest = std::min(nearest, enters);
  }
  return nearest;
}

struct View {
  RangeMap map;
  Eigen::Isometry3d T_object_camera;
};

/// The views of cameras around the object, with normal noise [mm] along their axes.
std::vector<View> views_of_object(double noise) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, noise);
  std::vector<View> views;
  for (int i = 0; i < 8; ++i) {
    const double angle = (i + 0.3) * std::numbers::pi / 4;
    const Vector3d from =
        Vector3d(std::cos(angle), std::sin(angle), i % 2 == 0 ? 1.4 : 0.5).normalized();
    View view;
    view.map.camera = {.width = 320,
                       .height = 240,
                       .fx = kDistance / kPixel,
                       .fy = kDistance / kPixel,
                       .cx = 159.5,
                       .cy = 119.5};
    view.map.z = ImageF::Constant(240, 320, std::numeric_limits<float>::quiet_NaN());
    view.T_object_camera = Eigen::Translation3d(kDistance * from + Vector3d(0, 0, 25)) *
                           Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), -from);
    const Eigen::Matrix2Xd rays = pixel_rays(view.map.camera);
    for (Eigen::Index pixel = 0; pixel < rays.cols(); ++pixel) {
      const double depth =
          first_crossing(view.T_object_camera.translation(),
                         view.T_object_camera.linear() * rays.col(pixel).homogeneous());
      if (depth < kInfinity)
        view.map.z.reshaped<Eigen::RowMajor>()[pixel] = static_cast<float>(depth + normal(random));
    }
    views.push_back(view);
  }
  return views;
}

TriangleMesh fuse(const std::vector<View>& views, double voxel) {
  std::vector<Scan> scans;
  for (const View& view : views) {
    scans.push_back({.mesh = mesh_range_map(view.map).mesh,
                     .T_object_scan = view.T_object_camera,
                     .viewpoint = Vector3d::Zero()});
  }
  return merge_scans(scans, {.spacing = voxel, .reach = kTruncation}).mesh;
}

TriangleMesh fuse_by_peer(const std::vector<View>& views, double voxel) {
  std::vector<palpate::bench::SeenPoints> seen;
  for (const View& view : views) {
    const Eigen::Matrix3Xd all = back_project(view.map);
    std::vector<Eigen::Index> known;
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
      if (all(2, i) > 0) known.push_back(i);
    }
    const Eigen::Matrix3Xd points = all(Eigen::all, known);
    seen.push_back(
        {.points = view.T_object_camera * points, .eye = view.T_object_camera.translation()});
  }
  return palpate::bench::fuse_with_openvdb(seen, voxel, kTruncation * voxel);
}

void report_errors(benchmark::State& state, const TriangleMesh& mesh, const std::string& whose) {
  std::vector<double> all, smooth;
  for (const auto& p : mesh.vertices.colwise()) {
    all.push_back(std::abs(distance_to_object(p)));
    if (is_on_smooth_part(p)) smooth.push_back(all.back());
  }
  std::ranges::sort(all);
  state.counters[whose + "_rms"] = error_statistics(all).rms;
  state.counters[whose + "_p99"] = all[all.size() * 99 / 100];
  state.counters[whose + "_smooth_rms"] = error_statistics(smooth).rms;
  state.counters[whose + "_vertices"] = static_cast<double>(all.size());
}

void fusion_against_openvdb(benchmark::State& state, double voxel, double noise) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<View> views = views_of_object(noise);
  TriangleMesh ours, peer;
  palpate::bench::run_paired<palpate::bench::ProcessorClock>(
      state, [&] { ours = fuse(views, voxel); }, [&] { peer = fuse_by_peer(views, voxel); });
  report_errors(state, ours, "ours");
  report_errors(state, peer, "peer");
  double depths = 0;
  for (const View& view : views) depths += static_cast<double>((view.map.z > 0).count());
  state.counters["depths"] = depths;
}
BENCHMARK_CAPTURE(fusion_against_openvdb, voxel_05_noise_02, 0.5, 0.2)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fusion_against_openvdb, voxel_1_noise_03, 1, 0.3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fusion_against_openvdb, voxel_1_noise_05, 1, 0.5)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fusion_against_openvdb, voxel_1_noise_10, 1, 1.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fusion_against_openvdb, voxel_2_noise_03, 2, 0.3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fusion_against_openvdb, voxel_2_noise_10, 2, 1.0)->Unit(benchmark::kMillisecond);

}  // namespace
