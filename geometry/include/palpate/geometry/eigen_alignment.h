// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <type_traits>

/// Eigen chooses alignment and allocation of its matrices by compiler flags such as -mavx and
/// -fsanitize=address. Palpate and the programs that use it exchange matrices, so that both have to
/// make the same choice, whatever their flags. The CMake targets of Palpate pass it on.
#if EIGEN_MAX_ALIGN_BYTES != 16 || EIGEN_MAX_STATIC_ALIGN_BYTES != 16 || \
    !EIGEN_MALLOC_ALREADY_ALIGNED
#error \
    "Palpate: Eigen would lay out matrices in another way than the library does. Link a CMake target such as palpate::geometry, or compile with -DEIGEN_MAX_ALIGN_BYTES=16 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16 -DEIGEN_MALLOC_ALREADY_ALIGNED=1, in every file that includes Eigen."
#endif

static_assert(alignof(std::max_align_t) >= 16, "Palpate: malloc() has to align to 16 bytes.");
static_assert(std::is_same_v<Eigen::Index, std::ptrdiff_t> && !Eigen::Matrix3Xd::IsRowMajor,
              "Palpate: EIGEN_DEFAULT_DENSE_INDEX_TYPE and EIGEN_DEFAULT_TO_ROW_MAJOR have to keep "
              "their default values, as in the library.");
