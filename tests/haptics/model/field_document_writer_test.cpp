// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "model_testing.h"
#include "palpate/haptics/rounding.h"
#include "repository.h"

namespace palpate::haptics {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

const fs::path kDocs = repository("docs");

bool is_valid(const json& document, const char* schema_file = "field.schema.json") {
  const json schema_document = json::parse(read_text(kDocs / schema_file));
  valijson::Schema schema;
  valijson::SchemaParser(valijson::SchemaParser::kDraft7)
      .populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_document), schema);
  return valijson::Validator().validate(schema, valijson::adapters::NlohmannJsonAdapter(document),
                                        nullptr);
}

TEST(FieldDocumentWriter, WritesExactlyTheNumbers) {
  for (const ModelEncoding encoding : {ModelEncoding::json, ModelEncoding::cbor}) {
    const FieldDocument read =
        read_field_document(field_document(some_model(), encoding), encoding);
    expect_same_document(read.model, some_model());
    EXPECT_TRUE(std::signbit(read.model.contacts[3].field.bases[0].weight));
    EXPECT_TRUE(read.weights_in_surface);
  }
}

// Only what was rounded is told in few digits, and exactly.
TEST(FieldDocumentWriter, LosesNoMoreThanTheLastBitsOfWhatIsNotRounded) {
  const Model model = moved(uneven_model(), some_motion());
  const Model read =
      read_field_document(field_document(model, ModelEncoding::json), ModelEncoding::json).model;
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
    const FieldDocument read = read_field_document(field_document(model, encoding), encoding);
    EXPECT_EQ(read.model.made.at("acquisition"), "messung_\xEF\xBF\xBD.db");
  }
}

TEST(FieldDocumentWriter, WritesWhatTheSchemaDescribes) {
  const json document = json::parse(field_document(some_model(), ModelEncoding::json));
  EXPECT_TRUE(is_valid(document));
  // The schema does look: each of these is refused.
  for (const char* pointer :
       {"/version", "/units/length", "/contacts/0/friction/source",
        "/contacts/0/friction/coefficient", "/contacts/1/friction/error",
        "/contacts/1/friction/lower_bound", "/contacts/0/bases/1/1", "/contacts/0/bases/1",
        "/contacts/0/ridges/0", "/contacts/1/rotation", "/contacts/1/fit/rms", "/triangles/0/1",
        "/registration/rotation/0", "/surface_weights", "/surface"}) {
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
  for (const char* member :
       {"format", "units", "contacts", "triangles", "made", "registration", "surface"}) {
    json broken = document;
    broken.erase(member);
    EXPECT_FALSE(is_valid(broken)) << member;
  }
}

TEST(FieldDocumentWriter, TheSchemasOfOlderVersionsDescribeTheirDocuments) {
  const json now = json::parse(field_document(some_model(), ModelEncoding::json));
  for (const std::string version : {"1", "2"}) {
    const json document = json::parse(
        read_text(repository("tests/haptics/data") / ("model_version_" + version) / "field.json"));
    const std::string schema = "field-v" + version + ".schema.json";
    EXPECT_TRUE(is_valid(document, schema.c_str())) << version;
    EXPECT_FALSE(is_valid(document)) << version;
    EXPECT_FALSE(is_valid(now, schema.c_str())) << version;
  }
}

// The examples of docs/model-file.md, by Python's standard library alone, against ours.
TEST(FieldDocumentWriter, PythonComputesTheSameForces) {
  const ScratchFolder scratch;
  const Model model = some_model();
  write_model(scratch / "model", model);
  std::string script, rest = read_text(kDocs / "model-file.md");
  constexpr std::string_view kBegin = "```python\n", kEnd = "```";
  for (std::size_t begin = 0; (begin = rest.find(kBegin)) != std::string::npos;) {
    rest.erase(0, begin + kBegin.size());
    const std::string part = rest.substr(0, rest.find(kEnd));
    EXPECT_LE(std::ranges::count(part, '\n'), 10) << "lines are to be few";
    script += part;
  }
  script +=
      "for contact in document['contacts']:\n"
      "    for d in [[1.2, -0.7, 2.5], [0.5, -0.2, 1.5], [1e-3, 2e-3, -1e-3], [40, 9, -30]]:\n"
      "        print(*force(contact, d))\n";
  write_text(scratch / "script.py", script);
  const std::string command = "cd '" + scratch.path().string() +
                              "' && '" PALPATE_PYTHON "' -I script.py > forces.txt 2> errors.txt";
  ASSERT_EQ(std::system(command.c_str()), 0) << read_text(scratch / "errors.txt");
  std::istringstream forces(read_text(scratch / "forces.txt"));
  std::string first_line;  // what the example prints
  std::getline(forces, first_line);
  EXPECT_EQ(first_line.front(), '[');
  for (const ContactModel& contact : model.contacts) {
    for (const Eigen::Vector3d& displacement :
         {Eigen::Vector3d(1.2, -0.7, 2.5), Eigen::Vector3d(0.5, -0.2, 1.5),
          Eigen::Vector3d(1e-3, 2e-3, -1e-3), Eigen::Vector3d(40, 9, -30)}) {
      Eigen::Vector3d found;
      ASSERT_TRUE(forces >> found.x() >> found.y() >> found.z());
      const Eigen::Vector3d expected =
          contact.frame * force(contact.field, contact.frame.transpose() * displacement);
      EXPECT_LE((found - expected).norm(), 1e-12 * expected.norm());
    }
  }
}

// 6 to 10 bases of both kinds, all that fits report, numbers of all magnitudes, rounded as
// `build_model` does.
TEST(FieldDocumentWriter, AHundredContactsTakeLessThanAHundredKilobytes) {
  Model model = sheet_model();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
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
    contact.fit_stop = "explained";
    contact.fit_mode = contact.passivity = "convex";
    contact.chi2 = std::exp(0.3 * normal(random));
    contact.noise_floor = 0.02;
    contact.condition = 100 * std::exp(normal(random));
    for (int k = 0; k < 6 + i % 5; ++k) {
      contact.field.bases.push_back({3 * std::exp(normal(random)), 2 * std::exp(normal(random)),
                                     5 * vector(),
                                     k % 2 ? vector().normalized() : Eigen::Vector3d::Zero()});
    }
    model.contacts.push_back(rounded(contact));
  }
  model.triangles = Eigen::Matrix3Xi::Constant(3, 180, 55);
  EXPECT_LT(field_document(model, ModelEncoding::json).size(), 100'000u);
}

}  // namespace
}  // namespace palpate::haptics
