// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "extent.h"
#include "palpate/geometry/surface_query.h"

namespace palpate::view {

/// The data of a camera that shaders need.
struct Shot {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();  ///< world [mm] to clip space
  Eigen::Vector3f eye = Eigen::Vector3f::Zero();         ///< [mm]
  Eigen::Vector3f to_eye = Eigen::Vector3f::UnitZ();     ///< unit, from the target
  /// Unit, towards a light above the left shoulder of who looks.
  Eigen::Vector3f light = Eigen::Vector3f::UnitZ();
};

/// A camera that turns about the object like a turntable. Pixels have y down.
class Camera {
 public:
  explicit Camera(const Extent& extent);

  /// Back to the first view, in which the object fills the picture.
  void home();
  /// The size of the picture [px]; the first view is fitted again until the camera is moved.
  void resize(double width, double height);
  /// Turns by a way of the pointer [px].
  void turn(double dx, double dy);
  /// \param factor of the distance
  void zoom(double factor);
  /// Moves by a way of the pointer [px].
  void pan(double dx, double dy);

  /// [mm] that one pixel shows at the target.
  [[nodiscard]] double size_of_pixel() const;
  /// The ray from the eye through a pixel.
  [[nodiscard]] geometry::Ray ray(const Eigen::Vector2d& pixel) const;
  /// The pixel that shows a point [mm]; none for points behind the eye.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& point) const;
  [[nodiscard]] Shot shot() const;

  static constexpr double kLargestPitch = 1.5;  ///< [rad]: straight above there is no left or right

 private:
  /// Columns: right, up and back of the picture, in the world.
  [[nodiscard]] Eigen::Matrix3d axes() const;
  [[nodiscard]] double fitting_distance() const;
  [[nodiscard]] Eigen::Vector3d eye() const;

  Extent extent_;
  Eigen::Vector3d up_, side_, front_;
  double yaw_ = 0, pitch_ = 0, distance_ = 1;  // [rad], [mm]
  Eigen::Vector3d target_;                     // [mm]
  double width_ = 1, height_ = 1;              // [px]
  bool moved_ = false;
};

}  // namespace palpate::view
