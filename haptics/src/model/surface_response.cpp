// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/surface_response.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

// Of the sum of three weights: they are rounded to halves.
constexpr float kWeightTolerance = 2e-3F;

}  // namespace

double dent_at(const SurfaceResponse& response, Eigen::Index contact, double d) {
  const double place = d / response.reach * SurfaceResponse::kDentPlaces;
  if (!(place < SurfaceResponse::kDentPlaces)) return 0;
  const auto before = static_cast<Eigen::Index>(place);
  const double share = place - static_cast<double>(before);
  const auto value = [&](Eigen::Index k) {
    return k < SurfaceResponse::kDentPlaces ? static_cast<double>(response.dents(k, contact)) : 0.0;
  };
  return (1 - share) * value(before) + share * value(before + 1);
}

void check_surface_response(const SurfaceResponse& response, Eigen::Index vertices,
                            Eigen::Index contacts, const std::string& subject) {
  const auto require_that = [&](bool holds, const std::string& wrong) {
    if (!holds) throw InvalidInput(subject + ": " + wrong);
  };
  require_that(response.dents.cols() == contacts,
               "there are dents of " + std::to_string(response.dents.cols()) +
                   " contacts; the model has " + std::to_string(contacts));
  require_that(response.reach > 0 && std::isfinite(response.reach),
               "the reach of its dents must be > 0 and finite");
  const Eigen::Index nodes = response.responses.rows() / 9;
  require_that(response.nodes.cols() == vertices && response.weights.cols() == vertices,
               "there are nodes of " + std::to_string(response.nodes.cols()) + " and weights of " +
                   std::to_string(response.weights.cols()) + " vertices; the surface has " +
                   std::to_string(vertices));
  require_that(response.responses.cols() == contacts,
               "there are responses of " + std::to_string(response.responses.cols()) +
                   " contacts; the model has " + std::to_string(contacts));
  require_that(nodes >= 1 && response.responses.rows() == 9 * nodes,
               "a contact has " + std::to_string(response.responses.rows()) +
                   " numbers; there must be nine a node");
  for (Eigen::Index v = 0; v < vertices; ++v) {
    require_that(response.nodes.col(v).maxCoeff() < nodes,
                 "a node of vertex " + std::to_string(v) + " is " +
                     std::to_string(response.nodes.col(v).maxCoeff()) + "; there are " +
                     std::to_string(nodes));
    const Eigen::Vector3f weights = response.weights.col(v).cast<float>();
    require_that(
        weights.minCoeff() >= 0 && std::abs(weights.sum() - 1) <= kWeightTolerance,
        "the weights of vertex " + std::to_string(v) + " do not sum to 1, or one is negative");
  }
  for (Eigen::Index c = 0; c < contacts; ++c) {
    require_that(response.responses.col(c).cast<float>().allFinite() &&
                     response.dents.col(c).cast<float>().allFinite(),
                 "a response of contact " + std::to_string(c) + " is not finite");
  }
  const Eigen::Index shapes = response.shape_contacts.size();
  require_that(response.displacements.cols() == shapes && response.moves.cols() == shapes &&
                   response.moves.rows() == 3 * nodes,
               "its recorded surfaces have " + std::to_string(shapes) + " contacts, " +
                   std::to_string(response.displacements.cols()) + " displacements and " +
                   std::to_string(response.moves.cols()) + " columns of three numbers a node");
  for (Eigen::Index s = 0; s < shapes; ++s) {
    require_that(response.shape_contacts[s] >= 0 && response.shape_contacts[s] < contacts,
                 "recorded surface " + std::to_string(s) + " is of contact " +
                     std::to_string(response.shape_contacts[s]) + "; there are " +
                     std::to_string(contacts));
    require_that(response.displacements.col(s).allFinite() &&
                     response.moves.col(s).cast<float>().allFinite(),
                 "a number of recorded surface " + std::to_string(s) + " is not finite");
  }
  for (const double error :
       {response.rms, response.largest, response.kept_rms, response.kept_largest}) {
    require_that(error >= 0 && std::isfinite(error), "one of its errors is negative or not finite");
  }
}

}  // namespace palpate::haptics
