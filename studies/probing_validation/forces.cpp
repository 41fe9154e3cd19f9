// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "palpate/probing/closed_form.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/probing_program.h"
#include "validation.h"
#include "watched_arm.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;
using probing::FrictionCompensation;

constexpr int kContacts = 5;
constexpr double kOfNormal = 0.4;     // tangential over normal force, well inside all cones
constexpr double kSmall = 0.1;        // [N] tangential force of the small pulls, under ...
constexpr double kSmallNormal = 0.5;  // [N]

/// Errors [N] of the forces at rest by the truth of the simulation, in the frame of the base: x
/// along the first joint's motion, y along the normal, z away from the base.
struct ForceErrors {
  std::vector<Vector3d> all;
  std::vector<double> small;  ///< along the direction of a small pull, relative to it
};

class Witness final : public probing::Prober {
 public:
  explicit Witness(SimulatedRig& rig) : rig_(rig) {}
  probing::ProbeReport perform(const probing::ProbeAction& action) override {
    probing::ProbeReport report = rig_.prober.perform(action);
    const bool is_force = action.kind == probing::ProbeActionKind::press ||
                          action.kind == probing::ProbeActionKind::drag ||
                          action.kind == probing::ProbeActionKind::release;
    if (!is_force || report.outcome != probing::ProbeOutcome::done) return report;
    const Vector3d wanted = rig_.options.T_world_base.linear().transpose() * action.force;
    const Vector3d error = rig_.watched.mean_force() - wanted;
    errors.all.push_back(error);
    if (action.kind == probing::ProbeActionKind::drag && small)
      errors.small.push_back(error.dot(rig_.options.T_world_base.linear().transpose() * direction) /
                             kSmall);
    return report;
  }
  ForceErrors errors;
  Vector3d direction = Vector3d::UnitX();  // world frame
  bool small = false;

 private:
  SimulatedRig& rig_;
};

struct Way {
  const char* name;
  FrictionCompensation friction;
  bool dithers;
};

ForceErrors errors_of(const probing::Specimen& specimen, unsigned seed, const Way& way) {
  SimulatedRig rig(specimen, seed, way.friction, way.dithers);
  probing::PlanOptions options;
  options.contacts = kContacts;
  const probing::ContactPlan plan = probing::plan_contacts(specimen.surface(), options);
  Witness witness(rig);
  long long trial = 0;
  const auto pull = [&](const probing::Contact& contact, int level, int k, double normal,
                        double tangential) {
    const double angle = probing::direction_angle(options, level, k);
    const Eigen::Matrix3d frame = probing::tangent_frame(contact);
    witness.direction = frame * Vector3d(std::cos(angle), std::sin(angle), 0);
    static_cast<void>(probing::run_trial(witness,
                                         {.trial = trial++,
                                          .contact = contact,
                                          .level = level,
                                          .direction = k,
                                          .normal_force = normal * frame.col(2),
                                          .tangential_force = tangential * witness.direction},
                                         {}));
  };
  for (const probing::Contact& contact : plan.contacts) {
    for (int level = 0; level < options.levels; ++level) {
      const double normal = plan.normal_forces[static_cast<std::size_t>(level)];
      for (int k = 0; k < options.directions; ++k)
        pull(contact, level, k, normal, kOfNormal * normal);
    }
    witness.small = true;
    for (int k = 0; k < options.directions; ++k) pull(contact, 0, k, kSmallNormal, kSmall);
    witness.small = false;
  }
  return witness.errors;
}

void print_row(const char* name, const ForceErrors& errors) {
  const auto count = static_cast<double>(errors.all.size());
  Vector3d mean = Vector3d::Zero(), square = Vector3d::Zero();
  std::vector<double> lengths, small;
  for (const Vector3d& error : errors.all) {
    mean += error / count;
    lengths.push_back(error.norm());
  }
  for (const Vector3d& error : errors.all) square += (error - mean).cwiseAbs2() / count;
  const Vector3d deviation = square.cwiseSqrt();
  for (const double error : errors.small) small.push_back(std::abs(error));
  std::sort(lengths.begin(), lengths.end());
  std::sort(small.begin(), small.end());
  std::printf("%-26s %5zu | %7.4f %7.4f %7.4f | %7.4f %7.4f %7.4f | %6.3f %6.3f | %5.0f %5.0f %%\n",
              name, errors.all.size(), mean.x(), mean.y(), mean.z(), deviation.x(), deviation.y(),
              deviation.z(), lengths[lengths.size() / 2], lengths[lengths.size() * 95 / 100],
              100 * small[small.size() / 2], 100 * small[small.size() * 95 / 100]);
  std::fflush(stdout);
}

}  // namespace

void validate_forces() {
  const std::array<std::pair<const char*, std::shared_ptr<const probing::Specimen>>, 4> specimens{
      {{"sheet", probing::make_specimen(probing::Sheet{})},
       {"sheet with block", probing::make_specimen(probing::Sheet{.block = 1.5})},
       {"beam", probing::make_specimen(probing::Beam{})},
       {"elastic body, 0.2 N/mm^2",
        probing::make_specimen(probing::ElasticBody{.young_modulus = 0.2})}}};
  const std::array<Way, 4> ways{{{"gravity only", FrictionCompensation::none, false},
                                 {"and internal force", FrictionCompensation::held, false},
                                 {"and friction followed", FrictionCompensation::followed, false},
                                 {"and dither at rest", FrictionCompensation::followed, true}}};
  // The options were tuned with seed 1 on the sheet and the elastic body.
  constexpr unsigned kTuned = 1;
  constexpr std::array<unsigned, 2> kHeldOut{2, 3};
  std::printf(
      "Forces at rest [N]: number, mean and standard deviation of the error's x, y (normal), z;\n"
      "median and 95th percentile of its length, and of the error of a pull of 0.1 N\n");
  for (const auto& [name, specimen] : specimens) {
    std::printf("%s\n", name);
    for (const Way& way : ways) print_row(way.name, errors_of(*specimen, kTuned, way));
    for (const unsigned seed : kHeldOut)
      print_row(("the same, seed " + std::to_string(seed)).c_str(),
                errors_of(*specimen, seed, ways.back()));
  }
  std::printf("\n");
}

}  // namespace palpate::bench
