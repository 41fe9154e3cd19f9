// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "window.h"

#include <GL/glew.h>
// After the loader of its functions.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <string>
#include <thread>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "panel.h"
#include "theme.h"

namespace palpate::view {
namespace {

constexpr double kFrame = 1.0 / 60;    // [s] between two pictures at least
constexpr double kLongestFrame = 0.2;  // [s] of a picture that count
constexpr double kIdleFrame = 0.25;    // [s] between two pictures while nothing moves
constexpr double kMostCost = 0.013;    // [s] of a picture: more would miss the next one
constexpr double kCostFollow = 0.3;    // of the way a picture
constexpr int kFramesAfterEvent = 3;   // ImGui answers a click in the picture after the next one

// The latest words of GLFW.
std::string& glfw_words() {
  static std::string words;
  return words;
}

std::string no_display() {
  const char* display = std::getenv("DISPLAY");
  const std::string what =
      display == nullptr || *display == '\0'
          ? "DISPLAY is not set"
          : "the X server of DISPLAY=" + std::string(display) + " does not answer";
  return "no display: " + what +
         "; palpate-view shows a window. Set DISPLAY, or run it with: xvfb-run palpate-view ...";
}

}  // namespace

struct Window::Impl {
  GLFWwindow* handle = nullptr;
  View* view = nullptr;
  double last = 0;  // [s] of the last picture
  int busy_frames = kFramesAfterEvent;
  double whole_cost = 0;  // [s] of a picture with all details, as the latest ones took
  bool picture_wish = false;
  bool in_picture = false;  // the pointer moves what was pressed in the picture
  GLuint target = 0, target_color = 0, target_depth = 0;  // for pictures that no window shows
  // By the events, which may be behind the present pointer.
  Eigen::Vector2d pointer = Eigen::Vector2d::Zero();
  Eigen::Vector2i picture = Eigen::Vector2i::Zero();  // [px]

  [[nodiscard]] bool shift() const {
    return glfwGetKey(handle, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS ||
           glfwGetKey(handle, GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
  }
  static Impl& of(GLFWwindow* window) {
    return *static_cast<Impl*>(glfwGetWindowUserPointer(window));
  }
  void wake() { busy_frames = kFramesAfterEvent; }

  void make_window(const WindowOptions& options);
  void make_target(int width, int height);
  void listen();
  void draw(bool hurry);
  void show_drawn() const;
};

void Window::Impl::make_window(const WindowOptions& options) {
  glfwSetErrorCallback([](int /*code*/, const char* words) { glfw_words() = words; });
  if (glfwInit() == GLFW_FALSE) throw Error(no_display());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
  handle = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  if (handle == nullptr) {
    glfwTerminate();
    throw Error("OpenGL 3.3 is needed and this display does not offer it: " + glfw_words() +
                ". Install its driver; libgl1-mesa-dri has one without graphics hardware.");
  }
  glfwMakeContextCurrent(handle);
  glfwSetWindowSizeLimits(handle, 2 * kPanelWidth, kPanelWidth, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwSwapInterval(0);  // `run_frame` keeps the pace, on displays without one too
  glewExperimental = GL_TRUE;
  glewInit();
  if (!options.visible) make_target(options.width, options.height);
}

// A window that is not shown has no pixels of its own.
void Window::Impl::make_target(int width, int height) {
  glGenFramebuffers(1, &target);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glGenRenderbuffers(1, &target_color);
  glBindRenderbuffer(GL_RENDERBUFFER, target_color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target_color);
  glGenRenderbuffers(1, &target_depth);
  glBindRenderbuffer(GL_RENDERBUFFER, target_depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target_depth);
}

void Window::Impl::listen() {
  glfwSetWindowUserPointer(handle, this);
  glfwGetCursorPos(handle, &pointer.x(), &pointer.y());
  glfwSetMouseButtonCallback(handle, [](GLFWwindow* window, int button, int action, int mods) {
    Impl& self = of(window);
    self.wake();
    const bool down = action == GLFW_PRESS;
    if (self.view == nullptr || button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    const Eigen::Vector2d at = self.pointer;
    if (down && at.x() >= self.picture.x()) return;  // the panel's
    if (!down && !self.in_picture) return;
    self.in_picture = down;
    const MouseButton which = button == GLFW_MOUSE_BUTTON_LEFT    ? MouseButton::left
                              : button == GLFW_MOUSE_BUTTON_RIGHT ? MouseButton::right
                                                                  : MouseButton::middle;
    self.view->button(which, down, at, (mods & GLFW_MOD_SHIFT) != 0);
  });
  glfwSetCursorPosCallback(handle, [](GLFWwindow* window, double x, double y) {
    Impl& self = of(window);
    self.wake();
    self.pointer = {x, y};
    if (self.view != nullptr && (self.in_picture || x < self.picture.x())) {
      self.view->move({x, y}, self.shift());
    }
  });
  glfwSetScrollCallback(handle, [](GLFWwindow* window, double /*x*/, double lines) {
    Impl& self = of(window);
    self.wake();
    if (self.view != nullptr && self.pointer.x() < self.picture.x()) self.view->wheel(lines);
  });
  glfwSetKeyCallback(handle, [](GLFWwindow* window, int key, int /*code*/, int action, int mods) {
    Impl& self = of(window);
    self.wake();
    const bool down = action != GLFW_RELEASE;
    if ((mods & GLFW_MOD_CONTROL) != 0 && key == GLFW_KEY_Q) glfwSetWindowShouldClose(window, 1);
    if (self.view == nullptr || (mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT)) != 0) return;
    if (ImGui::GetIO().WantTextInput) return;
    if (down && key == GLFW_KEY_Q) glfwSetWindowShouldClose(window, GLFW_TRUE);
    if (action == GLFW_PRESS && key == GLFW_KEY_P) self.picture_wish = true;
    self.view->key(key, down);
  });
  glfwSetWindowRefreshCallback(handle, [](GLFWwindow* window) { of(window).wake(); });
  glfwSetFramebufferSizeCallback(
      handle, [](GLFWwindow* window, int /*width*/, int /*height*/) { of(window).wake(); });
}

void Window::Impl::draw(bool hurry) {
  int width = 0, height = 0;
  glfwGetFramebufferSize(handle, &width, &height);
  const Eigen::Vector2i size(std::max(1, width - kPanelWidth), std::max(1, height));
  if (size != picture) {
    picture = size;
    view->resize(picture.x(), picture.y());
  }
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, picture.x(), picture.y());
  view->draw(hurry);
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  const Eigen::Vector3f paper = color(kPanel);
  glEnable(GL_SCISSOR_TEST);
  glScissor(picture.x(), 0, kPanelWidth, picture.y());
  glClearColor(paper.x(), paper.y(), paper.z(), 1);
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_SCISSOR_TEST);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  view->panel();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::Impl::show_drawn() const {
  if (target == 0) {
    glfwSwapBuffers(handle);
  } else {
    glFinish();
  }
}

Window::Window(const WindowOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->make_window(options);
  impl_->listen();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // nothing is left behind in the folder
  set_panel_style();
  // It calls the functions that `listen` has set, too.
  ImGui_ImplGlfw_InitForOpenGL(impl_->handle, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(impl_->handle);
  glfwTerminate();
}

void Window::show(View& view) {
  impl_->view = &view;
  impl_->last = glfwGetTime();
}

bool Window::run_frame() {
  Impl& self = *impl_;
  const bool moving = self.view->is_moving() || self.busy_frames > 0;
  const double next = self.last + (moving ? kFrame : kIdleFrame);
  for (double left = next - glfwGetTime(); left > 0; left = next - glfwGetTime()) {
    glfwWaitEventsTimeout(left);
    if (!moving && self.busy_frames > 0) break;
  }
  glfwPollEvents();
  if (glfwWindowShouldClose(self.handle) != 0) return false;
  self.busy_frames = std::max(0, self.busy_frames - 1);
  const double now = glfwGetTime();
  const double seconds = std::min(kLongestFrame, now - self.last);
  self.last = now;
  self.view->advance(seconds);
  const bool hurry = self.view->is_moving() && self.whole_cost > kMostCost;
  self.draw(hurry);
  self.show_drawn();
  if (!hurry) self.whole_cost += kCostFollow * (glfwGetTime() - now - self.whole_cost);
  return true;
}

void Window::draw_frame(double seconds) {
  glfwPollEvents();
  impl_->view->advance(seconds);
  impl_->draw(false);
  impl_->show_drawn();
}

void Window::write_picture(const std::filesystem::path& png) {
  // Drawn again: what is shown already may be covered by another window.
  impl_->draw(false);
  int width = 0, height = 0;
  glfwGetFramebufferSize(impl_->handle, &width, &height);
  cv::Mat upwards(height, width, CV_8UC3), image;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_BGR, GL_UNSIGNED_BYTE, upwards.data);
  impl_->show_drawn();
  cv::flip(upwards, image, 0);
  sensing::write_png(png, image);
}

bool Window::take_picture_wish() {
  const bool wish = impl_->picture_wish;
  impl_->picture_wish = false;
  return wish;
}

}  // namespace palpate::view
