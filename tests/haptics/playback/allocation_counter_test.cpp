// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "allocation_counter.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace palpate::test {
namespace {

// Keeps the compiler from leaving out an allocation that nobody uses.
void* volatile kept = nullptr;

struct alignas(256) Aligned {
  char bytes[256];
};

template <typename Allocate, typename Free>
void expect_counted(const char* name, Allocate&& allocate, Free&& free) {
  const long before = allocations();
  kept = allocate();
  EXPECT_GT(allocations(), before) << name;
  ASSERT_NE(kept, nullptr) << name;
  free(kept);
}

TEST(AllocationCounter, SeesEveryAllocator) {
  if (!counts_allocations()) GTEST_SKIP() << "the sanitizer's allocator cannot be counted";
  const auto free = [](void* memory) { std::free(memory); };
  expect_counted(
      "malloc", [] { return std::malloc(100); }, free);
  expect_counted(
      "calloc", [] { return std::calloc(10, 10); }, free);
  expect_counted(
      "realloc", [] { return std::realloc(nullptr, 100); }, free);
  expect_counted(
      "aligned_alloc", [] { return std::aligned_alloc(256, 512); }, free);
  expect_counted(
      "memalign", [] { return memalign(256, 512); }, free);
  expect_counted(
      "valloc", [] { return valloc(512); }, free);
  expect_counted(
      "pvalloc", [] { return pvalloc(512); }, free);
  expect_counted(
      "posix_memalign",
      [] {
        void* memory = nullptr;
        return posix_memalign(&memory, 256, 512) == 0 ? memory : nullptr;
      },
      free);
  expect_counted(
      "new", [] { return static_cast<void*>(new int(7)); },
      [](void* memory) { delete static_cast<int*>(memory); });
  expect_counted(
      "new[]", [] { return static_cast<void*>(new int[7]); },
      [](void* memory) { delete[] static_cast<int*>(memory); });
  expect_counted(
      "new (nothrow)", [] { return static_cast<void*>(new (std::nothrow) int(7)); },
      [](void* memory) { delete static_cast<int*>(memory); });
  expect_counted(
      "new of aligned types", [] { return static_cast<void*>(new Aligned); },
      [](void* memory) { delete static_cast<Aligned*>(memory); });
  expect_counted(
      "new[] of aligned types", [] { return static_cast<void*>(new Aligned[3]); },
      [](void* memory) { delete[] static_cast<Aligned*>(memory); });
  constexpr std::size_t kPage = 4096;
  expect_counted(
      "mmap",
      [] {
        return mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      },
      [](void* memory) {
        expect_counted(
            "mremap", [&] { return mremap(memory, kPage, 2 * kPage, MREMAP_MAYMOVE); },
            [](void* moved) { munmap(moved, 2 * kPage); });
      });
}

// The memory is what was asked for: zeros, contents kept, aligned.
TEST(AllocationCounter, LeavesAllocatorsAsTheyAre) {
  char* const zeros = static_cast<char*>(std::calloc(100, 3));
  for (int i = 0; i < 300; ++i) EXPECT_EQ(zeros[i], 0);
  zeros[299] = 5;
  char* const longer = static_cast<char*>(std::realloc(zeros, 1'000'000));
  EXPECT_EQ(longer[299], 5);
  std::free(longer);
  void* const aligned = std::aligned_alloc(1024, 2048);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(aligned) % 1024, 0u);
  std::free(aligned);
}

}  // namespace
}  // namespace palpate::test
