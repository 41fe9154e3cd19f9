// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Put before a loop whose iterations do not access data that another iteration writes.
#if defined(__clang__)
#define PALPATE_INDEPENDENT_PASSES _Pragma("clang loop vectorize(assume_safety)")
#else
#define PALPATE_INDEPENDENT_PASSES _Pragma("GCC ivdep")
#endif

/// Put before a plain function over arrays to compile it once for each generation of processors;
/// the loader selects one version at run time. Only for functions of one source: before version 18
/// of clang, other sources do not find the versions. Builds with sanitizers or without optimisation
/// have one version. All versions give the same results, because the build forbids fused
/// multiply-add. The versions are named by features: clang 14 also accepts levels such as
/// x86-64-v3, but does not select by them.
/// Pass neighbouring pixels as pointers of their own: from `in[i - 1]` and `in[i + 1]` of one
/// pointer, clang makes values that each pass hands to the next, and then vectorises nothing.
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PALPATE_HOT_LOOP __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PALPATE_HOT_LOOP
#endif
