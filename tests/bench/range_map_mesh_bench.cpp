// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A range map of 640 x 480 becomes a mesh, beside PCL's mesher of organised clouds. Ours starts
// from depths and a camera; PCL's from points, so that back-projection is timed for both.
#include "palpate/geometry/range_map_mesh.h"

#include <pcl/point_types.h>
#include <pcl/surface/organized_fast_mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"

namespace {

using palpate::geometry::Camera;
using palpate::geometry::ImageF;
using palpate::geometry::RangeMap;

/// The bumpy surface with its holes, noise of 0.25 mm, and a bar 100 mm before it, which cuts it.
RangeMap bumpy_range_map(const Camera& camera) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.25, 0.25);
  RangeMap map{ImageF(camera.height, camera.width), camera};
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const double s = static_cast<double>(col) / (camera.width - 1);
      const double t = 0.75 * row / (camera.height - 1);
      const double bar = std::abs(s - 0.6) < 0.02 ? 100 : 0;
      const bool hole = palpate::geometry::test::in_bumpy_hole(s, t);
      const double depth = palpate::geometry::test::bumpy_depth(s, t) - bar + noise(random);
      map.z(row, col) = hole ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(depth);
    }
  }
  return map;
}

/// PCL's answer: the shorter diagonal, cut where neighbours in one viewing direction lie far apart.
std::vector<pcl::Vertices> mesh_with_pcl(const RangeMap& map) {
  const Eigen::Matrix3Xd points = back_project(map);
  const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>(
      static_cast<std::uint32_t>(map.camera.width), static_cast<std::uint32_t>(map.camera.height)));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    (*cloud)[static_cast<std::size_t>(i)].getVector3fMap() = points.col(i).cast<float>();
  pcl::OrganizedFastMesh<pcl::PointXYZ> mesher;
  mesher.setTriangulationType(pcl::OrganizedFastMesh<pcl::PointXYZ>::TRIANGLE_ADAPTIVE_CUT);
  mesher.setMaxEdgeLength(
      0, static_cast<float>(palpate::geometry::RangeMapMeshOptions{}.max_depth_step));
  mesher.setInputCloud(cloud);
  std::vector<pcl::Vertices> triangles;
  mesher.reconstruct(triangles);
  return triangles;
}

void range_map_mesh_against_pcl(benchmark::State& state, std::array<double, 8> distortion) {
  const RangeMap map = bumpy_range_map({.width = 640,
                                        .height = 480,
                                        .fx = 768,
                                        .fy = 768,
                                        .cx = 319.5,
                                        .cy = 239.5,
                                        .distortion = distortion});
  palpate::geometry::RangeMapMesh ours;
  std::vector<pcl::Vertices> peer;
  const auto run_ours = [&] { ours = palpate::geometry::mesh_range_map(map); };
  const auto run_peer = [&] { peer = mesh_with_pcl(map); };
  run_ours();
  run_peer();
  // Both cut around the bar and the holes, each by its own rule: within a hundredth they agree.
  const auto ours_count = static_cast<double>(ours.mesh.triangles.cols());
  const auto peer_count = static_cast<double>(peer.size());
  if (std::abs(ours_count - peer_count) > 0.01 * peer_count)
    state.SkipWithError("the numbers of triangles differ by more than a hundredth");
  palpate::bench::run_paired(state, run_ours, run_peer);
  state.counters["triangles"] = ours_count;
  state.counters["peer_triangles"] = peer_count;
}
BENCHMARK_CAPTURE(range_map_mesh_against_pcl, pinhole, {})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(range_map_mesh_against_pcl, lens, {-0.28, 0.07, 0.0011, -0.0007, -0.01})
    ->Unit(benchmark::kMillisecond);

}  // namespace
