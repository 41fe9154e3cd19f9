// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "camera.h"

#include <algorithm>
#include <cmath>

namespace palpate::view {
namespace {

constexpr double kFieldOfView = 0.5;       // [rad] vertical
constexpr double kMargin = 0.84;           // of the picture is filled by the object
constexpr double kLowPitch = 0.5;          // [rad] of the first view: from above, so that a dent
constexpr double kHighPitch = 0.95;        // is seen, but not from straight above,
constexpr double kFirstTurn = 0.4;         // [rad] and from beside, so that the shape is seen
constexpr double kRadiansOfPixel = 0.008;  // of a drag
constexpr double kNearest = 0.15;          // diagonals
constexpr double kFarthest = 6;            // diagonals
constexpr double kLeastFacing = 0.3;       // shorter: the object faces all around
constexpr double kFacesCamera = -0.5;      // z of what a camera measured: it looks along +z

}  // namespace

Camera::Camera(const Extent& extent) : extent_(extent), target_(extent.center) {
  // Objects measured by a camera face it, with +y down; others stand on the ground, +z up.
  up_ = extent.facing.z() < kFacesCamera ? Eigen::Vector3d(0, -1, 0) : Eigen::Vector3d(0, 0, 1);
  const Eigen::Vector3d other =
      std::abs(up_.z()) > 0.5 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  side_ = up_.cross(other).normalized();
  front_ = side_.cross(up_);
  home();
}

Eigen::Matrix3d Camera::axes() const {
  const Eigen::Vector3d horizontal = front_ * std::cos(yaw_) + side_ * std::sin(yaw_);
  const Eigen::Vector3d back = horizontal * std::cos(pitch_) + up_ * std::sin(pitch_);
  const Eigen::Vector3d right = up_.cross(back).normalized();
  Eigen::Matrix3d axes;
  axes << right, back.cross(right), back;
  return axes;
}

Eigen::Vector3d Camera::eye() const { return target_ + axes().col(2) * distance_; }

double Camera::fitting_distance() const {
  const Eigen::Matrix3d picture = axes();
  const double tangent = std::tan(kFieldOfView / 2) * kMargin;
  double distance = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d p;
    for (unsigned k = 0; k < 3; ++k) {
      p[k] = ((corner >> k) & 1u) != 0 ? extent_.high[k] : extent_.low[k];
    }
    const Eigen::Vector3d q = picture.transpose() * (p - target_);
    const double needed = std::max(std::abs(q.x()) * height_ / width_, std::abs(q.y()));
    distance = std::max(distance, needed / tangent + q.z());
  }
  return distance > 0 ? distance : extent_.diagonal;
}

void Camera::home() {
  const Eigen::Vector3d seen = extent_.facing.norm() > kLeastFacing ? extent_.facing.normalized()
                                                                    : (front_ + up_).normalized();
  const double along = seen.dot(front_), across = seen.dot(side_);
  constexpr double kUpright = 0.1;
  yaw_ = (std::hypot(along, across) > kUpright ? std::atan2(across, along) : 0) + kFirstTurn;
  pitch_ = std::clamp(std::asin(std::clamp(seen.dot(up_), -1.0, 1.0)), kLowPitch, kHighPitch);
  target_ = extent_.center;
  distance_ = fitting_distance();
  moved_ = false;
}

void Camera::resize(double width, double height) {
  width_ = std::max(1.0, width);
  height_ = std::max(1.0, height);
  if (!moved_) distance_ = fitting_distance();
}

void Camera::turn(double dx, double dy) {
  yaw_ -= dx * kRadiansOfPixel;
  pitch_ = std::clamp(pitch_ + dy * kRadiansOfPixel, -kLargestPitch, kLargestPitch);
  moved_ = true;
}

void Camera::zoom(double factor) {
  distance_ =
      std::clamp(distance_ * factor, kNearest * extent_.diagonal, kFarthest * extent_.diagonal);
  moved_ = true;
}

void Camera::pan(double dx, double dy) {
  const Eigen::Matrix3d picture = axes();
  target_ += size_of_pixel() * (dy * picture.col(1) - dx * picture.col(0));
  moved_ = true;
}

double Camera::size_of_pixel() const {
  return 2 * std::tan(kFieldOfView / 2) * distance_ / height_;
}

geometry::Ray Camera::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Matrix3d picture = axes();
  const double size = size_of_pixel();
  const Eigen::Vector3d aim((pixel.x() - width_ / 2) * size, (height_ / 2 - pixel.y()) * size,
                            -distance_);
  return {.origin = eye(), .direction = (picture * aim).normalized()};
}

std::optional<Eigen::Vector2d> Camera::pixel(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d q = axes().transpose() * (point - eye());
  if (!(q.z() < 0)) return std::nullopt;
  const double scale = height_ / (2 * std::tan(kFieldOfView / 2)) / -q.z();
  return Eigen::Vector2d(width_ / 2 + scale * q.x(), height_ / 2 - scale * q.y());
}

Shot Camera::shot() const {
  const Eigen::Matrix3d picture = axes();
  const Eigen::Vector3d from = eye();
  const double near = std::max(0.02 * extent_.diagonal, distance_ - 3 * extent_.diagonal);
  const double far = distance_ + 3 * extent_.diagonal;
  const double f = 1 / std::tan(kFieldOfView / 2);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = f * height_ / width_;
  projection(1, 1) = f;
  projection(2, 2) = (near + far) / (near - far);
  projection(2, 3) = 2 * near * far / (near - far);
  projection(3, 2) = -1;
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = picture.transpose();
  view.topRightCorner<3, 1>() = -picture.transpose() * from;
  const Eigen::Vector3d light = picture * Eigen::Vector3d(-0.7, 0.55, 0.75);
  return {.matrix = (projection * view).cast<float>(),
          .eye = from.cast<float>(),
          .to_eye = picture.col(2).cast<float>(),
          .light = light.normalized().cast<float>()};
}

}  // namespace palpate::view
