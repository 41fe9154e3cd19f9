// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/unmixing.h"

#include <Eigen/LU>
#include <array>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

struct Unmixing {
  float value[3][3];
};

PALPATE_HOT_LOOP void unmix_values(float* __restrict a, float* __restrict b, float* __restrict c,
                                   Unmixing by, long count) {
  const auto& m = by.value;
  for (long i = 0; i < count; ++i) {
    const float x = a[i];
    const float y = b[i];
    const float z = c[i];
    a[i] = m[0][0] * x + m[0][1] * y + m[0][2] * z;
    b[i] = m[1][0] * x + m[1][1] * y + m[1][2] * z;
    c[i] = m[2][0] * x + m[2][1] * y + m[2][2] * z;
  }
}

/// Places of green, red and blue in the mixing.
constexpr std::array<int, 3> kPlaces = {1, 0, 2};

}  // namespace

void unmix(const Eigen::Matrix3d& mixing, std::vector<Demodulated>& channels) {
  if (channels.size() != 3 || mixing.isIdentity(0)) return;
  const Eigen::Matrix3d inverse = mixing.inverse();
  Unmixing by{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      by.value[row][column] = static_cast<float>(inverse(kPlaces[row], kPlaces[column]));
  }
  Demodulated& green = channels[0];
  Demodulated& red = channels[1];
  Demodulated& blue = channels[2];
  unmix_values(green.re.data(), red.re.data(), blue.re.data(), by, green.re.size());
  unmix_values(green.im.data(), red.im.data(), blue.im.data(), by, green.im.size());
}

}  // namespace palpate::sensing
