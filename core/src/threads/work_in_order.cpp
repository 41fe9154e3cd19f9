// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/work_in_order.h"

#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "threads/thread_order.h"

namespace palpate {

void work_in_order_erased(const std::function<std::shared_ptr<void>()>& next,
                          const std::function<void(void*)>& work,
                          const std::function<void(void*)>& deliver, int max_live) {
  require("work_in_order(): max_live", max_live, at_least(1));
  using Item = std::shared_ptr<void>;
  // Places whose addresses stand for the beginning and end of the call, and for its two serial
  // functions.
  char started = 0, taking = 0, delivering = 0, done = 0;
  // The pipeline forgets its items when a function throws, so it does not own them.
  std::vector<Item> live(static_cast<std::size_t>(max_live));
  std::size_t taken = 0;
  leave(&started);
  const EnterAtEnd after_all(&done);
  tbb::parallel_pipeline(
      live.size(),
      tbb::make_filter<void, Item*>(tbb::filter_mode::serial_in_order,
                                    [&](tbb::flow_control& control) {
                                      enter(&started);
                                      enter(&taking);
                                      const LeaveAtEnd after_this(&done);
                                      Item& slot = live[taken++ % live.size()];
                                      enter(&slot);
                                      slot = next();
                                      leave(&taking);
                                      if (!slot) control.stop();
                                      leave(slot.get());
                                      return &slot;
                                    }) &
          tbb::make_filter<Item*, Item*>(tbb::filter_mode::parallel,
                                         [&](Item* slot) {
                                           enter(slot->get());
                                           const LeaveAtEnd after_this(&done);
                                           work(slot->get());
                                           leave(slot->get());
                                           return slot;
                                         }) &
          tbb::make_filter<Item*, void>(tbb::filter_mode::serial_in_order, [&](Item* slot) {
            enter(slot->get());
            enter(&delivering);
            const LeaveAtEnd after_this(&done);
            deliver(slot->get());
            slot->reset();
            leave(slot);
            leave(&delivering);
          }));
}

int usual_live_items() {
  constexpr int kPerThread = 2;
  constexpr int kMost = 100;
  const auto allowed = static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  const int threads = std::min(tbb::this_task_arena::max_concurrency(), allowed);
  return std::clamp(kPerThread * threads, 1, kMost);
}

}  // namespace palpate
