// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::sensing {

/// Averages a row with binomial weights over five pixels, `averages` times, each with twice the
/// spacing of the one before; values whose pixels are not all in the row stay unchanged.
/// \param in, out `columns` values each, of different arrays.
void average_row(const float* in, int averages, float* out, long columns);

}  // namespace palpate::sensing
