// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_file.h"
#include "palpate/documents/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"
#include "scratch_folder.h"

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
  EXPECT_THAT(refused_specimen(""), HasSubstr("a.json: is not JSON"));
  EXPECT_THAT(refused_specimen("[1]"), HasSubstr("found [1], expected an object"));
  EXPECT_THAT(refused_specimen("{}"), HasSubstr("an object with the member \"type\""));
  EXPECT_THAT(refused_specimen(R"({"type": "ball"})"),
              HasSubstr("at /type: found \"ball\", expected \"sheet\", \"beam\""));
  EXPECT_THAT(refused_specimen(R"({"type": "beam", "tension": 1})"),
              HasSubstr("'tension' is unknown; there are type, length"));
  EXPECT_THAT(refused_specimen(R"({"type": "beam", "length": "long"})"),
              HasSubstr("/length: found \"long\", expected a number > 0 and finite [mm]"));
  EXPECT_THAT(refused_specimen(R"({"type": "sheet", "block_low": [1]})"), HasSubstr("two numbers"));
  EXPECT_THAT(refused_specimen(R"({"type": "sheet", "friction": -1})"),
              HasSubstr("a.json: at /friction: found -1, expected a number >= 0"));
}

TEST(SpecimenFile, MayBeYaml) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "a.yaml") << "type: beam\nshear: 0.9\n";
  const auto read = parse_specimen(documents::read_json_text(scratch / "a.yaml"), "a.yaml");
  const Eigen::Vector3d at(20, 5, 700);
  EXPECT_EQ(read->displacement(at, kForce),
            make_specimen(Beam{.shear = 0.9})->displacement(at, kForce));
}

}  // namespace
}  // namespace palpate::probing
