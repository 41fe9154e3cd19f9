// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "palpate/haptics/evaluate.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/specimen.h"

namespace palpate::bench {

struct PlacementObject {
  std::string name, specimen;
  double spacing = 7;    ///< [mm] of the candidates
  double max_force = 1;  ///< [N]
};

/// A sheet over a hidden block, and blocks with a rib and with an inclusion.
[[nodiscard]] std::vector<PlacementObject> placement_objects();

/// All candidates of an object, probed and seen.
struct ProbedObject {
  std::string name;
  std::shared_ptr<const probing::Specimen> specimen;
  probing::ContactPlan plan;
  std::vector<std::vector<probing::Sample>> samples;  ///< of each candidate, with noise
  Eigen::VectorXd stiffness;  ///< logarithms, of each, under the highest normal force
  /// [mm/N] The motion into the object of place j under a force at i, as a range map shows it and
  /// without noise; NaN where nothing is seen, because the tip hides it or it moves too little.
  Eigen::MatrixXd seen, exactly;
  std::vector<haptics::Query> queries;
};
[[nodiscard]] ProbedObject probe(const PlacementObject& given);

/// [mm] between two candidates
[[nodiscard]] double distance(const ProbedObject& object, std::size_t i, std::size_t j);

}  // namespace palpate::bench
