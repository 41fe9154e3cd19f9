// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::bench {

/// Prints how far displayed surfaces of a solid of finite elements are from the true ones, at
/// places and displacements that were not recorded.
void measure_shapes();

}  // namespace palpate::bench
