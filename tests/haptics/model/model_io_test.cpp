// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/contact_strength.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "following_surface.h"
#include "model_testing.h"
#include "not_finite.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::haptics {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

// The message of reading after surface.ply was changed as a mesh file.
template <typename Change>
std::string refused_surface(Change&& change) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "model";
  write_model(folder, some_model());
  geometry::MeshFile file = geometry::read_mesh_file(folder / "surface.ply");
  change(file);
  geometry::write_mesh_file(folder / "surface.ply", file);
  return refusal([&] { return read_model(folder); });
}

TEST(ModelIo, ReadsBackExactlyWhatWasWritten) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "new" / "model";
  write_model(folder, some_model());
  write_model(folder, some_model());
  expect_same(read_model(folder), some_model());
}

// Files change compliances, whoever learnt them: reading learns nothing again.
TEST(ModelIo, ReadsTheCompliancesThatWereWritten) {
  Model model = some_model();
  ASSERT_TRUE(model.contacts[0].compliance);
  model.contacts[0].compliance->values(2) *= 1.25;
  model.contacts[0].compliance->trend(2, 1) = 0.0123;
  model.interpolation.reach = 7;
  const ScratchFolder scratch;
  write_model(scratch / "model", model);
  expect_same(read_model(scratch / "model"), model);
}

TEST(ModelIo, KnowsTheSizeOfAFolderBeforeItIsWritten) {
  FollowingSheet sheet;
  sheet.model.response = sheet.fit();
  for (const Model& model : {some_model(), sheet.model}) {
    const ScratchFolder scratch;
    write_model(scratch / "model", model);
    double written = 0;
    for (const auto& file : fs::recursive_directory_iterator(scratch / "model"))
      if (file.is_regular_file()) written += static_cast<double>(file.file_size());
    EXPECT_LE(written, folder_size(model));
    EXPECT_GE(written, folder_size(model) - 1000);
  }
}

TEST(ModelIo, ReadsTheStrengthsThatWereWritten) {
  Model model = with_strengths(some_model(), 1.7);
  ASSERT_TRUE(model.contacts[0].strength);
  model.contacts[0].strength->value *= 1.25;
  model.contacts[0].strength->trend(1) = 0.0123;
  model.interpolation.reach = 7;
  const ScratchFolder scratch;
  write_model(scratch / "model", model);
  expect_same(read_model(scratch / "model"), model);
}

// As in files that were written before it was a member.
TEST(ModelIo, LeavesOutTheRadiusOfTheProbeIfItIsNotKnown) {
  const ScratchFolder scratch;
  Model model = some_model();
  model.probe_radius.reset();
  write_model(scratch / "model", model);
  EXPECT_EQ(read_text(scratch / "model" / "field.json").find("probe_radius"), std::string::npos);
  expect_same(read_model(scratch / "model"), model);
  for (const double wrong : {0.0, -1.0, kNaN, kInf}) {
    model.probe_radius = wrong;
    EXPECT_THAT(refusal([&] { write_model(scratch / "model", model); }),
                HasSubstr("Model::probe_radius"));
  }
}

TEST(ModelIo, WritesTheWeightsThatTrianglesGiveWhereAModelHasNone) {
  Model model = some_model();
  model.surface_weights = {};
  const ScratchFolder scratch;
  write_model(scratch / "model", model);
  model.surface_weights = geometry::project_weights(model.surface, contact_mesh(model));
  expect_same(read_model(scratch / "model"), model);
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
  const fs::path folder = scratch / "model";
  write_model(folder, some_model());
  write_model(folder, some_model(), ModelEncoding::cbor);
  EXPECT_FALSE(fs::exists(folder / "field.json"));
  expect_same(read_model(folder), some_model());
  const std::string cbor = read_text(folder / "field.cbor");
  write_text(folder / "field.cbor", cbor.substr(0, cbor.size() / 2));
  EXPECT_THAT(refusal([&] { return read_model(folder); }),
              AllOf(HasSubstr("field.cbor"), HasSubstr("CBOR")));
}

TEST(ModelIo, WritesModelsOfManyContactsInCbor) {
  Model model = sheet_model();
  while (model.contacts.size() <= kMaxJsonContacts) {
    model.contacts.push_back(model.contacts.front());
    model.contacts.back().id = static_cast<long long>(model.contacts.size() + 100);
  }
  const ScratchFolder scratch;
  write_model(scratch / "many", model);
  EXPECT_TRUE(fs::exists(scratch / "many" / "field.cbor"));
  model.contacts.pop_back();
  write_model(scratch / "some", model);
  EXPECT_TRUE(fs::exists(scratch / "some" / "field.json"));
}

TEST(ModelIo, RefusesASurfaceThatIsNotTheModels) {
  EXPECT_THAT(refused_surface([](geometry::MeshFile& file) { file.vertex_attributes.pop_back(); }),
              AllOf(HasSubstr("surface.ply"), HasSubstr("no property weight_2")));
  const auto set = [](geometry::MeshFile& file, std::size_t attribute, double value) {
    std::visit(
        [&](auto& values) { values[7] = static_cast<std::decay_t<decltype(values[7])>>(value); },
        file.vertex_attributes[attribute].values);
  };
  EXPECT_THAT(
      refused_surface([&](auto& file) { set(file, 1, 4); }),
      AllOf(HasSubstr("surface.ply"), HasSubstr("contact_1 of vertex 7 is 4"), HasSubstr("to 3")));
  EXPECT_THAT(refused_surface([&](auto& file) { set(file, 0, -2); }), HasSubstr("vertex 7"));
  EXPECT_THAT(refused_surface([&](auto& file) { set(file, 3, 7); }),
              AllOf(HasSubstr("vertex 7"), HasSubstr("sum to 1")));
  EXPECT_THAT(refused_surface([&](auto& file) { set(file, 4, std::nan("")); }),
              HasSubstr("vertex 7"));
}

TEST(ModelIo, RefusesMissingAndTruncatedFiles) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "model";
  EXPECT_THAT(refusal([&] { return read_model(folder); }), HasSubstr("no such folder"));
  fs::create_directories(folder);
  EXPECT_THAT(refusal([&] { return read_model(folder); }),
              HasSubstr("neither field.json nor field.cbor"));
  write_model(folder, some_model());
  for (const char* name : {"field.json", "surface.ply"}) {
    const std::string whole = read_text(folder / name);
    for (std::size_t length = 0; length + 2 < whole.size(); length += whole.size() / 60) {
      write_text(folder / name, whole.substr(0, length));
      EXPECT_THAT(refusal([&] { return read_model(folder); }), HasSubstr(name)) << length;
    }
    write_text(folder / name, whole);
  }
  fs::remove(folder / "surface.ply");
  EXPECT_THAT(refusal([&] { return read_model(folder); }), HasSubstr("surface.ply"));
}

TEST(ModelIo, KeepsWhatIsThereIfTheModelIsWrongOrTheFolderIsAnother) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "model";
  write_model(folder, some_model());
  Model wrong = some_model();
  wrong.contacts[0].friction = -1;
  EXPECT_THROW(write_model(folder, wrong), InvalidInput);
  EXPECT_THROW(write_field_document(folder / "field.json", wrong, ModelEncoding::json),
               InvalidInput);
  expect_same(read_model(folder), some_model());
  const fs::path other = scratch / "other";
  fs::create_directories(other);
  write_text(other / "letter.txt", "dear");
  EXPECT_THROW(write_model(other, some_model()), InvalidInput);
  EXPECT_EQ(read_text(other / "letter.txt"), "dear");
}

}  // namespace
}  // namespace palpate::haptics
