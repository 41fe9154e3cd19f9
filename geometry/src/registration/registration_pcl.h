// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

#include "palpate/geometry/registration.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A mesh's vertices with normals, and PCL's search tree for them.
class VertexCloud {
 public:
  explicit VertexCloud(const TriangleMesh& mesh);
  ~VertexCloud();
  VertexCloud(const VertexCloud&) = delete;
  VertexCloud& operator=(const VertexCloud&) = delete;

  struct Outcome {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    int iterations = 0;
    bool converged = false;  ///< before `max_iterations`, as PCL counts it
  };
  /// PCL's iterated closest points with pairs at most `max_distance` apart. Preconditions: finite
  /// points, and one of PCL's methods.
  [[nodiscard]] Outcome align(const Eigen::Matrix3Xd& points, RegistrationMethod method,
                              double max_distance, int max_iterations) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::geometry
