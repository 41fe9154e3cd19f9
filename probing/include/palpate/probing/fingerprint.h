// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// Sixteen hexadecimal digits that identify what was measured: all numbers and marks of the
/// contacts and samples. Different measurements have, in all likelihood, different fingerprints.
/// The order of contacts and samples, the ids, times and range maps of samples and the meta data do
/// not count.
[[nodiscard]] std::string fingerprint(const Acquisition& acquisition);

}  // namespace palpate::probing
