// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/memory_limit.h"

#include <cmath>

namespace palpate {

std::optional<std::string> beyond_memory_limit(double needed, double file_size) {
  const double most = kMemoryOfFile * file_size + kMemoryAllowance;
  if (needed <= most) return std::nullopt;
  constexpr double kMegabyte = 1e6;
  return "its content is so compressed that reading it takes " +
         std::to_string(std::llround(needed / kMegabyte)) + " MB; the limit is " +
         std::to_string(std::llround(most / kMegabyte)) +
         " MB, 64 times the file and 512 MB more. Write it without compression";
}

}  // namespace palpate
