// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace palpate {

/// Reading a file takes at most this many times its size as memory ...
inline constexpr double kMemoryOfFile = 64;
/// ... and this more [bytes], unless the user allows more:
inline constexpr double kMemoryAllowance = 512e6;

/// The environment variable that raises the memory limit of reading a file [GB], for programs and
/// for their users.
inline constexpr const char* kMemoryVariable = "PALPATE_MAX_READ_GB";

/// Checks compressed content before memory is allocated; content without compression needs less.
/// \param needed [bytes] to read the file.
/// \param file_size [bytes]
/// \return what is wrong, as the end of a sentence about the file, if that is beyond the limit.
/// \throws InvalidInput naming the environment variable if it is no number above 0.
[[nodiscard]] std::optional<std::string> beyond_memory_limit(double needed, double file_size);

}  // namespace palpate
