// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "strategies.h"

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>

#include "palpate/core/parallel_for.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/probing_program.h"
#include "palpate/probing/quasi_static_arm.h"
#include "palpate/probing/stiffness_process.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;
using Known = std::vector<probing::ContactStiffness>;

constexpr double kStep = 4, kInner = 16;  // [mm] between places, and the outermost place
constexpr int kSide = static_cast<int>(2 * kInner / kStep) + 1;
constexpr int kFirstPlaces = 5;     // of Bayesian optimisation
constexpr double kConfidence = 2;   // deviations of its bound
constexpr double kNoNoise = 1e-3;   // of a stiffness, relative
constexpr double kMostForce = 0.6;  // [N] of a whole force of `adaptive`
constexpr double kPlanSpacing = 6;  // [mm] of its contacts

// Measured depths: noise of position and of force, which acts through the compliance.
class Presser {
 public:
  Presser(const PressTable& table, unsigned seed) : table_(table), random_(seed) {}

  void press(Eigen::Index place) {
    const double depth = table_.depths(place), compliance = depth / kPressForce;
    const double noise = std::hypot(noise_.position, noise_.force * compliance);
    const double measured = depth + noise * normal_(random_);
    const double stiffness = kPressForce / measured;
    known_.push_back({table_.places.col(place), stiffness, stiffness * noise / measured});
    visited_[static_cast<std::size_t>(place)] = true;
  }
  [[nodiscard]] const Known& known() const { return known_; }
  [[nodiscard]] bool visited(Eigen::Index place) const {
    return visited_[static_cast<std::size_t>(place)];
  }
  [[nodiscard]] int count() const { return static_cast<int>(known_.size()); }

 private:
  const PressTable& table_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  probing::PressNoise noise_;
  Known known_;
  std::vector<bool> visited_ = std::vector<bool>(static_cast<std::size_t>(table_.places.cols()));
};

// The place farthest from all known ones; the middle first.
Eigen::Index farthest(const PressTable& table, const Presser& presser) {
  Eigen::Index best = table.places.cols() / 2;
  double most = -1;
  for (Eigen::Index i = 0; i < table.places.cols() && presser.count() > 0; ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const probing::ContactStiffness& known : presser.known())
      nearest = std::min(nearest, (known.position - table.places.col(i)).norm());
    if (nearest > most) {
      most = nearest;
      best = i;
    }
  }
  return best;
}

}  // namespace

PressTable press_everywhere(const InclusionBlock& block) {
  PressTable table;
  table.places.resize(3, kSide * kSide);
  for (int i = 0; i < kSide * kSide; ++i)
    table.places.col(i) << kStep * (i % kSide) - kInner,
        kStep * static_cast<double>(i / kSide) - kInner, kTop;
  table.depths.resize(table.places.cols());
  parallel_for(table.places.cols(), [&](Eigen::Index i) {
    table.depths(i) =
        block.specimen->displacement(table.places.col(i), kPressForce * Vector3d::UnitZ()).z();
  });
  return table;
}

void press_exactly(const PressTable& table, const AfterPresses& after) {
  Known known;
  for (Eigen::Index i = 0; i < table.places.cols(); ++i) {
    const double stiffness = kPressForce / table.depths(i);
    known.push_back({table.places.col(i), stiffness, kNoNoise * stiffness});
  }
  after(static_cast<int>(known.size()), known);
}

void press_grids(const PressTable& table, unsigned seed, const AfterPresses& after) {
  for (int side = 3; side <= kSide; ++side) {
    Presser presser(table, seed);
    for (int i = 0; i < side * side; ++i) {
      const auto place = [&](int k) {
        return std::lround(static_cast<double>(k) * (kSide - 1) / (side - 1));
      };
      presser.press(place(i % side) + kSide * place(i / side));
    }
    after(presser.count(), presser.known());
  }
}

void press_farthest(const PressTable& table, unsigned seed, int most, const AfterPresses& after) {
  Presser presser(table, seed);
  while (presser.count() < most) {
    presser.press(farthest(table, presser));
    after(presser.count(), presser.known());
  }
}

void press_by_bound(const PressTable& table, unsigned seed, int most, const AfterPresses& after) {
  Presser presser(table, seed);
  while (presser.count() < most) {
    Eigen::Index next = farthest(table, presser);
    if (presser.count() >= kFirstPlaces) {
      const probing::StiffnessProcess process(presser.known());
      double best = -std::numeric_limits<double>::infinity();
      for (Eigen::Index i = 0; i < table.places.cols(); ++i) {
        if (presser.visited(i)) continue;
        const probing::ContactStiffness there = process.predict(table.places.col(i));
        const double bound =
            std::log(there.stiffness) + kConfidence * there.deviation / there.stiffness;
        if (bound > best) {
          best = bound;
          next = i;
        }
      }
    }
    presser.press(next);
    after(presser.count(), presser.known());
  }
}

void press_adaptively(const InclusionBlock& block, unsigned seed, int most,
                      const AfterPresses& after) {
  const probing::ContactPlan plan =
      probing::plan_contacts(block.specimen->surface(), {.spacing = kPlanSpacing,
                                                         .tip_radius = kTipRadius,
                                                         .lowest_force = kPressForce / 5,
                                                         .highest_force = kPressForce,
                                                         .levels = 2,
                                                         .directions = 1,
                                                         .max_force = kMostForce});
  const probing::CampaignOptions options{.strategy = probing::TrialStrategy::adaptive,
                                         .seed = seed,
                                         .reference_every = 0,
                                         .max_samples = most};
  const auto arm = probing::make_quasi_static_arm(block.specimen, {.seed = seed});
  probing::Campaign campaign(plan, options);
  probing::Acquisition measured;
  measured.contacts = plan.contacts;
  std::size_t known = 0;
  int trials = 0;
  while (const std::optional<probing::TrialOrder> order = campaign.next()) {
    const probing::TrialRecord record{*order, probing::run_trial(*arm, *order, options.program)};
    ++trials;
    if (const auto sample = probing::sample_of(record.order, record.result, 0))
      measured.samples.push_back(*sample);
    (void)campaign.take(record);
    const Known now = probing::contact_stiffness(measured, kPressForce);
    if (now.size() > known) after(trials, now);
    known = now.size();
  }
  after(trials, probing::contact_stiffness(measured, kPressForce));
}

}  // namespace palpate::bench
