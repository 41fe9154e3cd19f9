// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probed_object.h"

#include <cmath>
#include <limits>
#include <random>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/probing/contact_stiffness.h"
#include "palpate/probing/known_forces.h"
#include "palpate/probing/specimen_file.h"
#include "palpate/probing/specimen_trials.h"

namespace palpate::bench {
namespace {

constexpr double kNoise = 0.022;       // [mm] of a component of a position
constexpr double kDepthNoise = 0.02;   // [mm] of a place of a range map
constexpr double kLeastSeen = 5;       // deviations of the motion of a place that counts
constexpr double kLeastMotion = 1e-3;  // [mm] that counts without noise
constexpr double kHiddenBeside = 3;    // [mm] beside the tip, which hides it
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void look(ProbedObject& object, double force, std::mt19937& random) {
  const auto& contacts = object.plan.contacts;
  const auto count = static_cast<Eigen::Index>(contacts.size());
  const Eigen::Matrix3Xd& rest = object.specimen->surface().vertices;
  std::vector<Eigen::Index> vertex;
  for (const probing::Contact& contact : contacts) {
    Eigen::Index nearest = 0;
    (rest.colwise() - contact.position).colwise().squaredNorm().minCoeff(&nearest);
    vertex.push_back(nearest);
  }
  object.seen.setConstant(count, count, kNan);
  parallel_for(contacts.size(), [&](std::size_t i) {
    try {
      const Eigen::Matrix3Xd moved =
          object.specimen->deformed_surface(contacts[i].position, -force * contacts[i].normal);
      for (std::size_t j = 0; j < contacts.size(); ++j)
        object.seen(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            -(moved.col(vertex[j]) - rest.col(vertex[j])).dot(contacts[j].normal);
    } catch (const SolverError&) {  // it is not seen
    }
  });
  object.exactly = object.seen;
  std::normal_distribution<double> normal;
  const double hidden = object.specimen->tip_radius().value_or(0) + kHiddenBeside;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const double exact = object.seen(i, j);
      const double motion = exact + kDepthNoise * normal(random);
      const bool beside =
          distance(object, static_cast<std::size_t>(i), static_cast<std::size_t>(j)) > hidden;
      object.seen(i, j) = beside && motion > kLeastSeen * kDepthNoise ? motion / force : kNan;
      object.exactly(i, j) = beside && exact > kLeastMotion ? exact / force : kNan;
    }
  }
}

}  // namespace

std::vector<PlacementObject> placement_objects() {
  return {{"hidden block",
           R"({"type": "finite_elements", "size": [100, 60, 3], "cells": [16, 10, 1],
       "shear_modulus": 0.2, "supports": [{"side": "left", "move": [-5, 0, 0]},
       {"side": "right", "move": [5, 0, 0]}], "obstacles": [{"low": [8, -20, 710],
       "high": [32, 6, 720]}]})",
           6.5, 1.5},
          {"rib",
           R"({"type": "finite_elements", "size": [64, 56, 16], "cells": [13, 11, 3],
       "shear_modulus": 0.03, "regions": [{"low": [-10, -28, 705], "high": [-5, 28, 716],
       "shear_modulus": 0.3}]})",
           6.5, 1.2},
          {"inclusion",
           R"({"type": "finite_elements", "size": [60, 60, 20], "cells": [12, 12, 3],
       "shear_modulus": 0.03, "regions": [{"centre": [8, -6, 709], "radius": 7,
       "shear_modulus": 0.3}]})",
           6.5, 1.2}};
}

double distance(const ProbedObject& object, std::size_t i, std::size_t j) {
  return (object.plan.contacts[i].position - object.plan.contacts[j].position).norm();
}

ProbedObject probe(const PlacementObject& given) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  ProbedObject object{.name = given.name,
                      .specimen = probing::parse_specimen(given.specimen, given.name),
                      .plan = {},
                      .samples = {},
                      .stiffness = {},
                      .seen = {},
                      .exactly = {},
                      .queries = {}};
  object.plan =
      probing::plan_contacts(object.specimen->surface(), {.spacing = given.spacing,
                                                          .lowest_force = 0.05 * given.max_force,
                                                          .levels = 5,
                                                          .directions = 2,
                                                          .max_force = given.max_force});
  probing::Acquisition all = probing::try_specimen(*object.specimen, object.plan).acquisition;
  object.samples.resize(object.plan.contacts.size());
  for (probing::Sample& sample : all.samples) {
    for (int k = 0; k < 3; ++k) {
      sample.a[k] += kNoise * normal(random);
      sample.b[k] += kNoise * normal(random);
    }
    object.samples[static_cast<std::size_t>(sample.contact)].push_back(sample);
  }
  const double force = object.plan.normal_forces.back();
  const auto stiffness = probing::contact_stiffness(all, force);
  if (stiffness.size() != object.plan.contacts.size())
    throw InvalidInput(object.name + ": a candidate could not be pressed");
  object.stiffness.resize(static_cast<Eigen::Index>(stiffness.size()));
  for (std::size_t i = 0; i < stiffness.size(); ++i)
    object.stiffness(static_cast<Eigen::Index>(i)) = std::log(stiffness[i].stiffness);
  look(object, force, random);
  for (const probing::KnownForce& known :
       probing::known_forces(*object.specimen,
                             {.queries = 120, .margin = 8, .max_force = given.max_force})
           .forces)
    object.queries.push_back({known.contact, known.displacement, known.force});
  return object;
}

}  // namespace palpate::bench
