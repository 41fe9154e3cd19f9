// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/parallel_for.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "threads/thread_order.h"

namespace palpate {

void parallel_ranges(std::ptrdiff_t count, std::ptrdiff_t grain,
                     const std::function<void(std::ptrdiff_t begin, std::ptrdiff_t end)>& body) {
  if (count <= 0) return;
  char started = 0, done = 0;  // places whose addresses stand for the two ends of the loop
  leave(&started);
  const EnterAtEnd after_all(&done);
  tbb::parallel_for(tbb::blocked_range<std::ptrdiff_t>(0, count, static_cast<std::size_t>(grain)),
                    [&](const tbb::blocked_range<std::ptrdiff_t>& range) {
                      enter(&started);
                      const LeaveAtEnd after_this(&done);
                      body(range.begin(), range.end());
                    });
}

}  // namespace palpate
