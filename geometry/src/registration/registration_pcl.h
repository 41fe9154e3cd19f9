// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>

#include "palpate/geometry/registration.h"

namespace palpate::geometry {

/// Points with normals, and PCL's search tree for them.
class VertexCloud {
 public:
  virtual ~VertexCloud() = default;
  VertexCloud(const VertexCloud&) = delete;
  VertexCloud& operator=(const VertexCloud&) = delete;

  struct Outcome {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    int iterations = 0;
    bool converged = false;  ///< before `max_iterations`, as PCL counts it
  };
  /// PCL's iterated closest points with pairs at most `max_distance` apart. Preconditions: finite
  /// points, and one of PCL's methods.
  /// \param go_on is called after each iteration, and ends the work if it throws.
  [[nodiscard]] virtual Outcome align(const Eigen::Matrix3Xd& points, RegistrationMethod method,
                                      double max_distance, int max_iterations,
                                      const std::function<void()>& go_on) const = 0;

 protected:
  VertexCloud() = default;
};

/// Functions of the module `registration_pcl`.
struct VertexClouds {
  /// Makes a cloud of the points whose normals are finite; both are 3 x V.
  std::unique_ptr<const VertexCloud> (*create)(const Eigen::Matrix3Xd& points,
                                               const Eigen::Matrix3Xd& normals);
};

}  // namespace palpate::geometry

extern "C" const palpate::geometry::VertexClouds palpate_registration_pcl;
