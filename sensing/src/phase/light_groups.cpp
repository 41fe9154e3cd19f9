// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/light_groups.h"

namespace palpate::sensing {

LinearInLight fit_light(const std::vector<LightGroup>& groups) {
  // Sums over the rows (a, b) = (1, light) / value of equations whose right side is 1.
  double n = 0, a = 0, aa = 0, ab = 0, b = 0, bb = 0;
  for (const LightGroup& group : groups) {
    if (!(group.value > 0)) continue;
    const double one = 1 / group.value;
    const double light = group.light / group.value;
    n += 1, a += one, aa += one * one, ab += one * light, b += light, bb += light * light;
  }
  if (n == 0) return {};
  const double determinant = aa * bb - ab * ab;
  // Below this share of the product of the diagonal all groups are equally bright.
  constexpr double kLeastDeterminant = 1e-6;
  if (determinant > kLeastDeterminant * aa * bb) {
    const LinearInLight line{(bb * a - ab * b) / determinant, (aa * b - ab * a) / determinant};
    if (line.constant >= 0 && line.slope >= 0) return line;
    if (line.constant < 0) return {0, b / bb};
  }
  return {a / aa, 0};
}

}  // namespace palpate::sensing
