// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "allocation_counter.h"

#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>

namespace {
std::atomic<long> count = 0;
}  // namespace

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
namespace palpate::test {
bool counts_allocations() { return false; }
}  // namespace palpate::test
#else
namespace palpate::test {
bool counts_allocations() { return true; }
}  // namespace palpate::test

// The functions of the C library under the names by which all libraries call them. The real ones
// have a second name in glibc, except for those of alignment, which all end in memalign, and for
// those of the system.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier)
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  ++count;
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) noexcept {
  ++count;
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  ++count;
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++count;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  void* const made = memalign(alignment, size);
  if (!made) return ENOMEM;
  *memory = made;
  return 0;
}
void* valloc(std::size_t size) noexcept {
  return memalign(static_cast<std::size_t>(sysconf(_SC_PAGESIZE)), size);
}
void* pvalloc(std::size_t size) noexcept {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return memalign(page, (size + page - 1) / page * page);
}
void* mmap(void* address, std::size_t length, int protection, int flags, int file,
           off_t offset) noexcept {
  ++count;
  return reinterpret_cast<void*>(
      syscall(SYS_mmap, address, length, protection, flags, file, offset));
}
void* mmap64(void* address, std::size_t length, int protection, int flags, int file,
             off64_t offset) noexcept {
  return mmap(address, length, protection, flags, file, offset);
}
void* mremap(void* address, std::size_t length, std::size_t new_length, int flags, ...) noexcept {
  ++count;
  va_list more;
  va_start(more, flags);
  void* const to = va_arg(more, void*);  // of use with MREMAP_FIXED alone
  va_end(more);
  return reinterpret_cast<void*>(syscall(SYS_mremap, address, length, new_length, flags, to));
}
}
#endif

namespace palpate::test {
long allocations() { return count; }
}  // namespace palpate::test
