// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace palpate::pictures {

/// [mm] Depths that the colours of a picture span; low < high.
struct DepthSpan {
  double low = 0, high = 1;
};

/// The span of finite depths [mm] without the nearest and the farthest 0.5 %, so that a few wrong
/// ones do not hide the shape; at least one depth.
[[nodiscard]] DepthSpan depth_span(std::vector<double> depths);

}  // namespace palpate::pictures
