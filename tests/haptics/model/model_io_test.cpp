// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model_testing.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/blended_field.h"
#include "repository.h"

namespace palpate::haptics {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// What reading says after surface.ply was changed as a mesh file.
template <typename Change>
std::string refused_after(Change&& change) {
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
  Model without_weights = some_model();
  without_weights.surface_weights = {};
  write_model(folder, without_weights);
  expect_same(read_model(folder), without_weights);
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

// tests/haptics/data/model_version_1 is what the program wrote when that was its version. The
// forces are those of its library: of each contact, then of a place between them.
TEST(ModelIo, ReadsModelsOfVersionOne) {
  const Model model = read_model(repository("tests/haptics/data/model_version_1"));
  const Eigen::Vector3d displacement(1.2, -0.7, 2.5);
  const std::vector<Eigen::Vector3d> forces = {
      {0.93944743622866256, -0.43354288452877721, 1.3085253038641562},
      {1.2709855597664792, -0.56782841906194648, 1.7382043598315713},
      {0, 0, 0},
      {2.8735587533433109, -0.83385955412210488, 2.6258404718766597}};
  ASSERT_EQ(model.contacts.size(), forces.size());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const ContactModel& contact = model.contacts[i];
    EXPECT_EQ(contact.id, 10 + static_cast<long long>(i));
    const Eigen::Vector3d found =
        contact.frame * force(contact.field, contact.frame.transpose() * displacement);
    EXPECT_LE((found - forces[i]).norm(), 1e-14 * forces[i].norm());
  }
  EXPECT_EQ(model.contacts[1].friction_source, FrictionSource::other_contacts);
  EXPECT_EQ(model.contacts[3].field.bases[2].epsilon, 0.7);
  EXPECT_EQ(model.surface_weights.contacts.cols(), 9);
  const Eigen::Vector3d place = some_motion() * Eigen::Vector3d(7, -13, 700);
  const Eigen::Vector3d between(0.85100264517017787, -0.37683577077008529, 1.1589409701193616);
  EXPECT_LE((BlendedField(model).force(place, displacement) - between).norm(), 1e-13);
  const ScratchFolder scratch;
  write_model(scratch / "model", model);
  const Model again = read_model(scratch / "model");
  for (std::size_t i = 0; i < forces.size(); ++i) {
    EXPECT_EQ(again.contacts[i].field, model.contacts[i].field);
    EXPECT_EQ(again.contacts[i].position, model.contacts[i].position);
    EXPECT_LE((again.contacts[i].frame - model.contacts[i].frame).norm(), 1e-14);
  }
}

// tests/haptics/data/model_version_2 has the contacts of the other with further bases. The forces
// are those of the Python code that described version 2.
TEST(ModelIo, ReadsModelsOfVersionTwo) {
  const Model model = read_model(repository("tests/haptics/data/model_version_2"));
  const Eigen::Vector3d displacement(1.2, -0.7, 2.5);
  const std::vector<Eigen::Vector3d> forces = {
      {-0.055086032836453899, -0.14121257365024872, 2.5191756165572503},
      {-0.070550072546649106, -0.26700195327056747, 2.8380244598286044},
      {0, 0, 0},
      {1.3241954554656659, -0.56737517638176449, 2.7190371160286344}};
  ASSERT_EQ(model.contacts.size(), forces.size());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const ContactModel& contact = model.contacts[i];
    const Eigen::Vector3d found =
        contact.frame * force(contact.field, contact.frame.transpose() * displacement);
    // A ridge's seven decimal places are not quite a unit vector.
    EXPECT_LE((found - forces[i]).norm(), 2 * kRidgeTolerance * weight_sum(contact.field));
    EXPECT_NEAR(contact.friction_error, 0.0023 * static_cast<double>(i + 1), 1e-15);
    EXPECT_EQ(contact.passivity, i == 1 ? "undecided" : "convex");
    EXPECT_EQ(contact.fit_mode, "convex");
  }
  const ScratchFolder scratch;
  write_model(scratch / "model", model);
  const Model again = read_model(scratch / "model");
  for (std::size_t i = 0; i < forces.size(); ++i) {
    EXPECT_LE((force(again.contacts[i].field, displacement) -
               force(model.contacts[i].field, displacement))
                  .norm(),
              2 * kRidgeTolerance * weight_sum(model.contacts[i].field));
  }
}

TEST(ModelIo, RefusesASurfaceThatIsNotTheModels) {
  EXPECT_THAT(refused_after([](geometry::MeshFile& file) { file.vertex_attributes.pop_back(); }),
              AllOf(HasSubstr("surface.ply"), HasSubstr("no property weight_2")));
  const auto set = [](geometry::MeshFile& file, std::size_t attribute, double value) {
    std::visit(
        [&](auto& values) { values[7] = static_cast<std::decay_t<decltype(values[7])>>(value); },
        file.vertex_attributes[attribute].values);
  };
  EXPECT_THAT(
      refused_after([&](auto& file) { set(file, 1, 4); }),
      AllOf(HasSubstr("surface.ply"), HasSubstr("contact_1 of vertex 7 is 4"), HasSubstr("to 3")));
  EXPECT_THAT(refused_after([&](auto& file) { set(file, 0, -2); }), HasSubstr("vertex 7"));
  EXPECT_THAT(refused_after([&](auto& file) { set(file, 3, 7); }),
              AllOf(HasSubstr("vertex 7"), HasSubstr("sum to 1")));
  EXPECT_THAT(refused_after([&](auto& file) { set(file, 4, std::nan("")); }),
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
