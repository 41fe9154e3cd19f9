// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "scan_fusion_peers.h"

namespace palpate::bench {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

class Volume {
 public:
  Volume(double voxel, double truncation)
      : truncation_(truncation),
        distances_(openvdb::FloatGrid::create(static_cast<float>(truncation))),
        weights_(openvdb::FloatGrid::create(0)) {
    distances_->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    distances_->setGridClass(openvdb::GRID_LEVEL_SET);
  }

  void integrate(const SeenPoints& view) {
    auto distances = distances_->getUnsafeAccessor();
    auto weights = weights_->getUnsafeAccessor();
    const Vec3d eye(view.eye.x(), view.eye.y(), view.eye.z());
    for (const auto& seen : view.points.colwise()) {
      const Vec3d point(seen.x(), seen.y(), seen.z());
      Vec3d way = point - eye;
      const double depth = way.length();
      way /= depth;
      const auto ray =
          openvdb::math::Ray<double>(eye, way, depth - truncation_, depth + truncation_)
              .worldToIndex(*distances_);
      openvdb::math::DDA<openvdb::math::Ray<double>> steps(ray);
      do {
        const Coord voxel = steps.voxel();
        const Vec3d ahead = point - distances_->indexToWorld(voxel.asVec3d() + Vec3d(0.5));
        const double distance = std::copysign(ahead.length(), ahead.dot(way));
        if (distance <= -truncation_) continue;
        const float weight = weights.getValue(voxel);
        const float sum = weight * distances.getValue(voxel) +
                          static_cast<float>(std::min(distance, truncation_));
        distances.setValue(voxel, sum / (weight + 1));
        weights.setValue(voxel, weight + 1);
      } while (steps.step());
    }
  }

  [[nodiscard]] geometry::TriangleMesh surface() const {
    // Only cells whose eight corners were measured.
    const openvdb::BoolGrid::Ptr measured = openvdb::BoolGrid::create(false);
    measured->setTransform(distances_->transformPtr());
    auto mark = measured->getAccessor();
    auto weights = weights_->getConstAccessor();
    for (auto voxel = weights_->cbeginValueOn(); voxel; ++voxel) {
      bool all = true;
      for (int corner = 1; corner < 8 && all; ++corner) {
        all = weights.isValueOn(voxel.getCoord() + Coord(corner & 1, corner >> 1 & 1, corner >> 2));
      }
      if (all) mark.setValueOn(voxel.getCoord(), true);
    }
    openvdb::tools::VolumeToMesh mesher(0);
    mesher.setSurfaceMask(measured);
    mesher(*distances_);
    geometry::TriangleMesh mesh;
    mesh.vertices.resize(3, static_cast<Eigen::Index>(mesher.pointListSize()));
    const double half = distances_->voxelSize()[0] / 2;
    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      const openvdb::Vec3s& at = mesher.pointList()[v];
      mesh.vertices.col(v) = Eigen::Vector3f(at[0], at[1], at[2]).cast<double>().array() + half;
    }
    std::vector<Eigen::Vector3i> triangles;
    const auto add = [&](unsigned a, unsigned b, unsigned c) {
      triangles.push_back(Eigen::Matrix<unsigned, 3, 1>(a, b, c).cast<int>());
    };
    for (std::size_t i = 0; i < mesher.polygonPoolListSize(); ++i) {
      const openvdb::tools::PolygonPool& pool = mesher.polygonPoolList()[i];
      for (std::size_t q = 0; q < pool.numQuads(); ++q) {
        const openvdb::Vec4I& quad = pool.quad(q);
        add(quad[0], quad[1], quad[2]);
        add(quad[0], quad[2], quad[3]);
      }
    }
    mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
      mesh.triangles.col(t) = triangles[static_cast<std::size_t>(t)];
    return mesh;
  }

 private:
  double truncation_;
  openvdb::FloatGrid::Ptr distances_, weights_;
};

}  // namespace

geometry::TriangleMesh fuse_with_openvdb(const std::vector<SeenPoints>& views, double voxel,
                                         double truncation) {
  openvdb::initialize();
  Volume volume(voxel, truncation);
  for (const SeenPoints& view : views) volume.integrate(view);
  return volume.surface();
}

}  // namespace palpate::bench
