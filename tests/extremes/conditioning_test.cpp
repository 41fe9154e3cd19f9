// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Whoever loses half of its digits says so: where a change of the input in the 40th binary digit
// shows in the 13th of a result, the result states an error that covers it, or carries a word.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "boards.h"
#include "findings.h"
#include "palpate/haptics/force_field.h"

namespace palpate::extremes {
namespace {

using Eigen::Vector3d;

/// Relative change of the input, and the largest of a result that needs no word.
constexpr double kNudge = 0x1p-40, kHalfOfTheDigits = 0x1p-13;
/// Of what is nearly singular: how far it is from it, relative to its size.
constexpr double kNearly = 1e-9;

/// An input on which something is nearly not determined.
struct Nearly {
  std::string name;
  unsigned parts = 0;  ///< of the input that it changes
  std::function<void(Input&)> make;
};

const std::vector<Nearly>& inputs() {
  static const std::vector<Nearly> all = {
      {"standard", ~0U, [](Input&) {}},
      {"sheet nearly flat", kSheet, [](Input& input) { input.sheet.vertices.row(2) *= kNearly; }},
      {"sheet nearly a strip", kSheet, [](Input& input) { input.sheet.vertices.row(1) *= 1e-4; }},
      {"ball nearly a sphere", kBall,
       [](Input& input) {
         for (auto vertex : input.ball.vertices.colwise())
           vertex = vertex.normalized() * (20 + kNearly * vertex.x());
       }},
      {"ball nearly flat", kBall, [](Input& input) { input.ball.vertices.row(2) *= 1e-4; }},
      {"cloud nearly a plane", kCloud, [](Input& input) { input.cloud.row(2) *= kNearly; }},
      {"cloud nearly a line", kCloud, [](Input& input) { input.cloud.bottomRows(2) *= kNearly; }},
      {"contacts of one row", kContacts, [](Input& input) { input.contacts.resize(4); }},
      {"contacts nearly at one place", kContacts,
       [](Input& input) {
         geometry::SurfacePoint& next = input.contacts[1];
         next = input.contacts[0];
         next.barycentric += kNearly * Vector3d(1, -1, 0);
       }},
      {"displacements nearly in a line", kSamples,
       [](Input& input) {
         const haptics::ForceField field{{{3, 4, {0.3, -0.2, 0.5}}, {2, 6, {-0.4, 0.1, 0.2}}}};
         input.displacements.topRows(2) *= kNearly;
         for (Eigen::Index i = 0; i < input.displacements.cols(); ++i)
           input.forces.col(i) = haptics::force(field, input.displacements.col(i));
       }},
      {"trials nearly in a direction", kTrials,
       [](Input& input) {
         for (haptics::FrictionTrial& trial : input.trials)
           trial.force = {trial.force.head<2>().norm(), kNearly * trial.force.y(), trial.force.z()};
       }},
      {"boards nearly parallel", kViews,
       [](Input& input) { input.views = views_of_board(5, 1e-4); }},
      {"boards that are tilted little", kViews,
       [](Input& input) { input.views = views_of_board(5, 0.18); }},
      {"drags nearly nothing", kAcquisition, [](Input& input) {
         for (probing::Sample& sample : input.acquisition.samples) {
           sample.b = sample.a + kNearly * (sample.b - sample.a);
           for (const probing::Contact& contact : input.acquisition.contacts) {
             if (contact.id != sample.contact) continue;
             const Vector3d press = sample.force.dot(contact.normal) * contact.normal;
             sample.force = press + kNearly * (sample.force - press);
           }
           sample.slipped = sample.on_friction_boundary = false;
         }
       }}};
  return all;
}

/// Changes all coordinates and forces at random, each relative to what it belongs to.
Input nudged(Input input, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-kNudge, kNudge);
  const auto nudge = [&](auto&& values, double size) {
    for (double& value : values.reshaped()) value += size * unit(random);
  };
  const double size = size_of(input);
  for (Eigen::Matrix3Xd* points :
       {&input.sheet.vertices, &input.ball.vertices, &input.cloud, &input.places})
    nudge(*points, points->cwiseAbs().maxCoeff());
  nudge(input.displacements, input.displacements.cwiseAbs().maxCoeff());
  nudge(input.forces, input.forces.cwiseAbs().maxCoeff());
  for (haptics::FrictionTrial& trial : input.trials) nudge(trial.force, trial.force.norm());
  for (probing::Contact& contact : input.acquisition.contacts) nudge(contact.position, size);
  for (probing::Sample& sample : input.acquisition.samples) {
    nudge(sample.force, sample.force.norm());
    nudge(sample.a, size);
    nudge(sample.b, size);
  }
  for (sensing::RigView& view : input.views)
    for (Eigen::Matrix2Xd* pixels : {&view.camera, &view.lit_camera, &view.projector})
      nudge(*pixels, pixels->cwiseAbs().maxCoeff());
  for (haptics::TrajectoryPoint& point : input.trajectory) nudge(point.tool, size);
  return input;
}

/// How much a result changed.
struct Nudge {
  double relative = 0, absolute = 0;
};

Nudge change_of(const Result& was, const Result& is, double size) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (was.values.rows() != is.values.rows() || was.values.cols() != is.values.cols())
    return {kInfinity, kInfinity};
  double scale = was.motion == Motion::place ? size : 0, change = 0;
  for (Eigen::Index i = 0; i < was.values.size(); ++i) {
    const double left = was.values.reshaped()[i], right = is.values.reshaped()[i];
    if (was.motion != Motion::place && std::isfinite(left)) scale = std::max(scale, std::abs(left));
    if (left == right || (std::isnan(left) && std::isnan(right))) continue;
    const double by = std::abs(left - right);
    change = std::isfinite(by) ? std::max(change, by) : kInfinity;
  }
  return {change / (scale > 0 ? scale : 1), change};
}

/// Compares the results of an input with those of one that is changed a little.
std::string report_of_change(const Results& was, const Results& is, double size) {
  if (was.size() != is.size()) return report_of_wrong("another number of results");
  double largest = 0;
  bool said = false;
  for (std::size_t i = 0; i < was.size(); ++i) {
    const Nudge change = change_of(was[i], is[i], size);
    // What chooses among equals, as a grid does by where it lies, has a tolerance of its own.
    if (change.relative <=
        std::max(kHalfOfTheDigits, was[i].tolerance < kRoughly ? 0 : was[i].tolerance)) {
      if (was[i].tolerance < kRoughly) largest = std::max(largest, change.relative);
    } else if (change.absolute <= was[i].stated || !was[i].words.empty() || !is[i].words.empty()) {
      said = true;
    } else {
      return report_of_wrong(
          fmt::format("{} changes by {:.2g}, and nothing is said", was[i].name, change.relative));
    }
  }
  return said ? report_of_said() : report_of_difference(largest);
}

class Conditioning : public ::testing::TestWithParam<Operation> {};

TEST_P(Conditioning, WhoLosesHalfOfTheDigitsSaysSo) {
  const Operation& operation = GetParam();
  std::vector<const Nearly*> cases;
  for (const Nearly& one : inputs())
    if ((one.parts & operation.uses & ~unsigned{kOptions | kForces}) != 0) cases.push_back(&one);
  if (cases.empty()) return;
  const std::vector<Outcome> outcomes = run_apart(
      cases.size(),
      [&](std::size_t i) {
        Input input = standard_input();
        cases[i]->make(input);
        return report_of_change(operation.run(input, no_change()),
                                operation.run(nudged(input, 1), no_change()), size_of(input));
      },
      {.seconds = 2 * operation.seconds});
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < cases.size(); ++i)
    findings.push_back(finding_of(cases[i]->name, outcomes[i]));
  judge(operation, "conditioning", findings);
}

INSTANTIATE_TEST_SUITE_P(All, Conditioning, ::testing::ValuesIn(operations()),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::extremes
