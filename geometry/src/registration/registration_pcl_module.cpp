// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `registration_pcl`.
#include "registration/registration_pcl.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include <limits>

namespace palpate::geometry {
namespace {

using Point = pcl::PointNormal;
using Cloud = pcl::PointCloud<Point>;

/// PCL has converged if a step moves by at most the rounding of its floats (local frame); it
/// compares the squared translation, and one minus the cosine of the rotation.
constexpr double kRounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon());

/// Gives access to PCL's iterations, after each of which it moves the points.
template <typename Icp>
struct Watched : Icp {
  explicit Watched(const std::function<void()>& go_on) : go_on_(go_on) {}
  [[nodiscard]] int iterations() const { return this->nr_iterations_; }

 private:
  void transformCloud(const Cloud& input, Cloud& output, const Eigen::Matrix4f& motion) override {
    Icp::transformCloud(input, output, motion);
    go_on_();
  }

  const std::function<void()>& go_on_;
};

template <typename Icp>
VertexCloud::Outcome align_with(const Cloud::Ptr& source, const Cloud::Ptr& target,
                                const pcl::search::KdTree<Point>::Ptr& tree, double max_distance,
                                int max_iterations, const std::function<void()>& go_on) {
  Watched<Icp> icp(go_on);
  icp.setSearchMethodTarget(tree, true);
  icp.setInputTarget(target);
  icp.setInputSource(source);
  icp.setMaxCorrespondenceDistance(max_distance);
  icp.setMaximumIterations(max_iterations);
  icp.setTransformationEpsilon(kRounding * kRounding);
  Cloud moved;
  icp.align(moved);
  const Eigen::Matrix4d found = icp.getFinalTransformation().template cast<double>();
  VertexCloud::Outcome outcome;
  outcome.iterations = icp.iterations();
  outcome.converged =
      icp.hasConverged() && outcome.iterations < max_iterations && found.allFinite();
  if (!found.allFinite()) return outcome;
  outcome.motion.linear() = Eigen::Quaterniond(Eigen::Matrix3d(found.topLeftCorner<3, 3>()))
                                .normalized()
                                .toRotationMatrix();
  outcome.motion.translation() = found.topRightCorner<3, 1>();
  return outcome;
}

class PclCloud : public VertexCloud {
 public:
  PclCloud(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals) {
    for (Eigen::Index v = 0; v < points.cols(); ++v) {
      if (!normals.col(v).allFinite()) continue;
      Point point;
      point.getVector3fMap() = points.col(v).cast<float>();
      point.getNormalVector3fMap() = normals.col(v).cast<float>();
      cloud_->push_back(point);
    }
    tree_->setInputCloud(cloud_);
  }

  [[nodiscard]] Outcome align(const Eigen::Matrix3Xd& points, RegistrationMethod method,
                              double max_distance, int max_iterations,
                              const std::function<void()>& go_on) const override {
    const Cloud::Ptr source(new Cloud);
    for (const auto& point : points.colwise()) {
      Point p;
      p.getVector3fMap() = point.cast<float>();
      // The point-to-plane step uses only the target's normals, but PCL ignores sources without
      // normals.
      p.getNormalVector3fMap() = Eigen::Vector3f::UnitZ();
      source->push_back(p);
    }
    if (method == RegistrationMethod::point_to_plane) {
      return align_with<pcl::IterativeClosestPointWithNormals<Point, Point>>(
          source, cloud_, tree_, max_distance, max_iterations, go_on);
    }
    return align_with<pcl::IterativeClosestPoint<Point, Point>>(source, cloud_, tree_, max_distance,
                                                                max_iterations, go_on);
  }

 private:
  Cloud::Ptr cloud_{new Cloud};
  pcl::search::KdTree<Point>::Ptr tree_{new pcl::search::KdTree<Point>};
};

std::unique_ptr<const VertexCloud> create(const Eigen::Matrix3Xd& points,
                                          const Eigen::Matrix3Xd& normals) {
  return std::make_unique<const PclCloud>(points, normals);
}

}  // namespace
}  // namespace palpate::geometry

const palpate::geometry::VertexClouds palpate_registration_pcl{&palpate::geometry::create};
