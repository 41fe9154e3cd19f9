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

/// A compliance in axes that are rotated against its own about z: `turn` maps its own coordinates
/// to the others. Linear. Real-time safe.
[[nodiscard]] Compliance turned(const Compliance& compliance, const Eigen::Matrix2d& turn) noexcept;

/// Relation of the x and y axes of two frames: the upper left block of the rotation from
/// coordinates in `from` to coordinates in `to`, after `from` was carried there by the smallest
/// rotation of its z axis onto that of `to`. Therefore a contact's x axis does not matter.
/// Real-time safe.
[[nodiscard]] Eigen::Matrix2d turn_between(const Eigen::Matrix3d& from,
                                           const Eigen::Matrix3d& to) noexcept;

/// Interpolates the compliance at a place between contacts with weights w_k >= 0, of which at least
/// one with weight > 0 is known; unknown ones are ignored. The result is in `frame`, with z along
/// the place's inward normal. Real-time safe.
///
/// Each contact's part is rotated into the frame by `turn_between`. With the place x and the mean m
/// = sum w_k x_k, let u = m - x_k and v = x - m (shortened to `reach`), along the x and y axes of
/// the pressing frame of contact k. With the gradients G_k and second derivatives H_k of the
/// contacts' trends the compliance is sum w_k (D_k + (2/3) G_k u + (1/6) u^T H_k u + G_k v + u^T
/// H_k v + (1/2) v^T H_k v). This is exact for cubic functions of the place inside flat triangles
/// of contacts, and quadratic outside. The deviation from sum w_k D_k is limited to kMaxChange of
/// it.
/// \param contacts, pressing_frames those of all contacts of the model.
/// \param indices contacts that the weights belong to.
[[nodiscard]] Compliance compliance_between(const std::vector<ContactModel>& contacts,
                                            std::span<const Eigen::Matrix3d> pressing_frames,
                                            std::span<const int> indices,
                                            std::span<const double> weights,
                                            const Eigen::Vector3d& place,
                                            const Eigen::Matrix3d& frame, double reach) noexcept;

/// Ratio of the resistance of a place to the weighted mean of its contacts: 1 + the change of their
/// strengths towards the place, which is computed as in `compliance_between` and limited to
/// kMaxChange, relative to the mean of their strengths. 1 if none is known, or all are 0. Real-time
/// safe.
[[nodiscard]] double strength_factor(const std::vector<ContactModel>& contacts,
                                     std::span<const int> indices, std::span<const double> weights,
                                     const Eigen::Vector3d& place, double reach) noexcept;

/// Relative to the weighted mean of the contacts' compliances: a place is at most four times as
/// stiff as the mean, and its compliance stays positive.
inline constexpr double kMaxChange = 0.75;

/// `mean` + `change`, with the change limited to kMaxChange of the mean. Real-time safe.
[[nodiscard]] Compliance limited(const Compliance& mean, const Compliance& change) noexcept;

/// The warp that maps a convex field with the compliance `from` to a convex one with the compliance
/// `to`: it has the same force along z at the displacement of `to`, and there the transverse
/// stiffness of `to`. The identity if both are equal. Real-time safe.
[[nodiscard]] FieldWarp warp_between(const Compliance& from, const Compliance& to) noexcept;

}  // namespace palpate::haptics
