// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// The measurements of one trial (thesis 4.4.2): the tip at rest under the normal force, then with
/// the tangential force added, then with the tangential force removed again. All in one frame.
struct SlipTrial {
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();           ///< [mm] the surface at the touch
  Eigen::Vector3d normal_force = Eigen::Vector3d::Zero();      ///< [N] on the object; not 0
  Eigen::Vector3d tangential_force = Eigen::Vector3d::Zero();  ///< [N] not 0
  Eigen::Vector3d a = Eigen::Vector3d::Zero();                 ///< [mm] under the normal force
  Eigen::Vector3d b = Eigen::Vector3d::Zero();                 ///< [mm] under both
  Eigen::Vector3d a_again = Eigen::Vector3d::Zero();           ///< [mm] under the normal force
  /// [mm] by which the object would have crept from `a` to `a_again` anyway: the rate at the end of
  /// settling at `a`, times the time between the two.
  Eigen::Vector3d creep = Eigen::Vector3d::Zero();
  bool fell_off = false;  ///< the tip left the object at any time after `a`
};

struct SlipOptions {
  double position_deviation = 0.02;  ///< [mm] standard deviation of a position at rest; > 0
  double force_deviation = 0.005;    ///< [N] standard deviation of an applied force; >= 0
  /// A trial slipped if T^2 > threshold; > 0. 16.27 is exceeded by chance once in 1000 (chi^2 with
  /// 3 degrees of freedom). `allowed_threshold` learns a smaller one from other trials.
  double threshold = 16.27;
  /// Share of the tangential displacement that may stay without slipping, because the edge of a
  /// round contact slips before its centre does; in [0, 0.3]. By Mindlin's theory it is 0.16 at 0.9
  /// of the limit and 0.26 at the limit if all compliance is that of the contact, and 0 if it is
  /// that of a thin sheet. `allowed_microslip` learns it from the contact's other trials.
  double microslip = 0.17;
};

struct SlipJudgement {
  bool slipped = false;
  double t_squared = 0;  ///< infinite if the tip fell off
  double distance = 0;   ///< [mm] by which the tip did not return, without creep
};

/// Judges whether the tip slipped: whether it did not return to where it was, by more than the
/// noise of positions, and of forces times the compliance that the trial itself measured, explains.
/// T^2 = d^T S^-1 d with S = 2 (s_x^2 I + s_f^2 C C^T), where d is a_again - a without creep and
/// without the part along b - a that microslip explains. Real-time safe.
/// A trial with numbers that are not finite, or without forces, is neither held nor slipped.
[[nodiscard]] std::optional<SlipJudgement> judge_slip(const SlipTrial& trial,
                                                      const SlipOptions& options = {}) noexcept;

/// Evidence of microslip from a drag that held.
struct HeldDrag {
  double ratio = 0;            ///< tangential force per normal force; > 0
  double share = 0;            ///< of the tangential displacement, by which the tip did not return
  double share_deviation = 0;  ///< standard deviation of that by noise; > 0
};

/// Of a complete trial; nothing if it has no tangential displacement or is not finite.
[[nodiscard]] std::optional<HeldDrag> held_drag(const SlipTrial& trial,
                                                const SlipOptions& options = {}) noexcept;

/// `SlipOptions::microslip` for a trial with the given ratio of tangential to normal force at a
/// contact where `drags` held: the share that microslip may leave if that ratio is the friction
/// limit, extrapolated from the drags by Mindlin's theory, plus one standard deviation. At most
/// `most`, which is also the answer without drags. The extrapolation holds for any division of the
/// compliance between object and contact: it never rises less than theory does.
[[nodiscard]] double allowed_microslip(std::span<const HeldDrag> drags, double ratio,
                                       double most = SlipOptions{}.microslip) noexcept;

/// Returns `SlipOptions::threshold` after trials that held, with these T^2 (those of a whole
/// campaign: their scale is that of the noise of the arm). If the stated noise is too large, they
/// are small, and slides hide below the usual threshold. The result is exceeded by chance at most
/// once in 10,000, even if noise in one direction dominates. At most `most`, which is also the
/// result before 12 trials held; at least a sixteenth of it, for stated noise four times too large.
[[nodiscard]] double allowed_threshold(std::span<const double> held,
                                       double most = SlipOptions{}.threshold);

/// [mm/N] The symmetric compliance that a trial measured: a - contact per normal force, b - a per
/// tangential force, and across both the larger of the two. Real-time safe.
[[nodiscard]] Eigen::Matrix3d measured_compliance(const SlipTrial& trial) noexcept;

}  // namespace palpate::probing
