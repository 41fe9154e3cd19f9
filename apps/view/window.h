// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "view.h"

namespace palpate::view {

struct WindowOptions {
  std::string title;
  int width = 1280;     ///< [px] of picture and panel
  int height = 800;     ///< [px]
  bool visible = true;  ///< otherwise only its pictures are wanted
};

/// A window with OpenGL 3.3, in which a `View` shows its picture, and its panel on the right. One
/// at a time, in the main thread.
class Window {
 public:
  /// \throws Error, saying what to do, if there is no display, or no OpenGL 3.3.
  explicit Window(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Sets the view that gets the events; it must outlive the window.
  void show(View& view);
  /// Waits until the next picture is due, or something happens, and draws it. At most 60 pictures a
  /// second are drawn.
  /// \return false if the user has closed the window.
  [[nodiscard]] bool run_frame();
  /// Draws the picture `seconds` after the last one, whatever the time.
  void draw_frame(double seconds);
  /// Writes the last picture, with the panel, as PNG. \throws OutputError.
  void write_picture(const std::filesystem::path& png);
  /// Returns true if P was pressed since the last call: the user wants a picture.
  [[nodiscard]] bool take_picture_wish();

  static constexpr int kPanelWidth = 340;  ///< [px]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::view
