// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace palpate::apps {

/// Exit status after Ctrl-C, as a shell expects it.
constexpr int kInterruptedStatus = 130;

/// Thrown after Ctrl-C or SIGTERM, so that stack unwinding cleans up.
struct Interrupted {
  /// Message for the user: what is kept, and what is not changed.
  std::string message = "interrupted; completed files are kept, no other file was changed";
};

/// Starts a thread that ends the program after Ctrl-C or SIGTERM with one line, without leaving
/// temporaries. Signals that the program was started to ignore stay ignored.
void watch_for_interrupts();

/// While one exists, the first Ctrl-C does not end the program: it makes `check` throw. The second
/// one ends it.
class InterruptedByThrowing {
 public:
  InterruptedByThrowing();
  ~InterruptedByThrowing();
  InterruptedByThrowing(const InterruptedByThrowing&) = delete;
  InterruptedByThrowing& operator=(const InterruptedByThrowing&) = delete;

  /// Thread-safe.
  /// \throws Interrupted after Ctrl-C or SIGTERM.
  static void check();
};

/// An `InterruptedByThrowing` with which the first Ctrl-C or SIGTERM also calls a function at once,
/// from another thread. One at a time.
class AtInterrupt {
 public:
  /// Calls it now if the signal came before.
  explicit AtInterrupt(std::function<void()> call);
  ~AtInterrupt();
  AtInterrupt(const AtInterrupt&) = delete;
  AtInterrupt& operator=(const AtInterrupt&) = delete;

 private:
  InterruptedByThrowing throwing_;
};

}  // namespace palpate::apps
