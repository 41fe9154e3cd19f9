// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before a plain function over arrays that is worth compiling once for each generation of
/// processors; the loader picks one. Sanitizers and unoptimised builds get one version. Results are
/// the same in all: the build forbids fused multiply-add.
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PALPATE_HOT_LOOP \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define PALPATE_HOT_LOOP
#endif
