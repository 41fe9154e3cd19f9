// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace palpate {

/// `work_in_order` for items whose type is hidden; null is the end.
void work_in_order_erased(const std::function<std::shared_ptr<void>()>& next,
                          const std::function<void(void*)>& work,
                          const std::function<void(void*)>& deliver, int max_live);

/// Takes items from `next` until there are no more, calls `work` on each in parallel, and hands
/// them to `deliver` in the order in which they came. `next` and `deliver` are each called by one
/// thread at a time, not always the same. Never are more than `max_live` items (>= 1) between
/// `next` and the end of their `deliver`: a sequence of any length takes bounded memory. What any
/// of them throws ends it and passes through; items that came before may then be missing from
/// `deliver`.
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

/// Enough items to keep all threads at work: two for each, at most 100.
[[nodiscard]] int usual_live_items();

}  // namespace palpate
