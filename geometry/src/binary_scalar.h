// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <string>

namespace palpate::geometry {

/// Types of the numbers in PLY and PCD files.
enum class Scalar { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

[[nodiscard]] std::size_t size_of(Scalar type);

/// Reads one number from `size_of(type)` bytes. Integers beyond 2^53 are rounded.
[[nodiscard]] double load(Scalar type, std::endian order, const char* bytes);

/// Appends a number, least significant byte first.
void append_little_endian(std::string& bytes, double value);
void append_little_endian(std::string& bytes, int value);

}  // namespace palpate::geometry
