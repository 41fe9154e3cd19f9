// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace palpate {

/// `work_in_order` for items of a hidden type. A null pointer from `next` ends the sequence.
void work_in_order_erased(const std::function<std::shared_ptr<void>()>& next,
                          const std::function<void(void*)>& work,
                          const std::function<void(void*)>& deliver, int max_live);

/// Works on a sequence of items in parallel, in bounded memory: takes items from `next` until there
/// are no more, calls `work` on each, and passes them to `deliver` in the order in which they came.
///
/// Calls overlap in time as follows. `work` runs in several threads at once, on different items.
/// `next` is called by one thread at a time, and so is `deliver`, but not always by the same one.
/// `next`, `work` and `deliver` overlap with one another. So data that only `next` or only
/// `deliver` uses need no lock; data that two of the three use must be constant or locked. An item
/// is in one call at a time: data that belong to it are best kept in it.
///
/// At most `max_live` items are between `next` and the end of their `deliver`. An exception of any
/// of the three ends the work and passes through; items that came before may then be missing from
/// `deliver`. All calls have ended when `work_in_order` returns or throws.
/// \throws InvalidInput unless max_live >= 1.
template <typename Item>
void work_in_order(const std::function<std::optional<Item>()>& next,
                   const std::function<void(Item&)>& work,
                   const std::function<void(Item&)>& deliver, int max_live) {
  work_in_order_erased(
      [&next]() -> std::shared_ptr<void> {
        std::optional<Item> item = next();
        return item ? std::make_shared<Item>(std::move(*item)) : nullptr;
      },
      [&work](void* item) { work(*static_cast<Item*>(item)); },
      [&deliver](void* item) { deliver(*static_cast<Item*>(item)); }, max_live);
}

/// The number of items that keeps all threads busy: two for each thread, at most 100.
[[nodiscard]] int usual_live_items();

}  // namespace palpate
