// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

namespace palpate::pictures {

/// The process's connection to an X server, on which VTK draws without showing a window.
///
/// If DISPLAY names a server with OpenGL, that one is used. Otherwise (on a server, in a container,
/// in CI) the first object of this kind starts Debian's Xvfb, which draws in memory and ends with
/// the process in all cases. Pictures are drawn one at a time: a second thread waits until the
/// object of the first one is gone. The connection stays for the next one, unless its Xvfb ended.
class OffscreenDisplay {
 public:
  /// \throws OutputError, saying what to install, if there is no server and none can be started.
  OffscreenDisplay();
  ~OffscreenDisplay() = default;
  OffscreenDisplay(const OffscreenDisplay&) = delete;
  OffscreenDisplay& operator=(const OffscreenDisplay&) = delete;

  /// The Display* of Xlib, as vtkWindow::SetDisplayId takes it.
  [[nodiscard]] void* handle() const noexcept { return connection_; }

 private:
  std::unique_lock<std::mutex> turn_;
  void* connection_ = nullptr;
};

}  // namespace palpate::pictures
