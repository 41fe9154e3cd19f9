// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Registration of points onto a range map against PCL's iterated closest points, search trees of
// both made before. PCL starts from where the points are; ours searches, settles and judges.
#include "palpate/geometry/registration.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include "mesh_corpus.h"
#include "paired.h"

namespace {

namespace geometry = palpate::geometry;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using geometry::RegistrationMethod;
using geometry::TriangleMesh;
using Point = pcl::PointNormal;
using Cloud = pcl::PointCloud<Point>;

/// [mm] a pose is right if the points lie this near to their places, on average.
constexpr double kRight = 1;

struct Scan {
  Matrix3Xd truth;
  Matrix3Xd points;  ///< moved
};

/// Points of the surface with uniform noise, turned about their centroid and shifted.
Scan make_scan(const TriangleMesh& mesh, int count, double noise, double degrees, double shift,
               unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  Scan scan{.truth = Matrix3Xd(3, count), .points = {}};
  for (auto point : scan.truth.colwise()) {
    const Vector3d weights{uniform(random), uniform(random), uniform(random)};
    point = position(mesh, {.triangle = any(random), .barycentric = weights / weights.sum()});
    for (double& x : point) x += noise * (2 * uniform(random) - 1);
  }
  const Vector3d centre = scan.truth.rowwise().mean();
  const Vector3d axis{normal(random), normal(random), normal(random)};
  const Vector3d way{normal(random), normal(random), normal(random)};
  const Isometry3d motion = Eigen::Translation3d(centre + shift * way.normalized()) *
                            Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()) *
                            Eigen::Translation3d(-centre);
  scan.points = motion * scan.truth;
  return scan;
}

/// PCL's two methods on the vertices of a mesh.
class Peer {
 public:
  explicit Peer(const TriangleMesh& mesh) {
    const Matrix3Xd normals = geometry::vertex_normals(mesh);
    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      cloud_->push_back(to_point(mesh.vertices.col(v), normals.col(v)));
    }
    tree_->setInputCloud(cloud_);
  }
  [[nodiscard]] Isometry3d align(const Matrix3Xd& points, bool to_planes, int& iterations) const {
    return to_planes
               ? align_with<pcl::IterativeClosestPointWithNormals<Point, Point>>(points, iterations)
               : align_with<pcl::IterativeClosestPoint<Point, Point>>(points, iterations);
  }

 private:
  template <typename Icp>
  struct Counting : Icp {
    [[nodiscard]] int iterations() const { return this->nr_iterations_; }
  };
  template <typename Icp>
  [[nodiscard]] Isometry3d align_with(const Matrix3Xd& points, int& iterations) const {
    const Cloud::Ptr source(new Cloud);
    for (const auto& point : points.colwise())
      source->push_back(to_point(point, Vector3d::UnitZ()));
    Counting<Icp> icp;
    icp.setSearchMethodTarget(tree_, true);
    icp.setInputTarget(cloud_);
    icp.setInputSource(source);
    icp.setMaximumIterations(100);
    // [mm^2] of the last step, and one minus the cosine of its turn: a micrometre, and what that is
    // half a metre away.
    icp.setTransformationEpsilon(1e-6);
    icp.setTransformationRotationEpsilon(1 - 1e-11);
    Cloud moved;
    icp.align(moved);
    iterations += icp.iterations();
    return Isometry3d(icp.getFinalTransformation().template cast<double>());
  }
  static Point to_point(const Vector3d& place, const Vector3d& normal) {
    Point point;
    point.getVector3fMap() = place.cast<float>();
    point.getNormalVector3fMap() = normal.cast<float>();
    return point;
  }

  Cloud::Ptr cloud_{new Cloud};
  pcl::search::KdTree<Point>::Ptr tree_{new pcl::search::KdTree<Point>};
};

double mean_error(const Isometry3d& pose, const Scan& scan) {
  return (pose * scan.points - scan.truth).colwise().norm().mean();
}

/// Arguments: points; thousandths of a millimetre of noise; our method; PCL to planes or points.
void registration_against_pcl(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  const double noise = static_cast<double>(state.range(1)) / 1000;
  const auto method = static_cast<RegistrationMethod>(state.range(2));
  const bool to_planes = state.range(3) == 1;
  const int trials = count > 1000 ? 2 : 20;
  const TriangleMesh mesh = palpate::geometry::test::bumpy(300000, noise);
  const geometry::RegistrationTarget target(mesh);
  const Peer peer(mesh);
  std::vector<Scan> scans;
  for (int i = 0; i < trials; ++i) {
    scans.push_back(make_scan(mesh, count, noise, 30, 60, 7 + static_cast<unsigned>(i)));
  }
  // PCL's tree of our own target is made at its first use.
  (void)register_points(scans[0].points, target, {.method = method});
  int ours_right = 0, ours_accepted = 0, ours_false = 0, ours_iterations = 0;
  int peer_right = 0, peer_iterations = 0, runs = 0;
  double ours_error = 0, peer_error = 0;
  palpate::bench::run_paired(
      state,
      [&] {
        ++runs;
        for (const Scan& scan : scans) {
          const geometry::Registration found =
              register_points(scan.points, target, {.method = method});
          const double error = mean_error(found.T_target_source, scan);
          const bool accepted = found.verdict == geometry::RegistrationVerdict::accepted;
          ours_right += error < kRight ? 1 : 0;
          ours_accepted += accepted ? 1 : 0;
          ours_false += accepted && !(error < kRight) ? 1 : 0;
          ours_iterations += found.iterations;
          ours_error = std::max(ours_error, error);
        }
      },
      [&] {
        for (const Scan& scan : scans) {
          const double error =
              mean_error(peer.align(scan.points, to_planes, peer_iterations), scan);
          peer_right += error < kRight ? 1 : 0;
          peer_error = std::max(peer_error, error);
        }
      });
  if (ours_false > 0) state.SkipWithError("a wrong pose was accepted");
  const double all = static_cast<double>(runs) * trials;
  state.counters["ours_right"] = ours_right / all;
  state.counters["ours_accepted"] = ours_accepted / all;
  state.counters["ours_worst_mm"] = ours_error;
  state.counters["ours_iterations"] = ours_iterations / all;
  state.counters["peer_right"] = peer_right / all;
  state.counters["peer_worst_mm"] = peer_error;
  state.counters["peer_iterations"] = peer_iterations / all;
  state.counters["scans"] = trials;
}
BENCHMARK(registration_against_pcl)
    ->ArgNames({"points", "noise_um", "method", "planes"})
    ->ArgsProduct({{100}, {0, 250}, {0, 1, 2}, {0, 1}})
    ->Args({100000, 0, 0, 1})
    ->Args({100000, 250, 0, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace
