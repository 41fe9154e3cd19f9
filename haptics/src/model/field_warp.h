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

/// A compliance in axes that are turned about z: `turn` takes coordinates in its own axes to those
/// in the others. Linear. Real-time safe.
[[nodiscard]] Compliance turned(const Compliance& compliance, const Eigen::Matrix2d& turn) noexcept;

/// The turn about z from one frame to another: `from` is carried by the smallest rotation of its z
/// axis onto that of `to`; the result is the upper left block of the rotation from coordinates in
/// the carried frame to those in `to`. Real-time safe.
[[nodiscard]] Eigen::Matrix2d turn_between(const Eigen::Matrix3d& from,
                                           const Eigen::Matrix3d& to) noexcept;

/// The compliance of a place between contacts with the weights w_k >= 0, in `frame`, whose z axis
/// is the inward normal of the place. Contacts without a compliance do not count; at least one with
/// a weight > 0 must have one. `contacts` and `pressing_frames` are all of the model's, `indices`
/// those of the weights. Real-time safe.
//
// With x the place, m = sum w_k x_k, and u = m - x_k and v = x - m (shortened to `reach`) along the
// x and y axes of the pressing frame of contact k, it is sum w_k (D_k + (2/3) G_k u + (1/6) u^T H_k
// u + G_k v + u^T H_k v + (1/2) v^T H_k v), each term turned into `frame`, with the gradients G_k
// and second derivatives H_k of the contacts' trends: exact for cubic functions of the place inside
// flat triangles of contacts, quadratic beyond. A difference from sum w_k D_k of more than
// kMaxChange of it is shortened to that.
[[nodiscard]] Compliance compliance_between(const std::vector<ContactModel>& contacts,
                                            std::span<const Eigen::Matrix3d> pressing_frames,
                                            std::span<const int> indices,
                                            std::span<const double> weights,
                                            const Eigen::Vector3d& place,
                                            const Eigen::Matrix3d& frame, double reach) noexcept;

/// Relative to the weighted mean of the contacts' compliances. A place is never more than four
/// times as stiff as that, and its compliance stays positive definite.
inline constexpr double kMaxChange = 0.75;

/// The warp that turns a convex field with the compliance `from` into a convex field with the
/// compliance `to`: it gives the same force along z at the displacement of `to`, with the stiffness
/// across of `to` there. The identity if the compliances are equal. Real-time safe.
[[nodiscard]] FieldWarp warp_between(const Compliance& from, const Compliance& to) noexcept;

}  // namespace palpate::haptics
