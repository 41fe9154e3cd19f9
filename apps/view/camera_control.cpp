// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "camera_control.h"

#include <GLFW/glfw3.h>

#include <cmath>

namespace palpate::view {
namespace {

constexpr double kWheelZoom = 0.11;  // a line of the wheel
constexpr double kKeyZoom = 1.25;
constexpr double kKeyTurn = 40;    // [px]
constexpr double kTurntable = 75;  // [px/s]: a turn in ten seconds

}  // namespace

void CameraControl::press(MouseButton button, const Eigen::Vector2d& at, bool shift) {
  const bool pans = button == MouseButton::middle || (button == MouseButton::right && shift);
  act_ = pans ? Act::pan : Act::turn;
  last_ = at;
}

bool CameraControl::drag(const Eigen::Vector2d& at) {
  if (act_ == Act::none) return false;
  const Eigen::Vector2d way = at - last_;
  last_ = at;
  if (act_ == Act::turn) {
    camera.turn(way.x(), way.y());
  } else {
    camera.pan(way.x(), way.y());
  }
  return true;
}

void CameraControl::wheel(double lines) { camera.zoom(std::exp(-lines * kWheelZoom)); }

bool CameraControl::key(int key) {
  switch (key) {
    case GLFW_KEY_R:
      turntable = false;
      camera.home();
      return true;
    case GLFW_KEY_K:
      turntable = !turntable;
      return true;
    case GLFW_KEY_PAGE_UP:
      camera.zoom(1 / kKeyZoom);
      return true;
    case GLFW_KEY_PAGE_DOWN:
      camera.zoom(kKeyZoom);
      return true;
    case GLFW_KEY_A:
      camera.turn(kKeyTurn, 0);
      return true;
    case GLFW_KEY_D:
      camera.turn(-kKeyTurn, 0);
      return true;
    case GLFW_KEY_W:
      camera.turn(0, kKeyTurn);
      return true;
    case GLFW_KEY_S:
      camera.turn(0, -kKeyTurn);
      return true;
    default:
      return false;
  }
}

void CameraControl::advance(double seconds) {
  if (turntable) camera.turn(kTurntable * seconds, 0);
}

}  // namespace palpate::view
