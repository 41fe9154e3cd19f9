// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "model_testing.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

// The message of reading after a good document was changed; in CBOR as in JSON.
template <typename Change>
std::string refused_document(Change&& change) {
  json document = json::parse(field_document(some_model(), ModelEncoding::json));
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
      refused_document([](json& d) { d["contacts"][1]["position"][2] = nullptr; }),
      AllOf(HasSubstr("/contacts/1/position/2:"), HasSubstr("found null"), HasSubstr("a number")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][1].erase("bases"); }),
              AllOf(HasSubstr("/contacts/1:"), HasSubstr("\"bases\"")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][0]["bases"][1].push_back(1); }),
              AllOf(HasSubstr("/contacts/0/bases/1:"), HasSubstr("five numbers")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][0]["friction"]["source"] = "guess"; }),
              AllOf(HasSubstr("/contacts/0/friction/source:"), HasSubstr("found \"guess\""),
                    HasSubstr("\"samples\", \"other_contacts\", \"none\" or \"lower_bound\"")));
  EXPECT_THAT(refused_document([](json& d) { d["made"]["a/b~c"] = 7; }),
              HasSubstr("/made/a~1b~0c: found 7"));
  EXPECT_THAT(refused_document([](json& d) {
                d = json::array({1, 2});
              }),
              AllOf(HasSubstr("at the top: found ["), HasSubstr("an object")));
  EXPECT_THAT(refused_document([](json& d) { d = 7; }), HasSubstr("at the top: found 7"));
  EXPECT_THAT(refused_document([](json& d) { d.erase("triangles"); }),
              HasSubstr("an object with the member \"triangles\""));
  EXPECT_THAT(refused_document([](json& d) {
                d["contacts"] = {{"1", 2}};
              }),
              AllOf(HasSubstr("/contacts: found {"), HasSubstr("an array")));
  EXPECT_THAT(refused_document([](json& d) {
                d["contacts"][2] = {1, {2}};
              }),
              AllOf(HasSubstr("/contacts/2: found ["), HasSubstr("an object")));
  EXPECT_THAT(refused_document([](json& d) { d["triangles"][1] = 5; }),
              AllOf(HasSubstr("/triangles/1: found 5"), HasSubstr("an array")));
  EXPECT_THAT(
      refused_document([](json& d) { d["contacts"][1]["compliance"]["trend"][3][5] = "1"; }),
      AllOf(HasSubstr("/contacts/1/compliance/trend/3/5: found \"1\""), HasSubstr("a number")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][1]["compliance"]["trend"].erase(0); }),
              AllOf(HasSubstr("/contacts/1/compliance/trend:"), HasSubstr("five derivatives")));
  const auto with_strength = [](const json& value, const json& trend) {
    return refused_document([&](json& d) {
      d["contacts"][1]["strength"] = {{"value", value}, {"trend", trend}};
    });
  };
  EXPECT_THAT(
      with_strength(-0.1, {0, 0, 0, 0, 0}),
      AllOf(HasSubstr("/contacts/1/strength/value: found -0.1"), HasSubstr("a number >= 0")));
  EXPECT_THAT(with_strength(1, {0, 0, 0, 0}),
              AllOf(HasSubstr("/contacts/1/strength/trend:"), HasSubstr("five numbers")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][1]["compliance"]["values"].erase(0); }),
              AllOf(HasSubstr("/contacts/1/compliance/values:"), HasSubstr("six numbers")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][1]["fit"]["mode"] = "concave"; }),
              AllOf(HasSubstr("/contacts/1/fit/mode: found \"concave\""),
                    HasSubstr("\"convex\", \"certified\" or \"local\"")));
  EXPECT_THAT(refused_document([](json& d) { d["interpolation"].erase("reach"); }),
              AllOf(HasSubstr("/interpolation:"), HasSubstr("\"reach\"")));
}

TEST(FieldDocumentReader, RefusesOtherUnitsFormatsAndVersions) {
  EXPECT_THAT(refused_document([](json& d) { d["format"] = "other"; }), HasSubstr("/format:"));
  EXPECT_THAT(refused_document([](json& d) { d["units"]["length"] = "m"; }),
              AllOf(HasSubstr("/units/length:"), HasSubstr("\"mm\"")));
  EXPECT_THAT(refused_document([](json& d) { d["units"]["force"] = "lbf"; }),
              AllOf(HasSubstr("/units/force:"), HasSubstr("\"N\"")));
  EXPECT_THAT(refused_document([](json& d) { d["surface"] = "../other.ply"; }),
              HasSubstr("/surface:"));
  EXPECT_THAT(refused_document([](json& d) { d["version"] = 0; }), HasSubstr("expected 1"));
  EXPECT_THAT(refused_document([](json& d) { d["version"] = 2; }),
              AllOf(HasSubstr("/version:"), HasSubstr("found 2"), HasSubstr("newer palpate")));
  // Whatever else differs in a newer document, wherever it says that it is one.
  EXPECT_THAT(refused_document([](json& d) {
                d["version"] = 2;
                d["made"]["program"] = "palpate 7.5";
                d["contacts"][1].erase("bases");
                d["units"] = "SI";
              }),
              HasSubstr("palpate 7.5, which is needed"));
}

TEST(FieldDocumentReader, RefusesWhatCannotBe) {
  EXPECT_THAT(refused_document([](json& d) { d["triangles"][0][1] = 4; }),
              AllOf(HasSubstr("/triangles/0/1:"), HasSubstr("from 0 to 3")));
  EXPECT_THAT(refused_document([](json& d) { d["triangles"][0][1] = 1e300; }),
              HasSubstr("/triangles/0/1:"));
  EXPECT_THAT(refused_document([](json& d) { d["triangles"][0][1] = 0xFFFFFFFFFFFFFFFFu; }),
              HasSubstr("/triangles/0/1:"));
  EXPECT_THAT(
      refused_document([](json& d) { d["contacts"][3]["friction"]["load_exponent"] = 0.6; }),
      AllOf(HasSubstr("/contacts/3/friction/load_exponent:"), HasSubstr("0.5")));
  EXPECT_THAT(refused_document([](json& d) { d.erase("friction_force"); }),
              AllOf(HasSubstr("/contacts/1/friction/load_exponent:"), HasSubstr("friction_force")));
  EXPECT_THAT(refused_document([](json& d) { d["rate"][1]["time"] = 0; }),
              AllOf(HasSubstr("/rate/1/time:"), HasSubstr("> 0")));
  EXPECT_THAT(refused_document([](json& d) { d["rate"].push_back(d["rate"][0]); }),
              AllOf(HasSubstr("/rate:"), HasSubstr("two terms")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][3]["friction"]["coefficient"] = -1; }),
              AllOf(HasSubstr("/contacts/3/friction/coefficient:"), HasSubstr(">= 0")));
  EXPECT_THAT(refused_document([](json& d) {
                d["contacts"][3]["friction"]["axis"] = {0, 0, 0};
              }),
              AllOf(HasSubstr("/contacts/3/friction/axis:"), HasSubstr("not all zero")));
  EXPECT_THAT(refused_document([](json& d) {
                d["contacts"][2]["rotation"] = {0, 0, 0, 0};
              }),
              AllOf(HasSubstr("/contacts/2/rotation:"), HasSubstr("not all zero")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][2]["rotation"].erase(0); }),
              AllOf(HasSubstr("/contacts/2/rotation:"), HasSubstr("four numbers")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][0]["bases"][0][1] = 0; }),
              AllOf(HasSubstr("/contacts/0/bases/0/1:"), HasSubstr("> 0")));
  EXPECT_THAT(refused_document([](json& d) {
                for (const std::size_t i : {2, 3, 4}) d["contacts"][0]["ridges"][0][i] = 0;
              }),
              AllOf(HasSubstr("/contacts/0/ridges/0:"), HasSubstr("last three")));
  EXPECT_THAT(refused_document([](json& d) {
                for (const std::size_t i : {2, 3, 4}) d["contacts"][0]["ridges"][0][i] = 1e-310;
              }),
              AllOf(HasSubstr("/contacts/0/ridges/0:"), HasSubstr("at least 1e-12")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][0]["bases"][0][0] = 1.01e12; }),
              AllOf(HasSubstr("/contacts/0/bases/0/0:"), HasSubstr("at most 1e12")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"][2]["id"] = 11; }),
              AllOf(HasSubstr("/contacts/2/id: found 11"), HasSubstr("contact 1 has this one")));
  EXPECT_THAT(refused_document([](json& d) { d["registration"]["rotation"][0][0] = 2; }),
              HasSubstr("/registration/rotation:"));
  EXPECT_THAT(refused_document([](json& d) { d["triangulation"] = "by hand"; }),
              AllOf(HasSubstr("/triangulation:"), HasSubstr("\"delaunay\" or \"voronoi_dual\"")));
  EXPECT_THAT(refused_document([](json& d) { d["samples_fingerprint"] = "0123456789ABCDEF"; }),
              AllOf(HasSubstr("/samples_fingerprint:"), HasSubstr("16 hexadecimal digits")));
  EXPECT_THAT(refused_document([](json& d) { d["samples_fingerprint"] = 7; }),
              AllOf(HasSubstr("/samples_fingerprint: found 7"), HasSubstr("a string")));
  EXPECT_THAT(refused_document([](json& d) { d["contacts"].erase(0), d["contacts"].erase(0); }),
              AllOf(HasSubstr("/contacts:"), HasSubstr("at least three")));
}

TEST(FieldDocumentReader, RefusesOffsetsThatCannotBe) {
  const json offsets =
      json::parse(field_document(some_model(), ModelEncoding::json))["pressing_offsets"];
  for (const auto& [key, value] : offsets.items()) {
    const std::string place = "/pressing_offsets/" + key;
    EXPECT_THAT(refused_document([&, key = key](json& d) { d["pressing_offsets"].erase(key); }),
                AllOf(HasSubstr("/pressing_offsets:"), HasSubstr('"' + key + '"')));
    EXPECT_THAT(refused_document([&, key = key](json& d) { d["pressing_offsets"][key] = nullptr; }),
                AllOf(HasSubstr(place), HasSubstr("found null")));
    if (!key.ends_with("_error") && !key.ends_with("_spread")) continue;
    EXPECT_THAT(refused_document([&, key = key](json& d) {
                  json& error = d["pressing_offsets"][key];
                  (error.is_array() ? error[2] : error) = -1;
                }),
                AllOf(HasSubstr(place), HasSubstr(">= 0")));
  }
  EXPECT_THAT(refused_document([](json& d) { d["pressing_offsets"]["hysteresis"] = 1; }),
              AllOf(HasSubstr("/pressing_offsets/hysteresis:"), HasSubstr("< 1")));
  EXPECT_THAT(
      refused_document([](json& d) { d["pressing_offsets"]["force_offset_error"].erase(0); }),
      AllOf(HasSubstr("/pressing_offsets/force_offset_error:"), HasSubstr("three numbers")));
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
    const Model model = read_field_document(document.dump(), ModelEncoding::json);
    for (std::size_t i = 0; i < model.contacts.size(); ++i) {
      const ContactModel &is = model.contacts[i], &was = expected.contacts[i];
      EXPECT_TRUE(is.frame.isApprox(was.frame, 1e-14)) << length;
      EXPECT_TRUE(is.friction_axis.isApprox(was.friction_axis, 1e-14)) << length;
    }
  }
}

TEST(FieldDocumentReader, IgnoresMembersThatItDoesNotKnow) {
  json document = json::parse(field_document(some_model(), ModelEncoding::json));
  document["contacts"][1]["later"] = {1, 2};
  document["later"] = {{"contacts", {1, 2}}};
  expect_same_document(read_field_document(document.dump(), ModelEncoding::json), some_model());
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
