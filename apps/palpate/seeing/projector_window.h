// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>

#include "shared/aliases.h"

namespace palpate::apps {

/// The window on the projector. It belongs to the program `palpate-project`, which runs beside this
/// one and gets the images from it, so that `palpate` loads no OpenGL.
class ProjectorWindow {
 public:
  /// Opens a black window.
  /// \param monitor number or name; empty for the last monitor.
  /// \throws DeviceError if there is no display or no such monitor.
  explicit ProjectorWindow(const std::string& monitor);
  ~ProjectorWindow();
  ProjectorWindow(const ProjectorWindow&) = delete;
  ProjectorWindow& operator=(const ProjectorWindow&) = delete;

  /// Shows an image; returns when it is on the screen, as far as the computer can tell.
  /// \throws InvalidInput if it does not have the size of the monitor.
  /// \throws DeviceError if the window was closed.
  void show(const fs::path& image);

 private:
  [[nodiscard]] std::string answer();

  pid_t program_ = -1;
  int socket_ = -1;
  std::string received_;  ///< of the next answer
};

}  // namespace palpate::apps
