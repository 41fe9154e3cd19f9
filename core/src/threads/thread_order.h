// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef PALPATE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace palpate {

/// Everything before `leave(place)` on one thread happens before everything after `enter(place)` on
/// another. oneTBB guarantees this order between its tasks, but ThreadSanitizer cannot see into the
/// library, so it is told here. Without that sanitizer both do nothing.
inline void leave([[maybe_unused]] void* place) {
#ifdef PALPATE_THREAD_SANITIZER
  __tsan_release(place);
#endif
}
inline void enter([[maybe_unused]] void* place) {
#ifdef PALPATE_THREAD_SANITIZER
  __tsan_acquire(place);
#endif
}

/// Calls `enter(place)` when it is destroyed, also by an exception.
class EnterAtEnd {
 public:
  explicit EnterAtEnd(void* place) : place_(place) {}
  ~EnterAtEnd() { enter(place_); }
  EnterAtEnd(const EnterAtEnd&) = delete;
  EnterAtEnd& operator=(const EnterAtEnd&) = delete;

 private:
  void* place_;
};

/// Calls `leave(place)` when it is destroyed, also by an exception.
class LeaveAtEnd {
 public:
  explicit LeaveAtEnd(void* place) : place_(place) {}
  ~LeaveAtEnd() { leave(place_); }
  LeaveAtEnd(const LeaveAtEnd&) = delete;
  LeaveAtEnd& operator=(const LeaveAtEnd&) = delete;

 private:
  void* place_;
};

}  // namespace palpate
