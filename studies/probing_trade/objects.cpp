// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "objects.h"

#include "palpate/probing/specimen_file.h"

namespace palpate::bench {
namespace {

// Of the largest force: the highest normal force, above which there is room for a tangential one.
constexpr double kHighest = 2.6 / 3;
constexpr double kLowest = 0.05;

TradeObject closed_form(const std::string& name, const std::string& specimen, unsigned seeds) {
  return {.name = name,
          .specimen = specimen,
          .plan = {.lowest_force = kLowest * 3, .highest_force = kHighest * 3, .levels = 5},
          .queries = {},
          .most_seeds = seeds};
}

// [mm] spacing of contacts, and [N] the largest force.
TradeObject finite_elements(const std::string& name, const std::string& specimen, double spacing,
                            double most) {
  return {.name = name,
          .specimen = specimen,
          .plan = {.spacing = spacing,
                   .contacts = 13,
                   .lowest_force = kLowest * most,
                   .highest_force = kHighest * most,
                   .levels = 5,
                   .max_force = most},
          .queries = {.queries = 60, .margin = 6, .max_force = most},
          .most_seeds = 1};
}

}  // namespace

std::vector<TradeObject> tuning_objects(unsigned seeds) {
  return {closed_form("sheet", R"({"type": "sheet"})", seeds),
          closed_form("block", R"({"type": "sheet", "block": 1.5})", seeds),
          closed_form("beam", R"({"type": "beam", "local_variation": 0.1})", seeds)};
}

std::vector<TradeObject> unseen_objects(unsigned seeds) {
  return {closed_form("taut sheet",
                      R"({"type": "sheet", "tension": 1.4, "axial": 55, "compliance": 0.2,
                      "friction": 0.65})",
                      seeds),
          closed_form("slack sheet",
                      R"({"type": "sheet", "tension": 0.55, "axial": 30, "compliance": 0.35,
                      "taper": 0.2, "friction": 1.1})",
                      seeds),
          closed_form("sheet on a long block",
                      R"({"type": "sheet", "tension": 1, "axial": 38, "block": 1, "depth": 12,
                      "block_low": [-40, -25], "block_high": [0, 15], "friction": 0.8})",
                      seeds),
          closed_form("sheet on a small block",
                      R"({"type": "sheet", "tension": 0.7, "axial": 45, "block": 2.2, "depth": 17,
                      "block_low": [-10, -12], "block_high": [14, 14], "friction": 0.75})",
                      seeds),
          closed_form("soft beam",
                      R"({"type": "beam", "bending": 6, "pressed": 1.9, "pressed_force": 1,
                      "local_variation": 0.05, "friction": 0.9})",
                      seeds),
          closed_form("firm beam",
                      R"({"type": "beam", "bending": 2.2, "pressed": 1.1, "shear": 0.25,
                      "local_variation": 0.15, "friction": 0.55})",
                      seeds),
          closed_form("elastic body",
                      R"({"type": "elastic_body", "young_modulus": 0.04, "poisson_ratio": 0.4,
                      "friction": 0.8})",
                      seeds),
          finite_elements("solid block with a stiff part",
                          R"({"type": "finite_elements", "size": [32, 32, 12], "cells": [8, 8, 2],
                          "friction": 0.7, "regions": [{"low": [0, -16, 700],
                          "high": [16, 16, 712], "shear_modulus": 0.06}]})",
                          6, 1.2),
          finite_elements("solid block held at its sides",
                          R"({"type": "finite_elements", "size": [40, 32, 8], "cells": [8, 8, 2],
                          "friction": 0.6, "shear_modulus": 0.03,
                          "supports": [{"side": "left"}, {"side": "right"}]})",
                          7, 0.9)};
}

PreparedObject prepare(const TradeObject& object) {
  PreparedObject prepared{.of = object, .specimen = {}, .plan = {}, .queries = {}};
  prepared.specimen = probing::parse_specimen(object.specimen, object.name);
  prepared.plan = probing::plan_contacts(prepared.specimen->surface(), object.plan);
  prepared.queries = probing::known_forces(*prepared.specimen, object.queries).forces;
  return prepared;
}

}  // namespace palpate::bench
