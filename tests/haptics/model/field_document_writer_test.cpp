// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "model/field_document_format.h"
#include "model_testing.h"
#include "palpate/haptics/rounding.h"
#include "repository.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

bool is_valid(const json& document) {
  const json schema_document = json::parse(read_text(repository("docs/field.schema.json")));
  valijson::Schema schema;
  valijson::SchemaParser(valijson::SchemaParser::kDraft7)
      .populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_document), schema);
  return valijson::Validator().validate(schema, valijson::adapters::NlohmannJsonAdapter(document),
                                        nullptr);
}

TEST(FieldDocumentWriter, WritesExactlyTheNumbers) {
  for (const ModelEncoding encoding : {ModelEncoding::json, ModelEncoding::cbor}) {
    const Model read = read_field_document(field_document(some_model(), encoding), encoding);
    expect_same_document(read, some_model());
    EXPECT_TRUE(std::signbit(read.contacts[3].field.bases[0].weight));
  }
}

// Only what was rounded is told in few digits, and exactly.
TEST(FieldDocumentWriter, LosesNoMoreThanTheLastBitsOfWhatIsNotRounded) {
  const Model model = moved(uneven_model(), some_motion());
  const Model read =
      read_field_document(field_document(model, ModelEncoding::json), ModelEncoding::json);
  constexpr double kLastBits = 1e-14;  // some tens of units in the last place, relative
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const ContactModel &is = read.contacts[i], &was = model.contacts[i];
    EXPECT_EQ(is.position, was.position);
    EXPECT_LE((is.frame - was.frame).norm(), kLastBits);
    EXPECT_LE((is.friction_axis - was.friction_axis).norm(), kLastBits);
    const Eigen::Vector3d displacement(1.2, -0.7, 2.5);
    EXPECT_LE((force(is.field, displacement) - force(was.field, displacement)).norm(),
              kLastBits * weight_sum(was.field));
  }
}

TEST(FieldDocumentWriter, WritesNothingThatItsReaderRefuses) {
  Model model = some_model();
  model.contacts[0].position.x() = 2e12;
  EXPECT_THAT(refusal([&] { return field_document(model, ModelEncoding::cbor); }),
              AllOf(HasSubstr("2000000000000"), HasSubstr("1e12")));
  model = some_model();
  model.contacts[1].field.bases = {{1, 1e-13, {0, 0, 0}, {0, 0, 1}}};
  EXPECT_THAT(refusal([&] { return field_document(model, ModelEncoding::json); }),
              HasSubstr("a ridge"));
}

TEST(FieldDocumentWriter, WritesOneDocumentInTwoEncodings) {
  const std::string text = field_document(some_model(), ModelEncoding::json);
  const std::string cbor = field_document(some_model(), ModelEncoding::cbor);
  EXPECT_EQ(json::parse(text), json::from_cbor(cbor));
}

TEST(FieldDocumentWriter, WritesTheNameOfAFileThatIsNotUtf8) {
  Model model = some_model();
  model.made["acquisition"] = "messung_\xE9.db";
  for (const ModelEncoding encoding : {ModelEncoding::json, ModelEncoding::cbor}) {
    const Model read = read_field_document(field_document(model, encoding), encoding);
    EXPECT_EQ(read.made.at("acquisition"), "messung_\xEF\xBF\xBD.db");
  }
}

TEST(FieldDocumentWriter, WritesWhatTheSchemaDescribes) {
  const json document = json::parse(field_document(some_model(), ModelEncoding::json));
  EXPECT_TRUE(is_valid(document));
  // The schema does look: each of these is refused.
  for (const char* pointer : {"/version",
                              "/units/length",
                              "/contacts/0/friction/source",
                              "/contacts/0/friction/coefficient",
                              "/contacts/1/friction/error",
                              "/contacts/1/friction/lower_bound",
                              "/contacts/0/bases/1/1",
                              "/contacts/0/bases/1",
                              "/contacts/0/ridges/0",
                              "/contacts/1/rotation",
                              "/contacts/1/fit/rms",
                              "/triangles/0/1",
                              "/contacts/0/fit/stop",
                              "/contacts/0/fit/passivity",
                              "/contacts/1/compliance/direction",
                              "/contacts/1/compliance/values/2",
                              "/contacts/1/compliance/trend/4",
                              "/contacts/1/friction/load_exponent",
                              "/friction_force",
                              "/rate/0/share",
                              "/rate/1/time",
                              "/triangulation",
                              "/samples_fingerprint",
                              "/pressing_offsets/force_found",
                              "/pressing_offsets/force_offset",
                              "/pressing_offsets/force_offset_error/1",
                              "/pressing_offsets/along_pressing",
                              "/pressing_offsets/touch_found",
                              "/pressing_offsets/touch_offset_error",
                              "/pressing_offsets/touch_offset_spread",
                              "/pressing_offsets/surface_slope_error",
                              "/pressing_offsets/hysteresis_error",
                              "/interpolation/reach",
                              "/interpolation/rule",
                              "/registration/rotation/0",
                              "/surface"}) {
    json broken = document;
    broken[json::json_pointer(pointer)] = -1.5;
    EXPECT_FALSE(is_valid(broken)) << pointer;
  }
  for (const char* pointer :
       {"/contacts/1/position/2", "/contacts/0/bases/0/4", "/contacts/0/ridges/0/4"}) {
    json broken = document;
    broken[json::json_pointer(pointer)] = -1.5;
    EXPECT_TRUE(is_valid(broken)) << pointer;
    broken[json::json_pointer(pointer)] = 1.1e12;
    EXPECT_FALSE(is_valid(broken)) << pointer;
  }
  for (const char* member : {"format", "units", "contacts", "triangles", "made", "registration",
                             "surface", "interpolation"}) {
    json broken = document;
    broken.erase(member);
    EXPECT_FALSE(is_valid(broken)) << member;
  }
  for (const auto& [member, value] : document["pressing_offsets"].items()) {
    json broken = document;
    broken["pressing_offsets"].erase(member);
    EXPECT_FALSE(is_valid(broken)) << member;
  }
  json twice = document;
  twice["pressing_offsets"]["hysteresis"] = 1;
  EXPECT_FALSE(is_valid(twice));
  for (const char* member : {"reference_force", "reach"}) {
    json broken = document;
    broken["interpolation"].erase(member);
    EXPECT_FALSE(is_valid(broken)) << member;
    broken["interpolation"]["rule"] = "forces";
    EXPECT_TRUE(is_valid(broken)) << member;
  }
}

// Every word that the schema allows is one that the reader knows, and the other way round.
TEST(FieldDocumentWriter, TheSchemaHasTheWordsOfTheEnumerations) {
  const json schema = json::parse(read_text(repository("docs/field.schema.json")));
  const auto expect_words = [](const json& listed, const auto& values) {
    json words = json::array();
    for (const auto value : values) words.push_back(to_string(value));
    EXPECT_EQ(listed.at("enum"), words);
  };
  expect_words(schema["properties"]["interpolation"]["properties"]["rule"], kBlendRules);
  expect_words(schema["properties"]["triangulation"], kTriangulations);
  const json& contact = schema["definitions"]["contact"]["properties"];
  expect_words(contact["friction"]["properties"]["source"], kFrictionSources);
  expect_words(contact["fit"]["properties"]["stop"], kFitStops);
  expect_words(contact["fit"]["properties"]["mode"], kFitModes);
  expect_words(contact["fit"]["properties"]["passivity"], kPassivities);
}

TEST(FieldDocumentWriter, LeavesOutWhatIsNotKnown) {
  Model model = some_model();
  model.contacts[0].friction_error = model.contacts[0].chi2 = std::nullopt;
  model.contacts[0].noise_floor = model.contacts[0].condition = std::nullopt;
  model.contacts[0].fit_stop = std::nullopt;
  model.contacts[0].fit_mode = std::nullopt;
  model.contacts[0].passivity = std::nullopt;
  model.contacts[0].compliance = std::nullopt;
  model.samples_fingerprint = std::nullopt;
  model.pressing_offsets = std::nullopt;
  const json document = json::parse(field_document(model, ModelEncoding::json));
  EXPECT_EQ(document["contacts"][0]["fit"], (json{{"samples", 100}, {"rms", 0}}));
  EXPECT_FALSE(document["contacts"][0]["friction"].contains("error"));
  EXPECT_FALSE(document["contacts"][0].contains("compliance"));
  EXPECT_FALSE(document.contains("samples_fingerprint") || document.contains("pressing_offsets"));
  EXPECT_TRUE(is_valid(document));
  expect_same_document(read_field_document(document.dump(), ModelEncoding::json), model);
}

// 6 to 10 bases of both kinds, compliances and all figures of a fit, numbers of all magnitudes,
// rounded as `build_model` does. Compliances and their trends take about 45 kB of it.
TEST(FieldDocumentWriter, AHundredContactsTakeLessThan140Kilobytes) {
  Model model = sheet_model();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d{normal(random), normal(random), normal(random)};
  };
  model.contacts.clear();
  for (int i = 0; i < 100; ++i) {
    ContactModel contact;
    contact.id = i;
    contact.position = vector() * 100;
    contact.frame = rotation_exp(vector());
    contact.friction = 0.5 + 0.01 * normal(random);
    contact.friction_axis = vector().normalized();
    contact.friction_error = 0.005 * std::exp(normal(random));
    contact.friction_lower_bound = 0.49 + 0.01 * normal(random);
    contact.samples = 1000;
    contact.rms = 0.02 + 0.001 * normal(random);
    contact.fit_stop = FitStop::explained;
    contact.fit_mode = FitMode::convex;
    contact.passivity = Passivity::convex;
    contact.chi2 = std::exp(0.3 * normal(random));
    contact.noise_floor = 0.02;
    contact.condition = 100 * std::exp(normal(random));
    for (int k = 0; k < 6 + i % 5; ++k) {
      contact.field.bases.push_back({3 * std::exp(normal(random)), 2 * std::exp(normal(random)),
                                     5 * vector(),
                                     k % 2 ? vector().normalized() : Eigen::Vector3d::Zero()});
    }
    contact.position = rounded_position(contact.position, 100);
    model.contacts.push_back(rounded(contact));
  }
  model.triangles = Eigen::Matrix3Xi::Constant(3, 180, 55);
  EXPECT_LT(field_document(model, ModelEncoding::json).size(), 100'000u);
  for (ContactModel& contact : model.contacts) {
    const auto digits = [&](int count, double scale) {
      return round_to_digits(scale * normal(random), count);
    };
    ContactCompliance& compliance = contact.compliance.emplace();
    compliance.direction =
        vector().normalized().unaryExpr([](double entry) { return round_to_places(entry, 10); });
    for (double& value : compliance.values) value = digits(7, 10);
    for (double& derivative : compliance.trend.reshaped()) derivative = digits(5, 0.01);
  }
  EXPECT_LT(field_document(model, ModelEncoding::json).size(), 140'000u);
}

}  // namespace
}  // namespace palpate::haptics
