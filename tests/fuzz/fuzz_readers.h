// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// Returns why the reader that PALPATE_READER names refuses a file of these bytes, in words of its
/// FileError or InvalidInput; empty if it reads the file.
[[nodiscard]] std::string refusal_of(const std::uint8_t* data, std::size_t size);
