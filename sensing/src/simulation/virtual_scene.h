// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {

/// Checks a body.
/// \throws InvalidInput naming the body and its fault.
void check_body(const Body& body, std::size_t number);

/// The point at which a ray meets a body.
struct SurfaceView {
  int body = -1;
  geometry::SurfacePoint at;  ///< triangle index in the whole scene
  Eigen::Vector3d position;   ///< [mm]
  Eigen::Vector3d facet;      ///< unit normal of the triangle, towards the viewer
  Eigen::Vector3d normal;     ///< unit, smooth, on the same side
};

/// The bodies as one surface for ray queries.
class VirtualScene {
 public:
  /// `bodies` must be valid and outlive the scene.
  explicit VirtualScene(std::span<const Body> bodies);

  [[nodiscard]] bool moves() const { return moves_; }
  /// Moves the bodies. Must not run while another thread queries the scene.
  /// \param time 0 when the shutter opens, 1 when it closes.
  void move_to(double time);

  /// First surface seen from the origin in a direction.
  [[nodiscard]] std::optional<SurfaceView> look(const Eigen::Vector3d& direction) const;
  /// Returns true if nothing lies between a visible place and `light`.
  [[nodiscard]] bool sees(const SurfaceView& place, const Eigen::Vector3d& light) const;
  /// Reflectance in red, green and blue.
  [[nodiscard]] Eigen::Vector3d reflectance(const SurfaceView& place) const;
  [[nodiscard]] const Body& body(const SurfaceView& place) const {
    return bodies_[static_cast<std::size_t>(place.body)];
  }

 private:
  void set_normals();

  std::span<const Body> bodies_;
  bool moves_ = false;
  geometry::TriangleMesh mesh_;
  std::vector<int> body_of_;         ///< body of each triangle
  std::vector<int> first_triangle_;  ///< first triangle of each body
  Eigen::Matrix3Xd facets_;          ///< normals of the triangles; NaN for zero area
  Eigen::Matrix3Xd corner_normals_;  ///< 3 x 3T
  double lift_ = 0;                  ///< [mm]
  std::optional<geometry::SurfaceQuery> query_;
};

}  // namespace palpate::sensing
