// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::bench {

/// Plain Embree, with its own triangles in single precision.
class EmbreePeer {
 public:
  /// Features that slow down other queries are requested from Embree only for their purpose.
  enum class Purpose { first_hits, all_hits, moves };
  explicit EmbreePeer(const geometry::TriangleMesh& mesh, Purpose purpose = Purpose::first_hits);
  ~EmbreePeer();
  /// [mm] to the nearest point.
  [[nodiscard]] double distance(const Eigen::Vector3d& point) const;
  /// First crossing origin + t along with t in [0, far]; NaN if there is none.
  [[nodiscard]] double first_crossing(const Eigen::Vector3d& origin, const Eigen::Vector3d& along,
                                      float far) const;
  /// All crossings origin + t along with t >= 0, in ascending order.
  [[nodiscard]] std::vector<double> all_crossings(const Eigen::Vector3d& origin,
                                                  const Eigen::Vector3d& along) const;
  /// Moves the vertices and fits the tree to them.
  void move(const Eigen::Matrix3Xd& vertices);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// CGAL's tree of axis-aligned boxes in double precision.
class CgalPeer {
 public:
  explicit CgalPeer(const geometry::TriangleMesh& mesh);
  ~CgalPeer();
  [[nodiscard]] double distance(const Eigen::Vector3d& point) const;
  /// As above; `far` is 1 (a segment) or infinity (a ray).
  [[nodiscard]] double first_crossing(const Eigen::Vector3d& origin, const Eigen::Vector3d& along,
                                      float far) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::bench
