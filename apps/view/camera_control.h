// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "camera.h"
#include "view.h"

namespace palpate::view {

/// Moves a camera by mouse and keys, in the same way in all views.
class CameraControl {
 public:
  explicit CameraControl(const Extent& extent) : camera(extent) {}

  void press(MouseButton button, const Eigen::Vector2d& at, bool shift);
  void release() { act_ = Act::none; }
  /// False if no button is held that moves the camera.
  bool drag(const Eigen::Vector2d& at);
  void wheel(double lines);
  /// R, Page Up and Down, W A S D. False for other keys.
  bool key(int key);
  /// Turns like a turntable: `K` starts and stops it.
  void advance(double seconds);
  [[nodiscard]] bool is_turning() const { return turntable; }

  Camera camera;
  bool turntable = false;

 private:
  enum class Act { none, turn, pan };
  Act act_ = Act::none;
  Eigen::Vector2d last_ = Eigen::Vector2d::Zero();
};

/// The text of the panels about it.
inline constexpr const char* kCameraKeys =
    "Right button turns, middle button moves, wheel zooms; W A S D turn, K turntable, R first view";

}  // namespace palpate::view
