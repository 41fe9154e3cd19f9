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

/// \throws InvalidInput naming the body and what is wrong with it.
void check_body(const Body& body, std::size_t number);

/// Where a ray meets a body.
struct SurfaceView {
  int body = -1;
  geometry::SurfacePoint at;  ///< triangle of the whole scene
  Eigen::Vector3d position;   ///< [mm]
  Eigen::Vector3d facet;      ///< unit normal of the triangle, towards the viewer
  Eigen::Vector3d normal;     ///< unit, smooth, on the same side
};

/// The bodies as one surface for rays.
class VirtualScene {
 public:
  /// `bodies` must outlive the scene. Pre: they are valid.
  explicit VirtualScene(std::span<const Body> bodies);

  [[nodiscard]] bool moves() const { return moves_; }
  /// \param time 0 when the shutter opens, 1 when it closes. Not while another thread asks.
  void move_to(double time);

  /// What is seen from the origin in a direction.
  [[nodiscard]] std::optional<SurfaceView> look(const Eigen::Vector3d& direction) const;
  /// Whether nothing lies between a place that is seen and `light`.
  [[nodiscard]] bool sees(const SurfaceView& place, const Eigen::Vector3d& light) const;
  /// Red, green, blue.
  [[nodiscard]] Eigen::Vector3d reflectance(const SurfaceView& place) const;
  [[nodiscard]] const Body& body(const SurfaceView& place) const {
    return bodies_[static_cast<std::size_t>(place.body)];
  }

 private:
  void set_normals();

  std::span<const Body> bodies_;
  bool moves_ = false;
  geometry::TriangleMesh mesh_;
  std::vector<int> body_of_;         ///< each triangle's body
  std::vector<int> first_triangle_;  ///< each body's
  Eigen::Matrix3Xd facets_;          ///< triangles' normals; NaN without an area
  Eigen::Matrix3Xd corner_normals_;  ///< 3 x 3T
  double lift_ = 0;                  ///< [mm]
  std::optional<geometry::SurfaceQuery> query_;
};

}  // namespace palpate::sensing
