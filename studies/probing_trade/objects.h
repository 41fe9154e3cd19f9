// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "palpate/probing/contact_plan.h"
#include "palpate/probing/known_forces.h"
#include "palpate/probing/specimen.h"

namespace palpate::bench {

/// An object to probe, and how it is probed.
struct TradeObject {
  std::string name;
  std::string specimen;  ///< JSON, as in docs/probing.md
  probing::PlanOptions plan = {};
  probing::KnownForceOptions queries = {};
  unsigned most_seeds = 1;
};

/// The objects that the constants of `adaptive` were chosen with.
[[nodiscard]] std::vector<TradeObject> tuning_objects(unsigned seeds);

/// Objects that were never used in tuning. Those of finite elements are small, have few contacts
/// and known forces, and are probed with one seed, since an equilibrium takes about 0.1 s.
[[nodiscard]] std::vector<TradeObject> unseen_objects(unsigned seeds);

/// An object that was made, with what all strategies share.
struct PreparedObject {
  TradeObject of;
  std::shared_ptr<const probing::Specimen> specimen;
  probing::ContactPlan plan;  ///< five levels, four directions
  std::vector<probing::KnownForce> queries;
};
[[nodiscard]] PreparedObject prepare(const TradeObject& object);

}  // namespace palpate::bench
