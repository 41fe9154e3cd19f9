// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "model_testing.h"
#include "repository.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

std::string document_of_version(int version) {
  return read_text(repository("tests/haptics/data") / ("model_version_" + std::to_string(version)) /
                   "field.json");
}

// What reading says after a good document was changed; in CBOR as in JSON.
template <typename Change>
std::string refused_after(Change&& change,
                          const std::string& text = field_document(some_model(),
                                                                   ModelEncoding::json)) {
  json document = json::parse(text);
  change(document);
  const std::string changed = document.dump();
  const std::string message =
      refusal([&] { return read_field_document(changed, ModelEncoding::json); });
  const std::vector<std::uint8_t> cbor = json::to_cbor(document);
  EXPECT_EQ(refusal([&] {
              return read_field_document({cbor.begin(), cbor.end()}, ModelEncoding::cbor);
            }),
            message);
  return message;
}

TEST(FieldDocumentReader, NamesThePlaceAndWhatIsRight) {
  EXPECT_THAT(
      refused_after([](json& d) { d["contacts"][1]["position"][2] = nullptr; }),
      AllOf(HasSubstr("/contacts/1/position/2:"), HasSubstr("found null"), HasSubstr("a number")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][1].erase("bases"); }),
              AllOf(HasSubstr("/contacts/1:"), HasSubstr("\"bases\"")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["bases"][1].push_back(1); }),
              AllOf(HasSubstr("/contacts/0/bases/1:"), HasSubstr("five numbers")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["friction"]["source"] = "guess"; }),
              AllOf(HasSubstr("/contacts/0/friction/source:"), HasSubstr("found \"guess\""),
                    HasSubstr("\"samples\", \"other_contacts\", \"none\" or \"lower_bound\"")));
  EXPECT_THAT(refused_after([](json& d) { d["made"]["a/b~c"] = 7; }),
              HasSubstr("/made/a~1b~0c: found 7"));
  EXPECT_THAT(refused_after([](json& d) { d = json::array({1, 2}); }), HasSubstr("at the top"));
}

TEST(FieldDocumentReader, RefusesOtherUnitsFormatsAndVersions) {
  EXPECT_THAT(refused_after([](json& d) { d["format"] = "other"; }), HasSubstr("/format:"));
  EXPECT_THAT(refused_after([](json& d) { d["units"]["length"] = "m"; }),
              AllOf(HasSubstr("/units/length:"), HasSubstr("\"mm\"")));
  EXPECT_THAT(refused_after([](json& d) { d["units"]["force"] = "lbf"; }),
              AllOf(HasSubstr("/units/force:"), HasSubstr("\"N\"")));
  EXPECT_THAT(refused_after([](json& d) { d["surface"] = "../other.ply"; }),
              HasSubstr("/surface:"));
  EXPECT_THAT(refused_after([](json& d) { d["version"] = 0; }), HasSubstr("expected 1 to 3"));
  EXPECT_THAT(refused_after([](json& d) { d["version"] = 4; }),
              AllOf(HasSubstr("/version:"), HasSubstr("found 4"), HasSubstr("newer palpate")));
  EXPECT_THAT(refused_after([](json& d) {
                d["version"] = 4;
                d["made"]["program"] = "palpate 7.5";
              }),
              HasSubstr("palpate 7.5, which is needed"));
}

TEST(FieldDocumentReader, RefusesWhatCannotBe) {
  EXPECT_THAT(refused_after([](json& d) { d["triangles"][0][1] = 4; }),
              AllOf(HasSubstr("/triangles/0/1:"), HasSubstr("from 0 to 3")));
  EXPECT_THAT(refused_after([](json& d) { d["triangles"][0][1] = 1e300; }),
              HasSubstr("/triangles/0/1:"));
  EXPECT_THAT(refused_after([](json& d) { d["triangles"][0][1] = 0xFFFFFFFFFFFFFFFFu; }),
              HasSubstr("/triangles/0/1:"));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][3]["friction"]["coefficient"] = -1; }),
              AllOf(HasSubstr("/contacts/3/friction/coefficient:"), HasSubstr(">= 0")));
  EXPECT_THAT(refused_after([](json& d) {
                d["contacts"][3]["friction"]["axis"] = {0, 0, 0};
              }),
              AllOf(HasSubstr("/contacts/3/friction/axis:"), HasSubstr("not all zero")));
  EXPECT_THAT(refused_after([](json& d) {
                d["contacts"][2]["rotation"] = {0, 0, 0, 0};
              }),
              AllOf(HasSubstr("/contacts/2/rotation:"), HasSubstr("not all zero")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][2]["rotation"].erase(0); }),
              AllOf(HasSubstr("/contacts/2/rotation:"), HasSubstr("four numbers")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["bases"][0][1] = 0; }),
              AllOf(HasSubstr("/contacts/0/bases/0/1:"), HasSubstr("> 0")));
  EXPECT_THAT(refused_after([](json& d) {
                for (const std::size_t i : {2, 3, 4}) d["contacts"][0]["ridges"][0][i] = 0;
              }),
              AllOf(HasSubstr("/contacts/0/ridges/0:"), HasSubstr("last three")));
  EXPECT_THAT(refused_after([](json& d) {
                for (const std::size_t i : {2, 3, 4}) d["contacts"][0]["ridges"][0][i] = 1e-310;
              }),
              AllOf(HasSubstr("/contacts/0/ridges/0:"), HasSubstr("at least 1e-12")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["bases"][0][0] = 1.01e12; }),
              AllOf(HasSubstr("/contacts/0/bases/0/0:"), HasSubstr("at most 1e12")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][2]["id"] = 11; }),
              AllOf(HasSubstr("/contacts/2/id: found 11"), HasSubstr("contact 1 has this one")));
  EXPECT_THAT(refused_after([](json& d) { d["registration"]["rotation"][0][0] = 2; }),
              HasSubstr("/registration/rotation:"));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"].erase(0), d["contacts"].erase(0); }),
              AllOf(HasSubstr("/contacts:"), HasSubstr("at least three")));
}

// Also where the square of the length is no number.
TEST(FieldDocumentReader, TakesRotationsAndAxesOfAnyLength) {
  const Model expected = some_model();
  const json original = json::parse(field_document(expected, ModelEncoding::json));
  for (const double length : {-1e-300, 1e-170, 3.0, 1e11}) {
    json document = original;
    for (json& contact : document["contacts"]) {
      for (json& entry : contact["rotation"]) entry = entry.get<double>() * length;
      if (length < 0) continue;
      for (json& entry : contact["friction"]["axis"]) entry = entry.get<double>() * length;
    }
    const Model model = read_field_document(document.dump(), ModelEncoding::json).model;
    for (std::size_t i = 0; i < model.contacts.size(); ++i) {
      const ContactModel &is = model.contacts[i], &was = expected.contacts[i];
      EXPECT_TRUE(is.frame.isApprox(was.frame, 1e-14)) << length;
      EXPECT_TRUE(is.friction_axis.isApprox(was.friction_axis, 1e-14)) << length;
    }
  }
}

TEST(FieldDocumentReader, DoesWithoutWhatOlderFilesLack) {
  json document = json::parse(field_document(some_model(), ModelEncoding::json));
  Model expected = some_model();
  for (std::size_t i = 0; i < 4; ++i) {
    for (const char* member : {"error", "lower_bound"})
      EXPECT_EQ(document["contacts"][i]["friction"].erase(member), 1u);
    for (const char* member : {"mode", "chi2", "noise_floor", "condition"})
      EXPECT_EQ(document["contacts"][i]["fit"].erase(member), 1u);
    document["contacts"][i]["fit"].erase("passivity");
    expected.contacts[i].fit_mode = expected.contacts[i].passivity = "";
    expected.contacts[i].chi2 = expected.contacts[i].noise_floor = 0;
    expected.contacts[i].condition = 0;
    expected.contacts[i].friction_error = expected.contacts[i].friction_lower_bound = 0;
  }
  document["contacts"][1]["later"] = {1, 2};  // what files to come have more is not looked at
  expect_same_document(read_field_document(document.dump(), ModelEncoding::json).model, expected);
}

// JSON has no such numbers, CBOR does.
TEST(FieldDocumentReader, RefusesNumbersThatAreNotFinite) {
  json document = json::parse(field_document(some_model(), ModelEncoding::json));
  document["contacts"][0]["position"][1] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::uint8_t> bytes = json::to_cbor(document);
  EXPECT_THAT(refusal([&] {
                return read_field_document({bytes.begin(), bytes.end()}, ModelEncoding::cbor);
              }),
              AllOf(HasSubstr("/contacts/0/position/1:"), HasSubstr("finite")));
}

TEST(FieldDocumentReader, RefusesWrongDocumentsOfVersionOne) {
  const std::string text = document_of_version(1);
  EXPECT_THAT(
      refused_after([](json& d) { d["contacts"][0]["field"]["weights"].push_back(1); }, text),
      HasSubstr("as many centers as weights"));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][1]["field"]["epsilon"] = -1; }, text),
              HasSubstr("/contacts/1/field/epsilon:"));
  EXPECT_THAT(refused_after([](json& d) { d["surface_weights"]["contacts"].push_back(0); }, text),
              AllOf(HasSubstr("/surface_weights:"), HasSubstr("for each vertex")));
  EXPECT_THAT(refused_after([](json& d) { d["surface_weights"]["contacts"][7] = -2; }, text),
              HasSubstr("/surface_weights/contacts/7:"));
}

TEST(FieldDocumentReader, RefusesWrongDocumentsOfVersionTwo) {
  const std::string text = document_of_version(2);
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][3]["friction"]["axis"][0] = 0.9; }, text),
              AllOf(HasSubstr("/contacts/3/friction/axis:"), HasSubstr("unit vector")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][2]["axes"][0][0] = 0.9; }, text),
              AllOf(HasSubstr("/contacts/2/axes:"), HasSubstr("right-handed")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["bases"][0].push_back(1); }, text),
              AllOf(HasSubstr("/contacts/0/bases/0:"), HasSubstr("eight numbers")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["bases"][1][5] = 0.5; }, text),
              AllOf(HasSubstr("/contacts/0/bases/1:"), HasSubstr("unit vector, or zeros")));
}

TEST(FieldDocumentReader, RefusesEveryTruncation) {
  for (const ModelEncoding encoding : {ModelEncoding::json, ModelEncoding::cbor}) {
    const std::string whole = field_document(some_model(), encoding);
    // The last bytes of the text are a brace and a line's end.
    for (std::size_t length = 0; length + 2 <= whole.size(); ++length) {
      EXPECT_THROW(static_cast<void>(read_field_document(whole.substr(0, length), encoding)),
                   InvalidInput)
          << length;
    }
  }
}

TEST(FieldDocumentReader, SurvivesDamagedBytes) {
  std::mt19937 random(5);
  int refused = 0, read = 0;
  for (const ModelEncoding encoding : {ModelEncoding::json, ModelEncoding::cbor}) {
    const std::string whole = field_document(some_model(), encoding);
    for (int trial = 0; trial < 2000; ++trial) {
      std::string damaged = whole;
      for (int i = 0; i <= trial % 3; ++i) {
        damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
      }
      try {
        static_cast<void>(read_field_document(damaged, encoding));
        ++read;
      } catch (const InvalidInput&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 1000);  // a changed digit is not noticed
  EXPECT_GT(read, 100);
}

TEST(FieldDocumentReader, RefusesADeepNestOfLists) {
  constexpr std::size_t kDeep = 1'000'000;
  EXPECT_THAT(
      refusal([] { return read_field_document(std::string(kDeep, '['), ModelEncoding::json); }),
      HasSubstr("nested too deeply"));
  EXPECT_THAT(
      refusal([] { return read_field_document(std::string(kDeep, '\x81'), ModelEncoding::cbor); }),
      HasSubstr("nested too deeply"));
}

}  // namespace
}  // namespace palpate::haptics
