// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/material_text.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "palpate/probing/specimen_file.h"
#include "refusal.h"

namespace palpate::probing {
namespace {

constexpr const char* kStretchedBlock = R"({"type": "finite_elements", "size": [40, 40, 16],
  "cells": [4, 4, 2], "shear_modulus": 0.05, "friction": 0.6,
  "regions": [{"low": [0, -30, 690], "high": [30, 30, 730], "shear_modulus": 0.1}],
  "supports": [{"side": "left", "move": [-2, 0, 0]}, {"side": "right", "move": [2, 0, 1]}]})";

TEST(MaterialText, KeepsAllButTheMaterialAndIsReadBack) {
  FiniteElementObject object = parse_finite_elements(kStretchedBlock, "a.json");
  object.body.materials[0] = {.shear_modulus = 0.07, .bulk_modulus = 0.5};
  object.body.materials[1] = {.shear_modulus = 0.2, .bulk_modulus = 4};
  object.body.support_moves *= 1.5;
  object.options.friction = 0.3;
  const std::vector<KnownPress> presses{{7, {1, 2, 700}, {0, 0, 1}, {0.1, 0, 2}, {0, 0, 1.5}}};
  const std::string text = with_material(kStretchedBlock, "a.json", object, presses);
  const FiniteElementObject again = parse_finite_elements(text, "b.json");
  EXPECT_EQ(again.body.materials[0].shear_modulus, 0.07);
  EXPECT_EQ(again.body.materials[1].bulk_modulus, 4);
  EXPECT_EQ(again.options.friction, 0.3);
  EXPECT_TRUE(again.body.support_moves.isApprox(object.body.support_moves, 1e-12));
  EXPECT_EQ(again.body.mesh.nodes, object.body.mesh.nodes);
  EXPECT_NO_THROW((void)parse_specimen(text, "b.json"));
  const std::vector<KnownPress> read = parse_presses(text, "b.json");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].contact, 7);
  EXPECT_EQ(read[0].displacement, presses[0].displacement);
  EXPECT_EQ(read[0].force, presses[0].force);
  EXPECT_TRUE(parse_presses(kStretchedBlock, "a.json").empty());
}

TEST(MaterialText, RefusesDamagedPressesAndOtherRegions) {
  EXPECT_THAT(refusal([] {
                return parse_presses(R"({"identified": {"presses": [{"contact": 1}]}})", "c.json");
              }),
              ::testing::HasSubstr("c.json: 'presses'"));
  FiniteElementObject object = parse_finite_elements(kStretchedBlock, "a.json");
  object.body.materials.pop_back();
  EXPECT_THAT(refusal([&] { return with_material(kStretchedBlock, "a.json", object, {}); }),
              ::testing::HasSubstr("1 regions, the text 2"));
  EXPECT_THAT(refusal([] { return parse_finite_elements(R"({"type": "sheet"})", "d.json"); }),
              ::testing::HasSubstr(R"(at /type: found "sheet", expected "finite_elements")"));
}

}  // namespace
}  // namespace palpate::probing
