// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstddef>
#include <new>

namespace palpate::geometry {

/// Allocates arrays that are read in no order. The system is asked to keep large ones in huge
/// pages, because each step from one ordinary page to another waits for the page tables.
template <typename What>
struct HugePages {
  using value_type = What;
  HugePages() = default;
  template <typename Other>
  explicit HugePages(const HugePages<Other>& /*other*/) {}

  [[nodiscard]] What* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(What);
    void* memory = ::operator new(bytes, alignment(bytes));
#ifdef MADV_HUGEPAGE
    // Only advice: without it the pages are ordinary ones.
    if (bytes >= kHugePage) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<What*>(memory);
  }
  void deallocate(What* memory, std::size_t count) noexcept {
    ::operator delete(memory, alignment(count * sizeof(What)));
  }
  friend bool operator==(const HugePages& /*a*/, const HugePages& /*b*/) { return true; }

 private:
  static constexpr std::size_t kHugePage = std::size_t{1} << 21;
  [[nodiscard]] static std::align_val_t alignment(std::size_t bytes) {
    return std::align_val_t{bytes < kHugePage ? alignof(What) : kHugePage};
  }
};

}  // namespace palpate::geometry
