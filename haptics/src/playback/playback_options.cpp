// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string_view>

#include "palpate/haptics/playback.h"

namespace palpate::haptics {
namespace {

constexpr std::array<std::string_view, 3> kMotions{"bracketed", "brent", "friction_boundary"};

}  // namespace

void visit(PlaybackOptions& options, FieldVisitor& visitor) {
  visitor.begin("PlaybackOptions");
  visitor.real({"unknown_friction",
                "Coefficient of friction of contacts where the measurements do not tell it, as "
                "usual for objects that were only pressed"},
               options.unknown_friction, at_least(0).finite());
  visitor.real({"tolerance",
                "A contact sticks while the tangential force exceeds the friction cone by at most "
                "this; a slip ends when it is within this again",
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
                "(docs/trade-playback.md)",
                "N mm", kExpert},
               options.energy_credit, at_least(0));
  visitor.real(
      {"largest_jump",
       "Largest change of the force in a tick, besides what the stiffness of the object at "
       "the contact gives for the movement of the tool",
       "N", kExpert},
      options.largest_jump, above(0));
  visitor.real(
      {"start_depth",
       "A tool up to this far inside when the loop starts touches the nearest point of the "
       "surface; deeper ones start free",
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

}  // namespace palpate::haptics
