// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::bench {

/// Measures whether models state their errors rightly (`BlendedField::deviation`), on objects that
/// were pressed and dragged: prints the table of "Stated errors" in docs/trade-model.md.
/// `only`: the kinds whose name contains this. `seed`: of the objects that are drawn.
void measure_stated_errors(const std::string& only, unsigned seed);

}  // namespace palpate::bench
