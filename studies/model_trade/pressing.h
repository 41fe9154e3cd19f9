// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::bench {

/// Measures models of pressing-only acquisitions: prints the table of "Pressing only" in
/// docs/trade-model.md. Ten-fold over places, beside linear interpolation and a Gaussian process.
/// `only`: the kinds whose name contains this. `seed`: of the objects and their noise.
void measure_pressing(const std::string& only, unsigned seed);

}  // namespace palpate::bench
