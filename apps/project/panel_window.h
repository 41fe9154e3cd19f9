// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/image_size.h"

namespace palpate::project {

/// A monitor, or a projector, which looks the same to the computer.
struct Monitor {
  std::string name;
  sensing::ImageSize size;  ///< px
  int x = 0, y = 0;         ///< px, its upper left corner on the desktop
};

/// \throws DeviceError if there is no display.
[[nodiscard]] std::vector<Monitor> list_monitors();

/// A window that fills a monitor and shows images pixel for pixel. Black at first. Only the main
/// thread may use it, except for `wake`.
class PanelWindow {
 public:
  /// \param monitor number from 1, or name; empty for the last one.
  /// \throws InvalidInput if there is no such monitor; DeviceError if there is no display.
  explicit PanelWindow(const std::string& monitor);
  ~PanelWindow();
  PanelWindow(const PanelWindow&) = delete;
  PanelWindow& operator=(const PanelWindow&) = delete;

  [[nodiscard]] const Monitor& monitor() const;
  /// Shows an image, and returns when it was handed to the monitor.
  /// \param image 8 or 16 bit, grey or BGR, of the monitor's size.
  /// \throws InvalidInput if it has another size.
  void show(const cv::Mat& image);
  /// Waits for keys and for `wake`.
  /// \return false once the window is closed, or Escape was pressed.
  bool wait();
  /// Ends `wait`. Any thread may call this.
  static void wake();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::project
