// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "palpate/geometry/mesh_io.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

void expect_same(const Model& left, const Model& right) {
  EXPECT_EQ(left.surface.vertices, right.surface.vertices);
  EXPECT_EQ(left.surface.triangles, right.surface.triangles);
  EXPECT_EQ(left.triangles, right.triangles);
  EXPECT_EQ(left.surface_weights.contacts, right.surface_weights.contacts);
  EXPECT_EQ(left.surface_weights.weights, right.surface_weights.weights);
  EXPECT_EQ(left.made, right.made);
  EXPECT_EQ(left.T_surface_acquisition.matrix(), right.T_surface_acquisition.matrix());
  ASSERT_EQ(left.contacts.size(), right.contacts.size());
  for (std::size_t i = 0; i < left.contacts.size(); ++i) {
    const ContactModel &l = left.contacts[i], &r = right.contacts[i];
    EXPECT_EQ(l.id, r.id);
    EXPECT_EQ(l.position, r.position);
    EXPECT_EQ(l.frame, r.frame);
    EXPECT_EQ(l.field, r.field);
    EXPECT_EQ(l.friction, r.friction);
    EXPECT_EQ(l.friction_source, r.friction_source);
    EXPECT_EQ(l.friction_axis, r.friction_axis);
    EXPECT_EQ(l.samples, r.samples);
    EXPECT_EQ(l.rms, r.rms);
    EXPECT_EQ(l.fit_stop, r.fit_stop);
  }
}

Model some_model() {
  Model model = moved(uneven_model(), some_motion());
  model.T_surface_acquisition = some_motion();
  model.contacts[1].friction_source = FrictionSource::other_contacts;
  model.contacts[2].field = {};
  model.surface_weights = geometry::project_weights(model.surface, contact_mesh(model));
  return model;
}

bool is_valid(const json& document) {
  const json schema_document = json::parse(
      read_text(std::filesystem::path(PALPATE_SOURCE_DIR) / "docs" / "field.schema.json"));
  valijson::Schema schema;
  valijson::SchemaParser(valijson::SchemaParser::kDraft7)
      .populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_document), schema);
  return valijson::Validator().validate(schema, valijson::adapters::NlohmannJsonAdapter(document),
                                        nullptr);
}

// What reading says after the document of a good model was changed.
template <typename Change>
std::string refused_after(Change&& change) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "model";
  write_model(folder, some_model());
  json document = json::parse(read_text(folder / "field.json"));
  change(document);
  write_text(folder / "field.json", document.dump());
  return refusal([&] { return read_model(folder); });
}

TEST(ModelIo, ReadsBackExactlyWhatWasWritten) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "new" / "model";
  write_model(folder, some_model());
  write_model(folder, some_model());
  expect_same(read_model(folder), some_model());
}

TEST(ModelIo, SavesTheTriangulationAsAMeshToo) {
  const ScratchFolder scratch;
  write_model(scratch / "model", some_model());
  const geometry::TriangleMesh mesh = geometry::read_mesh(scratch / "model" / "contacts.ply");
  EXPECT_EQ(mesh.vertices, contact_mesh(some_model()).vertices);
  EXPECT_EQ(mesh.triangles, some_model().triangles);
}

TEST(ModelIo, ReadsTheSameDocumentInCbor) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "model";
  write_model(folder, some_model());
  const std::vector<std::uint8_t> bytes =
      json::to_cbor(json::parse(read_text(folder / "field.json")));
  const std::string cbor(bytes.begin(), bytes.end());
  write_text(folder / "field.cbor", cbor);
  std::filesystem::remove(folder / "field.json");
  expect_same(read_model(folder), some_model());
  write_text(folder / "field.cbor", cbor.substr(0, cbor.size() / 2));
  EXPECT_THAT(refusal([&] { return read_model(folder); }),
              AllOf(HasSubstr("field.cbor"), HasSubstr("CBOR")));
}

TEST(ModelIo, WritesWhatTheSchemaDescribes) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "model";
  write_model(folder, some_model());
  const json document = json::parse(read_text(folder / "field.json"));
  EXPECT_TRUE(is_valid(document));
  // The schema does look: each of these is refused.
  for (const char* pointer :
       {"/version", "/contacts/1/position/2", "/contacts/0/friction/source",
        "/contacts/1/field/epsilons/0", "/triangles/0/1", "/registration/rotation/0",
        "/surface_weights/contacts/4", "/surface_weights/weights/4"}) {
    json broken = document;
    broken[json::json_pointer(pointer)] = -1.5;
    const bool still_a_number = std::string(pointer) == "/contacts/1/position/2";
    EXPECT_EQ(is_valid(broken), still_a_number) << pointer;
  }
  for (const char* member : {"units", "contacts", "triangles", "made", "registration"}) {
    json broken = document;
    broken.erase(member);
    EXPECT_FALSE(is_valid(broken)) << member;
  }
}

// The formula in the schema's description, evaluated on the document alone.
TEST(ModelIo, TheDocumentAloneGivesTheForces) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "model";
  write_model(folder, some_model());
  const json contact = json::parse(read_text(folder / "field.json"))["contacts"][3];
  const Eigen::Vector3d displacement(1.2, -0.7, 2.5);
  const auto vector = [](const json& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  Eigen::Vector3d local, force = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i)
    local[i] = vector(contact["axes"][static_cast<std::size_t>(i)]).dot(displacement);
  for (std::size_t k = 0; k < contact["field"]["weights"].size(); ++k) {
    const Eigen::Vector3d ridge = vector(contact["field"]["ridges"][k]);
    const auto seen = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
      return ridge.norm() > 0 ? Eigen::Vector3d(ridge.dot(v) * ridge) : v;
    };
    const Eigen::Vector3d g = seen(vector(contact["field"]["centers"][k])), l = seen(local);
    const double weight = contact["field"]["weights"][k];
    const double epsilon = contact["field"]["epsilons"][k];
    force += weight *
             ((l - g) / std::hypot((l - g).norm(), epsilon) + g / std::hypot(g.norm(), epsilon));
  }
  const ContactModel truth = some_model().contacts[3];
  EXPECT_TRUE(
      force.isApprox(haptics::force(truth.field, truth.frame.transpose() * displacement), 1e-13));
}

TEST(ModelIo, NamesThePlaceAndWhatIsRight) {
  EXPECT_THAT(refused_after([](json& d) { d["version"] = 3; }),
              AllOf(HasSubstr("field.json"), HasSubstr("/version"), HasSubstr("found 3"),
                    HasSubstr("expected 2")));
  EXPECT_THAT(refused_after([](json& d) { d["format"] = "other"; }), HasSubstr("/format"));
  EXPECT_THAT(
      refused_after([](json& d) { d["contacts"][1]["position"][2] = nullptr; }),
      AllOf(HasSubstr("/contacts/1/position/2"), HasSubstr("found null"), HasSubstr("a number")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][1].erase("field"); }),
              AllOf(HasSubstr("/contacts/1:"), HasSubstr("\"field\"")));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["field"]["weights"].push_back(1); }),
              HasSubstr("as many centers"));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][0]["friction"]["source"] = "guess"; }),
              HasSubstr("/contacts/0/friction/source"));
  EXPECT_THAT(refused_after([](json& d) { d["triangles"][0][1] = 99; }),
              AllOf(HasSubstr("field.json"), HasSubstr("99")));
  EXPECT_THAT(refused_after([](json& d) { d["surface_weights"]["contacts"].push_back(0); }),
              AllOf(HasSubstr("/surface_weights"), HasSubstr("for each vertex")));
  EXPECT_THAT(refused_after([](json& d) { d["surface_weights"]["contacts"][7] = -2; }),
              HasSubstr("/surface_weights/contacts/7"));
  EXPECT_THAT(refused_after([](json& d) { d["surface_weights"]["weights"][0] = 7; }),
              HasSubstr("vertex 0"));
  EXPECT_THAT(refused_after([](json& d) { d["triangles"][0][1] = 1e300; }),
              HasSubstr("/triangles/0/1"));
  EXPECT_THAT(refused_after([](json& d) { d["contacts"][3]["friction"]["coefficient"] = -1; }),
              AllOf(HasSubstr("contact 13"), HasSubstr(">= 0")));
  EXPECT_THAT(refused_after([](json& d) { d = json::array({1, 2}); }), HasSubstr("at the top"));
}

TEST(ModelIo, RefusesMissingEmptyAndTruncatedFiles) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "model";
  EXPECT_THAT(refusal([&] { return read_model(folder); }), HasSubstr("no such folder"));
  std::filesystem::create_directories(folder);
  EXPECT_THAT(refusal([&] { return read_model(folder); }),
              HasSubstr("neither field.json nor field.cbor"));
  write_model(folder, some_model());
  const std::string whole = read_text(folder / "field.json");
  for (std::size_t length = 0; length + 2 < whole.size(); length += 331) {
    write_text(folder / "field.json", whole.substr(0, length));
    EXPECT_THAT(refusal([&] { return read_model(folder); }), HasSubstr("field.json"));
  }
  write_text(folder / "field.json", whole);
  std::filesystem::remove(folder / "surface.ply");
  EXPECT_THAT(refusal([&] { return read_model(folder); }), HasSubstr("surface.ply"));
}

TEST(ModelIo, WritesTheNameOfAFileThatIsNotUtf8) {
  const ScratchFolder scratch;
  Model model = some_model();
  model.made["acquisition"] = "messung_\xE9.db";
  write_model(scratch / "model", model);
  EXPECT_EQ(read_model(scratch / "model").made.at("acquisition"), "messung_\xEF\xBF\xBD.db");
}

TEST(ModelIo, KeepsWhatIsThereIfTheModelIsWrongOrTheFolderIsAnother) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "model";
  write_model(folder, some_model());
  Model wrong = some_model();
  wrong.contacts[0].friction = -1;
  EXPECT_THROW(write_model(folder, wrong), InvalidInput);
  expect_same(read_model(folder), some_model());
  const std::filesystem::path other = scratch / "other";
  std::filesystem::create_directories(other);
  write_text(other / "letter.txt", "dear");
  EXPECT_THROW(write_model(other, some_model()), InvalidInput);
  EXPECT_EQ(read_text(other / "letter.txt"), "dear");
}

}  // namespace
}  // namespace palpate::haptics
