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
                "Stop adding bases to the field of a contact when the RMS of its force errors is "
                "at most this; 0: as accurate as the noise of the measurements allows",
                "N"},
               options.fit.accuracy, at_least(0));
  visitor.real({"budget",
                "Time to evaluate one force: it limits the number of bases of a field, at 0.01 us "
                "a base and three fields a force; a step of playback takes more (palpate play "
                "measures it). Without it, the method limits them",
                "us"},
               options.budget, at_least(kLeastBudget).finite());
  visitor.choice({"passive",
                  "How a field is made passive: convex, everywhere by construction; certified, "
                  "proven within the reach of the measurements; local, only near zero"},
                 options.fit.mode, kModes);
  visitor.choice({"blend",
                  "How forces between contacts are found: forces, at the same displacement "
                  "(thesis 5.3.2), scaled to the strength of the point; compliances, forces at "
                  "displacements that match the compliance "
                  "of the point; auto, what predicts contacts better from those around them"},
                 options.blend_rule, kRules);
  visitor.real({"force_noise",
                "Standard deviation of each component of the measured forces, for fields and "
                "friction. Without it: estimated from forces that were repeated, at least 0.4 % of "
                "the largest force, and more if that does not explain the errors",
                "N"},
               options.force_noise, at_least(0).finite());
  visitor.real({"max_distance",
                "Largest distance of a contact from the surface, after all contacts were moved "
                "onto it by one small rigid motion; see max_left_out for those beyond",
                "mm"},
               options.max_distance, at_least(0));
  visitor.whole({"max_left_out",
                 "Number of contacts that may be left out because they are too far from the "
                 "surface, or because their normal points into it; with more, the measurements are "
                 "refused. Without it: one in 50, rounded down"},
                options.max_left_out, at_least(0));
  visitor.flag(
      {"rate",
       "Fit how forces depend on the rate, as in tissue, whose loading and unloading differ; "
       "refused unless all contacts were only pressed and their samples have times"},
      options.rate);
  visitor.flag(
      {"estimate_offsets",
       "Estimate the offset of the force sensor and how deep below the surface the touches were "
       "found, if all contacts were only pressed, and use them if the measurements support them"},
      options.estimate_offsets);
  visitor.whole({"dense_samples",
                 "Learn the local deformation around the tool from contacts with at least this "
                 "number of pairs of displacement and force, such as 40, and fit the others as "
                 "this local part plus a compliance of their own, if a test shows a gain (thesis "
                 "6.2.1.2). Without it: each contact is fitted alone"},
                options.dense_samples, at_least(kFewestDenseSamples));

  constexpr bool kExpert = true;
  visitor.choice({"triangulation",
                  "How contacts are triangulated: delaunay, the geodesic Delaunay triangulation; "
                  "voronoi_dual, the dual of the geodesic Voronoi cells, which may leave out "
                  "contacts on thin parts and near the border; for surfaces where delaunay fails",
                  "", kExpert},
                 options.triangulation, kTriangulations);
  visitor.whole(
      {"max_bases",
       "Largest number of bases of a field. Without it: 14 with passive convex, 6 otherwise", "",
       kExpert},
      options.fit.max_bases, at_least(1));
  visitor.real({"displacement_noise",
                "Standard deviation of each component of a displacement. Without it: estimated "
                "from the measurements",
                "mm", kExpert},
               options.fit.noise.displacement, at_least(0).finite());
  visitor.flag({"try_certified",
                "Also try fields with fewer bases and a certified one, with passive convex and if "
                "noise does not explain the errors, and take the field that predicts best",
                "", kExpert},
               options.fit.try_certified);
  visitor.flag(
      {"compare_always", "Make the comparison of try_certified even if noise explains the errors",
       "", kExpert},
      options.fit.compare_always);
  visitor.real(
      {"on_surface",
       "Contacts are not moved if the root mean square of their distances from the surface "
       "is at most this",
       "mm", kExpert},
      options.on_surface, at_least(0));
  visitor.real(
      {"max_motion",
       "If a contact would have to move farther than this onto the surface, no contact is moved",
       "mm", kExpert},
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
