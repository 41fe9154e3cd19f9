// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "panel_window.h"

#include <GL/gl.h>
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::project {

/// GLFW while it is in use.
class Glfw {
 public:
  Glfw() {
    if (glfwInit() == GLFW_TRUE) return;
    const char* display = std::getenv("DISPLAY");
    throw DeviceError(
        std::string("no display: ") +
        (display == nullptr || *display == '\0'
             ? std::string("DISPLAY is not set")
             : "the X server of DISPLAY=" + std::string(display) + " does not answer") +
        "; images are shown on a monitor or projector of this computer");
  }
  ~Glfw() { glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

namespace {

constexpr double kLongestWait = 0.25;  // s between two looks at the window
constexpr double kWideToByte = 257;    // 65535 / 255

std::vector<GLFWmonitor*> handles() {
  int count = 0;
  GLFWmonitor** const first = glfwGetMonitors(&count);
  return {first, first + count};
}

Monitor described(GLFWmonitor* handle) {
  Monitor monitor;
  monitor.name = glfwGetMonitorName(handle);
  const GLFWvidmode* const mode = glfwGetVideoMode(handle);
  monitor.size = {mode->width, mode->height};
  glfwGetMonitorPos(handle, &monitor.x, &monitor.y);
  return monitor;
}

GLFWmonitor* find_monitor(const std::string& wanted) {
  const std::vector<GLFWmonitor*> all = handles();
  if (all.empty()) throw DeviceError("no monitor is connected to this display");
  if (wanted.empty()) return all.back();
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  if (error == std::errc() && end == wanted.data() + wanted.size() && number >= 1 &&
      number <= all.size())
    return all[number - 1];
  std::string names;
  for (GLFWmonitor* handle : all) {
    if (described(handle).name == wanted) return handle;
    names += (names.empty() ? "" : ", ") + described(handle).name;
  }
  throw InvalidInput(
      fmt::format("--monitor: is {}; it must be a number from 1 to {}, or one of {}.", wanted,
                  all.size(), names));
}

/// 8 bit, BGR, the lowest row first, as OpenGL draws.
cv::Mat for_panel(const cv::Mat& image) {
  cv::Mat bytes = image;
  if (image.depth() == CV_16U) image.convertTo(bytes, CV_8U, 1 / kWideToByte);
  if (bytes.channels() == 1) cv::cvtColor(bytes, bytes, cv::COLOR_GRAY2BGR);
  cv::Mat turned;
  cv::flip(bytes, turned, 0);
  return turned;
}

}  // namespace

struct PanelWindow::Impl {
  Glfw glfw;
  GLFWwindow* handle = nullptr;
  Monitor monitor;
  cv::Mat shown;

  void draw() const;
};

std::vector<Monitor> list_monitors() {
  const Glfw glfw;
  std::vector<Monitor> monitors;
  for (GLFWmonitor* handle : handles()) monitors.push_back(described(handle));
  return monitors;
}

PanelWindow::PanelWindow(const std::string& monitor) : impl_(std::make_unique<Impl>()) {
  GLFWmonitor* const handle = find_monitor(monitor);
  const GLFWvidmode* const mode = glfwGetVideoMode(handle);
  // The mode of the monitor stays as it is, and the window stays when the keyboard goes elsewhere.
  glfwWindowHint(GLFW_RED_BITS, mode->redBits);
  glfwWindowHint(GLFW_GREEN_BITS, mode->greenBits);
  glfwWindowHint(GLFW_BLUE_BITS, mode->blueBits);
  glfwWindowHint(GLFW_REFRESH_RATE, mode->refreshRate);
  glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
  impl_->handle = glfwCreateWindow(mode->width, mode->height, "palpate-project", handle, nullptr);
  if (impl_->handle == nullptr) throw DeviceError("the display gives no window with OpenGL");
  impl_->monitor = described(handle);
  glfwGetFramebufferSize(impl_->handle, &impl_->monitor.size.width, &impl_->monitor.size.height);
  glfwMakeContextCurrent(impl_->handle);
  glfwSwapInterval(1);
  glfwSetInputMode(impl_->handle, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
  glfwSetWindowUserPointer(impl_->handle, impl_.get());
  glfwSetWindowRefreshCallback(impl_->handle, [](GLFWwindow* window) {
    static_cast<const Impl*>(glfwGetWindowUserPointer(window))->draw();
  });
  impl_->shown = cv::Mat::zeros(impl_->monitor.size.height, impl_->monitor.size.width, CV_8UC3);
  impl_->draw();
}

PanelWindow::~PanelWindow() = default;

const Monitor& PanelWindow::monitor() const { return impl_->monitor; }

void PanelWindow::Impl::draw() const {
  glViewport(0, 0, monitor.size.width, monitor.size.height);
  glDisable(GL_DITHER);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  // Into both buffers, so that the image stays when the window system exchanges them.
  for (int buffer = 0; buffer < 2; ++buffer) {
    glRasterPos2i(-1, -1);
    glDrawPixels(shown.cols, shown.rows, GL_BGR, GL_UNSIGNED_BYTE, shown.data);
    glfwSwapBuffers(handle);
  }
  glFinish();
}

void PanelWindow::show(const cv::Mat& image) {
  const sensing::ImageSize& size = impl_->monitor.size;
  if (image.cols != size.width || image.rows != size.height) {
    throw InvalidInput(fmt::format(
        "has {} x {} px, and the monitor {} has {} x {} px. Images are shown pixel for pixel: set "
        "the monitor to the size of the image, or draw the pattern for a projector of its size.",
        image.cols, image.rows, impl_->monitor.name, size.width, size.height));
  }
  impl_->shown = for_panel(image);
  impl_->draw();
}

bool PanelWindow::wait() {
  glfwWaitEventsTimeout(kLongestWait);
  return glfwWindowShouldClose(impl_->handle) == GLFW_FALSE &&
         glfwGetKey(impl_->handle, GLFW_KEY_ESCAPE) != GLFW_PRESS;
}

void PanelWindow::wake() { glfwPostEmptyEvent(); }

}  // namespace palpate::project
