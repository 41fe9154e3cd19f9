// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef PALPATE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace palpate {

/// What happened before `leave(place)` on one thread has happened before what follows
/// `enter(place)` on another. oneTBB guarantees this order between its tasks, but ThreadSanitizer
/// cannot see into the library, so it is told here. Without that sanitizer both do nothing.
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

}  // namespace palpate
