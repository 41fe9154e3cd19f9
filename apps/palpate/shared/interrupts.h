// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace palpate::apps {

/// The time that the program has to stop by itself after Ctrl-C.
constexpr std::chrono::milliseconds kLongestStop{800};

/// Exit status after Ctrl-C, as a shell expects it.
constexpr int kInterruptedStatus = 130;

/// Returns the message for the user after Ctrl-C: which files are kept, and which not changed.
[[nodiscard]] std::string interrupt_message();

/// Thrown after Ctrl-C or SIGTERM, so that stack unwinding cleans up.
struct Interrupted {
  std::string message = interrupt_message();
};

/// While one exists, `interrupt_message` says more than "completed files are kept". Thread-safe.
class InterruptMessage {
 public:
  /// Words that are empty stay as they are.
  explicit InterruptMessage(std::string kept, std::string how_to_continue = {});
  ~InterruptMessage();
  InterruptMessage(const InterruptMessage&) = delete;
  InterruptMessage& operator=(const InterruptMessage&) = delete;

  static void set_kept(std::string kept);

 private:
  std::string kept_before_, how_to_continue_before_;
};

/// Starts a thread that ends the program after Ctrl-C or SIGTERM with one line, without leaving
/// temporaries. Signals that the program was started to ignore stay ignored.
void watch_for_interrupts();

/// From now on, Ctrl-C neither ends the program nor prints anything. To be called before the
/// program ends: its loggers must not be used while they are destroyed.
void stop_watching();

/// While one exists, the first Ctrl-C does not end the program at once: it makes `check` throw. The
/// program is ended if that takes longer than `kLongestStop`, or by the second Ctrl-C, which a
/// message after the first one mentions.
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

/// An `InterruptedByThrowing` without a limit on the time to stop, for example for an arm that has
/// to come to rest, or for frames that have to be written.
class InterruptedWithoutHaste {
 public:
  InterruptedWithoutHaste();
  ~InterruptedWithoutHaste();
  InterruptedWithoutHaste(const InterruptedWithoutHaste&) = delete;
  InterruptedWithoutHaste& operator=(const InterruptedWithoutHaste&) = delete;

 private:
  InterruptedByThrowing throwing_;
};

/// An `InterruptedWithoutHaste` with which the first Ctrl-C or SIGTERM also calls a function at
/// once, from another thread. One at a time.
class AtInterrupt {
 public:
  /// Calls it now if the signal came before.
  explicit AtInterrupt(std::function<void()> call);
  ~AtInterrupt();
  AtInterrupt(const AtInterrupt&) = delete;
  AtInterrupt& operator=(const AtInterrupt&) = delete;

 private:
  InterruptedWithoutHaste throwing_;
};

}  // namespace palpate::apps
