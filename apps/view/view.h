// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::view {

enum class MouseButton { left, middle, right };

/// The view of one thing in the window: a picture, and a panel beside it. Made and used while there
/// is a window. Places of the pointer are in pixels of the picture, y down.
class View {
 public:
  View() = default;
  virtual ~View() = default;
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  /// Size of the picture [px]; comes before the first `draw`.
  virtual void resize(int width, int height) = 0;
  virtual void button(MouseButton button, bool down, const Eigen::Vector2d& at, bool shift) = 0;
  virtual void move(const Eigen::Vector2d& at, bool shift) = 0;
  /// \param lines of the wheel, positive away from the user
  virtual void wheel(double lines) = 0;
  /// \param key as GLFW numbers them. False if the key means nothing here.
  virtual bool key(int key, bool down) = 0;
  /// Lets time go by [s] before a picture.
  virtual void advance(double seconds) = 0;
  /// Draws the picture with OpenGL into the viewport. \param hurry the next picture follows at
  /// once, and this processor is too slow for all details.
  virtual void draw(bool hurry) = 0;
  /// Writes the panel with ImGui, and the parts that lie over the picture.
  virtual void panel() = 0;
  /// Ends the work beside the window; the last call.
  /// \throws OutputError if a record is not complete.
  virtual void close() {}
  /// Returns true if the picture changes although the user does nothing.
  [[nodiscard]] virtual bool is_moving() const = 0;
  /// Lets the object turn, for a movie of an object that does not move.
  virtual void turn() = 0;
  /// [s] of the played ticks; 0 if nothing is played.
  [[nodiscard]] virtual double duration() const = 0;
};

}  // namespace palpate::view
