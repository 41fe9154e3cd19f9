// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "detect/simulated_slip.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/probing_program.h"
#include "validation.h"
#include "watched_arm.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

/// Wrong decisions by the tangential force relative to the limit.
struct SlipCounts {
  int below = 0, at = 0, above = 0;  ///< trials below 0.9, from there to 1.1, above
  int wrong_below = 0, wrong_at = 0, wrong_above = 0;

  void add(double load, bool wrong) {
    ++(load < 0.9 ? below : load > 1.1 ? above : at);
    if (wrong) ++(load < 0.9 ? wrong_below : load > 1.1 ? wrong_above : wrong_at);
  }
  void print(const char* name) const {
    const auto percent = [](int wrong, int count) { return count > 0 ? 100.0 * wrong / count : 0; };
    std::printf("%-40s %7d %7.2f %% %7.2f %% %7.2f %%\n", name, below + at + above,
                percent(wrong_below, below), percent(wrong_above, above),
                percent(wrong_below + wrong_at + wrong_above, below + at + above));
    std::fflush(stdout);
  }
};

/// Distance [mm] that the contact of the virtual arm slid between the pressed and the released
/// state, which is when slipping is judged.
class SlidWay final : public probing::Prober {
 public:
  explicit SlidWay(SimulatedRig& rig) : rig_(rig) {}
  probing::ProbeReport perform(const probing::ProbeAction& action) override {
    probing::ProbeReport report = rig_.prober.perform(action);
    const probing::VirtualArmTruth& truth = rig_.arm.truth();
    if (action.kind == probing::ProbeActionKind::press) before_ = truth.slid;
    if (action.kind == probing::ProbeActionKind::drag ||
        action.kind == probing::ProbeActionKind::release) {
      way = truth.in_contact ? truth.slid - before_ : std::numeric_limits<double>::infinity();
    }
    return report;
  }
  double way = 0;

 private:
  SimulatedRig& rig_;
  double before_ = 0;
};

/// Trials of the virtual arm, another one at each contact; the truth is the way that its contact
/// slid.
SlipCounts counts_of(const probing::Specimen& specimen, int contacts, int trials_a_contact) {
  constexpr double kSlid = 0.1;  // [mm] five times the noise of a position
  probing::PlanOptions options;
  options.contacts = contacts;
  const probing::ContactPlan plan = probing::plan_contacts(specimen.surface(), options);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  SlipCounts counts;
  std::vector<double> statistics;
  long long trial = 0;
  for (const probing::Contact& contact : plan.contacts) {
    SimulatedRig rig(specimen, static_cast<unsigned>(contact.id) + 1);
    SlidWay slid(rig);
    const Eigen::Matrix3d frame = probing::tangent_frame(contact);
    const probing::FrictionCone cone = specimen.friction_cone(contact.position);
    std::vector<probing::HeldDrag> drags;
    for (int i = 0; i < trials_a_contact; ++i) {
      const double normal = 0.15 * std::pow(10, uniform(random)), angle = 6.28 * uniform(random);
      const double load = 0.3 + 1.4 * uniform(random);
      // The force whose part across the cone's axis is `load` times what the part along it allows.
      const Vector3d across = frame * Vector3d(std::cos(angle), std::sin(angle), 0);
      double low = 0, high = 10 * normal;
      for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        const Vector3d force = normal * frame.col(2) + middle * across;
        const double along = force.dot(cone.axis);
        const bool beyond =
            !(along > 0) || (force - along * cone.axis).norm() > load * cone.coefficient * along;
        (beyond ? high : low) = middle;
      }
      const probing::TrialOrder order{.trial = trial++,
                                      .contact = contact,
                                      .direction = 0,
                                      .normal_force = normal * frame.col(2),
                                      .tangential_force = low * across,
                                      .microslip = probing::allowed_microslip(drags, low / normal),
                                      .slip_threshold = probing::allowed_threshold(statistics)};
      const probing::TrialResult result = probing::run_trial(slid, order, {});
      const bool held = result.outcome == probing::TrialOutcome::held;
      if (const auto drag = probing::held_drag(probing::slip_trial(order, result)); held && drag) {
        drags.push_back(*drag);
        statistics.push_back(result.slip_statistic);
      }
      const bool slipped = result.outcome == probing::TrialOutcome::slipped ||
                           result.outcome == probing::TrialOutcome::fell_off;
      if (held || slipped) counts.add(load, slipped != (slid.way > kSlid));
    }
  }
  return counts;
}

}  // namespace

void validate_slips(int trials) {
  std::printf("Slip decisions: trials; wrong below 0.9 of the limit, above 1.1, in all\n");
  SlipCounts simulated;
  for (int seed = 1; seed <= trials; ++seed) {
    const auto each = probing::support::simulate_trial(static_cast<unsigned>(seed));
    const auto judged = probing::judge_slip(each.trial);
    simulated.add(each.load, !judged || judged->slipped != each.slipped);
  }
  simulated.print("springs of 0.1 to 5 N/mm with microslip");
  const std::array<std::pair<const char*, std::shared_ptr<const probing::Specimen>>, 4> specimens{
      {{"virtual arm on the sheet", probing::make_specimen(probing::Sheet{})},
       {"virtual arm on the sheet with block",
        probing::make_specimen(probing::Sheet{.block = 1.5})},
       {"virtual arm on the beam", probing::make_specimen(probing::Beam{})},
       {"virtual arm on the elastic body",
        probing::make_specimen(probing::ElasticBody{.young_modulus = 0.2})}}};
  for (const auto& [name, specimen] : specimens) counts_of(*specimen, 10, 60).print(name);
  std::printf("\n");
}

}  // namespace palpate::bench
