// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string_view>

#include "model/measured_reach.h"
#include "palpate/core/require.h"
#include "palpate/haptics/playback.h"

namespace palpate::haptics {
namespace {

constexpr std::array<std::string_view, 3> kMotions{"bracketed", "brent", "friction_boundary"};

// Relative to the force up to which the model was measured, ...
constexpr double kTolerance = 5e-5, kLargestJump = 0.03;
// ... to the energy that a press up to it stores, as in a spring, ...
constexpr double kEnergyCredit = 0.0015;
// ... and to the diagonal of the surface.
constexpr double kStartDepth = 0.1;

}  // namespace

void visit(PlaybackOptions& options, FieldVisitor& visitor) {
  visitor.begin("PlaybackOptions");
  visitor.real({"unknown_friction",
                "Coefficient of friction of contacts where the measurements do not tell it, as "
                "usual for objects that were only pressed"},
               options.unknown_friction, at_least(0).finite());
  visitor.real(
      {"tolerance",
       "A contact sticks while the tangential force exceeds the friction cone by at most "
       "this; a slip ends when it is within this again. Without it: 5e-5 of the force up to "
       "which the model was measured",
       "N"},
      options.tolerance, above(0).finite());

  constexpr bool kExpert = true;
  visitor.choice(
      {"motion",
       "How a slipping contact moves: bracketed finds a root of |f_T| - mu f_N (Eq 5.17) "
       "by bracketing, brent a minimum of h(t) (Eq 5.18), and friction_boundary follows "
       "the tool's way beyond the friction boundary",
       "", kExpert},
      options.motion, kMotions);
  visitor.real({"energy_credit",
                "Largest net energy that the object may give to the user from touch to release, "
                "with the motion bracketed; a slip that would give more ends early; inf: no limit "
                "(docs/trade-playback.md). Without it: 0.0015 of the energy that a press up to the "
                "measured force stores",
                "N mm", kExpert},
               options.energy_credit, at_least(0));
  visitor.real(
      {"largest_jump",
       "Largest change of the force in a tick, besides what the stiffness of the object at "
       "the contact gives for the movement of the tool. Without it: 0.03 of the measured force",
       "N", kExpert},
      options.largest_jump, above(0));
  visitor.real(
      {"start_depth",
       "A tool up to this far inside when the loop starts touches the nearest point of the "
       "surface; deeper ones start free. Without it: a tenth of the diagonal of the surface",
       "mm", kExpert},
      options.start_depth, at_least(0));
  visitor.real({"longest_step", "A longer movement in one tick is taken for a fault of the device",
                "mm", kExpert},
               options.longest_step, above(0));
  visitor.whole({"hold_ticks",
                 "Number of faulty ticks for which the contact is kept while the force decays to "
                 "zero",
                 "ticks", kExpert},
                options.hold_ticks, at_least(0));
}

PlaybackOptions playback_options_for(const Model& model, const PlaybackOptions& options) {
  PlaybackOptions result = in_range(options);
  const MeasuredReach reach = measured_reach(model);
  const double stored = reach.force * reach.depth / 2;
  result.tolerance = result.tolerance.value_or(kTolerance * reach.force);
  result.energy_credit = result.energy_credit.value_or(kEnergyCredit * stored);
  result.largest_jump = result.largest_jump.value_or(kLargestJump * reach.force);
  result.start_depth =
      result.start_depth.value_or(kStartDepth * geometry::bounding_diagonal(model.surface));
  return result;
}

}  // namespace palpate::haptics
