// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/build_options.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

namespace palpate::haptics {
namespace {

constexpr std::array<std::string_view, 3> kModes{"convex", "certified", "local"};
constexpr std::array<std::string_view, 3> kRules{"forces", "compliances", "auto"};
constexpr std::array<std::string_view, 2> kTriangulations{"delaunay", "voronoi_dual"};

constexpr int kBlended = 3;                                  // fields in a force that is rendered
constexpr double kMostBases = 1000;                          // more than any field has
constexpr double kLeastBudget = kBlended * kEvaluationCost;  // [us]

}  // namespace

void visit(BuildOptions& options, FieldVisitor& visitor) {
  visitor.begin("BuildOptions");
  visitor.real({"accuracy",
                "Stop fitting a contact at this RMS; 0: as accurate as the noise of the "
                "measurements allows",
                "N"},
               options.fit.accuracy, at_least(0));
  visitor.real({"budget",
                "Time to evaluate one force: it limits the number of bases of a field, at 0.01 us "
                "a base and three fields a force; a step of playback takes more (palpate play "
                "measures it)",
                "us"},
               options.budget, at_least(kLeastBudget).finite());
  visitor.choice({"passive",
                  "How a field is made passive: convex, everywhere by construction; certified, "
                  "proven within the reach of the measurements; local, only near zero"},
                 options.fit.mode, kModes);
  visitor.choice({"blend",
                  "What contacts give to places between them: forces, at the same displacement "
                  "(thesis 5.3.2); compliances, forces at displacements that match the compliance "
                  "of the place; auto, what predicts contacts better from those around them"},
                 options.blend_rule, kRules);
  visitor.real({"force_noise",
                "Standard deviation of each component of the measured forces, for fields and "
                "friction; none: estimated from forces that were repeated, at least 0.4 % of the "
                "largest force, and more if that does not explain the errors",
                "N"},
               options.force_noise, at_least(0).finite());
  visitor.real({"max_distance",
                "Reject a contact that is farther from the surface, after all contacts were moved "
                "onto it by one small rigid motion",
                "mm"},
               options.max_distance, at_least(0));
  visitor.whole({"max_left_out",
                 "Leave out up to this number of contacts that are too far from the surface, or "
                 "whose normal points into it, instead of rejecting the measurements; none: one in "
                 "50"},
                options.max_left_out, at_least(0));
  visitor.flag({"rate",
                "Where all contacts were only pressed, and samples have times: fit how forces "
                "depend on the rate, as in tissue, whose loading and unloading differ"},
               options.rate);
  visitor.flag({"estimate_offsets",
                "Where all contacts were only pressed: estimate a constant error of the forces and "
                "how deep below the surface the touches were found, and use them if the "
                "measurements support them"},
               options.estimate_offsets);
  visitor.whole({"dense_samples",
                 "Learn the local deformation around the tool from contacts with at least this "
                 "number of pairs of displacement and force, such as 40, and fit the others as "
                 "this local part plus a compliance of their own, if a test shows a gain (thesis "
                 "6.2.1.2); none: fit each contact alone"},
                options.dense_samples, at_least(kFewestDenseSamples));

  constexpr bool kExpert = true;
  visitor.choice({"triangulation",
                  "How contacts are triangulated: delaunay, the geodesic Delaunay triangulation; "
                  "voronoi_dual, the dual of the geodesic Voronoi cells, which may leave out "
                  "contacts on thin parts and near the border; for surfaces where delaunay fails",
                  "", kExpert},
                 options.triangulation, kTriangulations);
  visitor.whole(
      {"max_bases", "Largest number of bases of a field; none: that of the method", "", kExpert},
      options.fit.max_bases, at_least(1));
  visitor.real({"displacement_noise",
                "Standard deviation of each component of a displacement; none: estimated from the "
                "measurements",
                "mm", kExpert},
               options.fit.noise.displacement, at_least(0).finite());
  visitor.flag({"try_certified",
                "With passive convex, if noise does not explain the errors: also try fields with "
                "fewer bases and a certified one, and take the field that predicts best",
                "", kExpert},
               options.fit.try_certified);
  visitor.flag({"compare_always", "Do so even if noise explains the errors", "", kExpert},
               options.fit.compare_always);
  visitor.real(
      {"on_surface",
       "Contacts are not moved if the root mean square of their distances from the surface "
       "is at most this",
       "mm", kExpert},
      options.on_surface, at_least(0));
  visitor.real({"max_motion", "Largest motion of a contact onto the surface", "mm", kExpert},
               options.max_motion, at_least(0));
}

InvalidInput wrong_measurements(const std::string& problem) {
  return InvalidInput(std::vector<MessagePart>{{"build_model()", true}, {": " + problem}});
}

FitOptions fit_options(const BuildOptions& options) {
  FitOptions fit = options.fit;
  if (!options.budget) return fit;
  const int most =
      static_cast<int>(std::min(*options.budget / (kBlended * kEvaluationCost), kMostBases));
  const int usual = fit.mode == FitMode::convex ? kMaxConvexBases : kMaxLocalBases;
  fit.max_bases = std::min(most, fit.max_bases.value_or(usual));
  return fit;
}

}  // namespace palpate::haptics
