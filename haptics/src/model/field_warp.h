// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {

/// The six numbers of `ContactCompliance::values`.
using Compliance = Eigen::Vector<double, 6>;

/// A compliance in axes that are turned against its own about z: `turn` takes own coordinates to
/// the others'. Linear. Real-time safe.
[[nodiscard]] Compliance turned(const Compliance& compliance, const Eigen::Matrix2d& turn) noexcept;

/// How axes of a frame lie to those of another place: the upper left block of the rotation from
/// coordinates in `from`, carried there by the smallest turn of its z axis onto that of `to`, to
/// coordinates in `to`. So it does not matter which x axis a contact has. Real-time safe.
[[nodiscard]] Eigen::Matrix2d turn_between(const Eigen::Matrix3d& from,
                                           const Eigen::Matrix3d& to) noexcept;

/// The compliance at a place between contacts with weights w_k >= 0, at least one of them known and
/// of weight > 0; unknown ones do not count. In `frame`, z along the place's inward normal.
/// `contacts` and their `pressing_frames` are all of the model's, `indices` those of the weights.
/// Each contact's part is turned into the frame by `turn_between`. With x the place, m = sum w_k
/// x_k, and u = m - x_k and v = x - m (shortened to `reach`) along the x and y axes of the pressing
/// frame of contact k, it is sum w_k (D_k + (2/3) G_k u + (1/6) u^T H_k u + G_k v + u^T H_k v +
/// (1/2) v^T H_k v) with the gradients G_k and second derivatives H_k of the contacts' trends:
/// exact for cubic functions of the place inside flat triangles of contacts, quadratic beyond.
/// Where that differs from sum w_k D_k by more than kMaxChange of it, it is only so far from it.
/// Real-time safe.
[[nodiscard]] Compliance compliance_between(const std::vector<ContactModel>& contacts,
                                            std::span<const Eigen::Matrix3d> pressing_frames,
                                            std::span<const int> indices,
                                            std::span<const double> weights,
                                            const Eigen::Vector3d& place,
                                            const Eigen::Matrix3d& frame, double reach) noexcept;

/// Relative to the weighted mean of the contacts' compliances: a place is never more than four
/// times as stiff as that, and stays as positive.
inline constexpr double kMaxChange = 0.75;

/// The warp that turns a convex field with the compliance `from` into a convex one with the
/// compliance `to`: the same force along z at the displacement of `to`, and the stiffness across it
/// there. The identity if they are equal. Real-time safe.
[[nodiscard]] FieldWarp warp_between(const Compliance& from, const Compliance& to) noexcept;

}  // namespace palpate::haptics
