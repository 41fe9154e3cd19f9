// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>

namespace palpate {

/// Calls `body(begin, end)` on several threads for ranges that together cover [0, count) once, in
/// any order. Each range has at least `grain` / 2 indices, unless `count` has fewer. The call
/// returns when all ranges are done. If a call of `body` throws, the loop ends early and the
/// exception passes through.
///
/// The ranges depend on the number of threads: a result must not depend on them.
void parallel_ranges(std::ptrdiff_t count, std::ptrdiff_t grain,
                     const std::function<void(std::ptrdiff_t begin, std::ptrdiff_t end)>& body);

/// Calls `body(i)` once for each i in [0, count), on several threads, in any order. It returns when
/// all calls are done. If a call throws, the loop ends early and the exception passes through.
template <std::integral Index, typename Body>
void parallel_for(Index count, const Body& body) {
  constexpr std::ptrdiff_t kGrain = 1;
  parallel_ranges(static_cast<std::ptrdiff_t>(count), kGrain,
                  [&body](std::ptrdiff_t begin, std::ptrdiff_t end) {
                    for (std::ptrdiff_t i = begin; i < end; ++i) body(static_cast<Index>(i));
                  });
}

}  // namespace palpate
