// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// Sixteen hexadecimal digits that differ, in all likelihood, where what was measured does: a
/// number or a mark of a contact or of a sample, or how many there are. The order of contacts and
/// of samples, the samples' own ids, times and range maps and the meta data do not count, nor does
/// the file that they come from.
[[nodiscard]] std::string fingerprint(const Acquisition& acquisition);

}  // namespace palpate::probing
