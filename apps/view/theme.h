// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace palpate::view {

/// A colour from its three bytes, 0xRRGGBB.
[[nodiscard]] inline Eigen::Vector3f color(unsigned rgb) {
  constexpr float kByte = 255;
  return {static_cast<float>((rgb >> 16) & 255u) / kByte,
          static_cast<float>((rgb >> 8) & 255u) / kByte, static_cast<float>(rgb & 255u) / kByte};
}

// The colours of the page of a model (web/page/page.css).
inline constexpr unsigned kSky = 0xfbfcfe, kFloor = 0xd5dde7, kSurface = 0xe3b49a, kBack = 0x94a1b2,
                          kDent = 0xcf5b3c, kTool = 0x2c3643, kForce = 0x1a5fd0, kDot = 0x4a3328,
                          kFree = 0x68737f, kStick = 0x1d7f43, kSlip = 0xb84a06, kPanel = 0xffffff,
                          kText = 0x171c23, kQuiet = 0x59636f, kLine = 0xd9dfe6, kNormal = 0x0a8178,
                          kTangential = 0xb3318d;

}  // namespace palpate::view
