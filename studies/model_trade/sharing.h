// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::bench {

/// Measures the benefit of a local part that contacts share: prints the table of "Fewer samples by
/// a shared local part" in docs/trade-model.md. On objects of `seeds` seeds each, six contacts are
/// probed densely, and the others with few samples.
void measure_sharing(unsigned seeds);

}  // namespace palpate::bench
