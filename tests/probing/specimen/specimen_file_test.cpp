// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"

namespace palpate::probing {
namespace {

using ::testing::HasSubstr;

const Eigen::Vector3d kForce(0.2, -0.1, 1.7);

TEST(SpecimenFile, MembersAreTheFieldsOfTheObject) {
  const auto read = parse_specimen(
      R"({"type": "sheet", "block": 2, "block_low": [-30, -25.5], "friction": 0.4})", "a.json");
  const auto made = make_specimen(Sheet{.block = 2, .block_low = {-30, -25.5}, .friction = 0.4});
  const Eigen::Vector3d at = surface_at(Sheet{}, -24, -23);
  EXPECT_EQ(read->displacement(at, kForce), made->displacement(at, kForce));
  EXPECT_NE(read->displacement(at, kForce), make_specimen(Sheet{})->displacement(at, kForce));
  EXPECT_EQ(read->friction_cone(at).coefficient, made->friction_cone(at).coefficient);
}

TEST(SpecimenFile, HasEveryType) {
  const Eigen::Vector3d at(20, 5, 700);
  EXPECT_EQ(parse_specimen(R"({"type": "beam", "shear": 0.9})", "")->displacement(at, kForce),
            make_specimen(Beam{.shear = 0.9})->displacement(at, kForce));
  EXPECT_EQ(parse_specimen(R"({"type": "elastic_body", "young_modulus": 0.2})", "")
                ->displacement(at, kForce),
            make_specimen(ElasticBody{.young_modulus = 0.2})->displacement(at, kForce));
}

std::string refused_specimen(const std::string& text) {
  try {
    (void)parse_specimen(text, "a.json");
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

TEST(SpecimenFile, SaysWhatIsWrong) {
  EXPECT_THAT(refused_specimen(""), HasSubstr("a.json: is not a JSON object"));
  EXPECT_THAT(refused_specimen("[1]"), HasSubstr("is not a JSON object"));
  EXPECT_THAT(refused_specimen("{}"),
              HasSubstr("has no 'type'; it must be sheet, beam, elastic_body or finite_elements"));
  EXPECT_THAT(refused_specimen(R"({"type": "ball"})"), HasSubstr("'type' is \"ball\""));
  EXPECT_THAT(refused_specimen(R"({"type": "beam", "tension": 1})"),
              HasSubstr("'tension' is unknown; a beam has type, length"));
  EXPECT_THAT(refused_specimen(R"({"type": "beam", "length": "long"})"),
              HasSubstr("'length' is \"long\"; it must be a number [mm]"));
  EXPECT_THAT(refused_specimen(R"({"type": "sheet", "block_low": [1]})"), HasSubstr("two numbers"));
  EXPECT_THAT(refused_specimen(R"({"type": "sheet", "friction": -1})"),
              HasSubstr("a.json: Sheet::friction is -1"));
}

TEST(SpecimenFile, MustExist) {
  EXPECT_THROW((void)read_specimen_text("/nowhere/a.json"), FileError);
}

}  // namespace
}  // namespace palpate::probing
