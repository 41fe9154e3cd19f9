// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::test {

/// Calls so far, of this program and of every library that it uses, that take memory from the heap
/// or from the system: malloc, calloc, realloc, aligned_alloc, posix_memalign, memalign, valloc,
/// pvalloc, mmap and mremap. Every `operator new` ends in one of them.
[[nodiscard]] long allocations();

/// False under the sanitizers, whose own allocators must not be replaced.
[[nodiscard]] bool counts_allocations();

}  // namespace palpate::test
