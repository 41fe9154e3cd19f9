// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Operations on point clouds against PCL's, each from the same points to its result, search trees
// included. PCL's coordinates are float, ours double.
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/method_types.h>
#include <pcl/sample_consensus/model_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <random>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"
#include "palpate/geometry/cloud_clusters.h"
#include "palpate/geometry/cloud_distance.h"
#include "palpate/geometry/cloud_normals.h"
#include "palpate/geometry/cloud_outliers.h"
#include "palpate/geometry/cloud_sampling.h"
#include "palpate/geometry/cloud_shapes.h"

namespace {

namespace geometry = palpate::geometry;
using Eigen::Matrix3Xd;
using Point = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Point>;
using Tree = pcl::search::KdTree<Point>;

constexpr int kNeighbours = 16;

/// Points of a bumpy surface in the order of a scanner, or in any.
struct Sample {
  Matrix3Xd points;
  Cloud::Ptr cloud{new Cloud};
  double spacing = 0;  ///< [mm] median distance of neighbours

  explicit Sample(const benchmark::State& state)
      : points(geometry::test::bumpy(2 * static_cast<int>(state.range(0)), 0.02).vertices) {
    if (state.range(1) == 1) {
      std::vector<int> order(static_cast<std::size_t>(points.cols()));
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
      std::shuffle(order.begin(), order.end(), std::mt19937(1));
      points = Matrix3Xd(points(Eigen::all, order));
    }
    for (const auto& p : points.colwise()) {
      const Eigen::Vector3f place = p.cast<float>();
      cloud->push_back({place.x(), place.y(), place.z()});
    }
    Eigen::VectorXd nearest = geometry::neighbour_distances(points);
    std::nth_element(nearest.begin(), nearest.begin() + nearest.size() / 2, nearest.end());
    spacing = nearest[nearest.size() / 2];
  }
  [[nodiscard]] Tree::Ptr tree() const {
    Tree::Ptr made(new Tree);
    made->setInputCloud(cloud);
    return made;
  }
};

void voxel_sample(benchmark::State& state) {
  const Sample sample(state);
  const double edge = 4 * sample.spacing;
  Eigen::Index ours = 0;
  Cloud kept;
  palpate::bench::run_paired(
      state, [&] { ours = geometry::voxel_sample(sample.points, edge).points.cols(); },
      [&] {
        pcl::VoxelGrid<Point> grid;
        grid.setInputCloud(sample.cloud);
        const auto leaf = static_cast<float>(edge);
        grid.setLeafSize(leaf, leaf, leaf);
        grid.filter(kept);
      });
  state.counters["ours_voxels"] = static_cast<double>(ours);
  state.counters["peer_voxels"] = static_cast<double>(kept.size());
}

void remove_outliers(benchmark::State& state) {
  const Sample sample(state);
  std::size_t ours = 0;
  Cloud kept;
  palpate::bench::run_paired(
      state,
      [&] {
        ours = geometry::without_outliers(sample.points,
                                          {.neighbours = kNeighbours, .max_deviations = 2})
                   .size();
      },
      [&] {
        pcl::StatisticalOutlierRemoval<Point> filter;
        filter.setInputCloud(sample.cloud);
        filter.setMeanK(kNeighbours);
        filter.setStddevMulThresh(2);
        filter.filter(kept);
      });
  state.counters["ours_kept"] = static_cast<double>(ours);
  state.counters["peer_kept"] = static_cast<double>(kept.size());
}

/// Both use all threads and a viewpoint.
void find_normals(benchmark::State& state) {
  const Sample sample(state);
  palpate::bench::run_paired(
      state,
      [&] {
        benchmark::DoNotOptimize(geometry::cloud_normals(
            sample.points, {.neighbours = kNeighbours, .viewpoints = Eigen::Vector3d(0, 0, 1000)}));
      },
      [&] {
        pcl::NormalEstimationOMP<Point, pcl::Normal> estimation;
        estimation.setInputCloud(sample.cloud);
        estimation.setSearchMethod(sample.tree());
        estimation.setKSearch(kNeighbours);
        estimation.setViewPoint(0, 0, 1000);
        pcl::PointCloud<pcl::Normal> normals;
        estimation.compute(normals);
        benchmark::DoNotOptimize(normals);
      });
}

void find_clusters(benchmark::State& state) {
  const Sample sample(state);
  const double gap = 2 * sample.spacing;
  std::size_t ours = 0;
  std::vector<pcl::PointIndices> clusters;
  palpate::bench::run_paired(
      state, [&] { ours = geometry::cloud_clusters(sample.points, {.max_gap = gap}).sizes.size(); },
      [&] {
        pcl::EuclideanClusterExtraction<Point> extraction;
        extraction.setInputCloud(sample.cloud);
        extraction.setSearchMethod(sample.tree());
        extraction.setClusterTolerance(gap);
        clusters.clear();
        extraction.extract(clusters);
      });
  state.counters["ours_clusters"] = static_cast<double>(ours);
  state.counters["peer_clusters"] = static_cast<double>(clusters.size());
}

/// The plane of half of the points; the others lie around it.
void find_plane(benchmark::State& state) {
  Sample sample(state);
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.05);
  for (Eigen::Index i = 0; i < sample.points.cols(); i += 2) {
    sample.points(2, i) = 0.1 * sample.points(0, i) + noise(random);
    (*sample.cloud)[static_cast<std::size_t>(i)].z = static_cast<float>(sample.points(2, i));
  }
  constexpr double kTolerance = 0.15;
  std::size_t ours = 0;
  pcl::PointIndices inliers;
  palpate::bench::run_paired(
      state,
      [&] {
        const auto plane = geometry::find_plane(sample.points, {.tolerance = kTolerance});
        ours = plane ? plane->inliers.size() : 0;
      },
      [&] {
        pcl::SACSegmentation<Point> segmentation;
        segmentation.setInputCloud(sample.cloud);
        segmentation.setModelType(pcl::SACMODEL_PLANE);
        segmentation.setMethodType(pcl::SAC_RANSAC);
        segmentation.setDistanceThreshold(kTolerance);
        segmentation.setMaxIterations(10000);
        segmentation.setProbability(0.999);
        segmentation.setOptimizeCoefficients(true);
        pcl::ModelCoefficients coefficients;
        segmentation.segment(inliers, coefficients);
      });
  state.counters["ours_inliers"] = static_cast<double>(ours);
  state.counters["peer_inliers"] = static_cast<double>(inliers.indices.size());
}

/// Distances of all points from a part of them.
void measure_distances(benchmark::State& state) {
  const Sample sample(state);
  const Matrix3Xd part = sample.points.leftCols(sample.points.cols() / 4);
  double ours = 0, peer = 0;
  palpate::bench::run_paired(
      state, [&] { ours = geometry::distances_to_cloud(sample.points, part).sum(); },
      [&] {
        const Cloud::Ptr cloud(new Cloud);
        cloud->insert(cloud->end(), sample.cloud->begin(),
                      sample.cloud->begin() + static_cast<std::ptrdiff_t>(part.cols()));
        Tree tree;
        tree.setInputCloud(cloud);
        pcl::Indices nearest(1);
        std::vector<float> squared(1);
        peer = 0;
        for (const Point& point : *sample.cloud) {
          tree.nearestKSearch(point, 1, nearest, squared);
          peer += std::sqrt(static_cast<double>(squared[0]));
        }
      });
  state.counters["ours_mean"] = ours / static_cast<double>(sample.points.cols());
  state.counters["peer_mean"] = peer / static_cast<double>(sample.points.cols());
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"points", "shuffled"})
      ->Args({100'000, 0})
      ->Args({100'000, 1})
      ->Args({500'000, 0})
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(voxel_sample)->Apply(sizes);
BENCHMARK(remove_outliers)->Apply(sizes);
BENCHMARK(find_normals)->Apply(sizes);
BENCHMARK(find_clusters)->Apply(sizes);
BENCHMARK(find_plane)->Apply(sizes);
BENCHMARK(measure_distances)->Apply(sizes);

/// Ours alone: PCL has no sample of this kind, and no normals with one side.
void poisson_sample(benchmark::State& state) {
  const Sample sample(state);
  for (auto _ : state)
    benchmark::DoNotOptimize(geometry::poisson_sample(sample.points, 4 * sample.spacing));
}
void find_outward_normals(benchmark::State& state) {
  const Sample sample(state);
  for (auto _ : state)
    benchmark::DoNotOptimize(geometry::cloud_normals(sample.points, {.neighbours = kNeighbours}));
}
BENCHMARK(poisson_sample)->Apply(sizes);
BENCHMARK(find_outward_normals)->Apply(sizes);

}  // namespace
