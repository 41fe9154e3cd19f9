// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <thread>

#include "c_testing.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/model_io.h"
#include "scratch_folder.h"

namespace palpate::c {
namespace {

std::string error_text() { return palpate_error_text(); }

TEST(CModel, DescribesWhatItOpened) {
  const haptics::Model model = haptics::sheet_model();
  const OwnedModel handle = opened(model);
  palpate_model_facts facts{};
  facts.struct_size = sizeof(facts);
  ASSERT_EQ(palpate_model_describe(handle.get(), &facts), PALPATE_OK);
  EXPECT_EQ(facts.vertices, 121U);
  EXPECT_EQ(facts.triangles, 200U);
  EXPECT_EQ(facts.contacts, 4U);
  EXPECT_EQ(facts.unknown_friction, 0U);
  EXPECT_EQ(facts.lower[0], -50);
  EXPECT_EQ(facts.upper[2], 700);
  EXPECT_EQ(facts.probe_radius, model.probe_radius.value_or(0));
  std::vector<float> xyz(3 * facts.vertices);
  std::vector<std::int32_t> corners(3 * facts.triangles);
  ASSERT_EQ(palpate_model_vertices(handle.get(), xyz.data(), xyz.size()), PALPATE_OK);
  ASSERT_EQ(palpate_model_triangles(handle.get(), corners.data(), corners.size()), PALPATE_OK);
  EXPECT_EQ((Eigen::Map<Eigen::Matrix3Xf>(xyz.data(), 3, 121)),
            model.surface.vertices.cast<float>());
  EXPECT_EQ((Eigen::Map<Eigen::Matrix3Xi>(corners.data(), 3, 200)), model.surface.triangles);
}

TEST(CModel, WritesNothingBeyondTheCallersStruct) {
  const OwnedModel handle = opened();
  palpate_model_facts facts{};
  facts.struct_size = offsetof(palpate_model_facts, contacts);  // an older caller's
  facts.contacts = 12345;
  ASSERT_EQ(palpate_model_describe(handle.get(), &facts), PALPATE_OK);
  EXPECT_EQ(facts.vertices, 121U);
  EXPECT_EQ(facts.contacts, 12345U);
  EXPECT_EQ(facts.struct_size, offsetof(palpate_model_facts, contacts));
}

TEST(CModel, GivesTheForceOfTheField) {
  const haptics::Model model = haptics::uneven_model();
  const OwnedModel handle = opened(model);
  const haptics::BlendedField field(model);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d place(2.0 * i - 20, 10 - i, 700), moved(0.1 * i, -0.2, 0.3 * i);
    Eigen::Vector3d force;
    double deviation = 0;
    ASSERT_EQ(
        palpate_model_force(handle.get(), place.data(), moved.data(), force.data(), &deviation),
        PALPATE_OK);
    EXPECT_EQ(force, field.force(place, moved));
    const auto stated = field.deviation(place, moved);
    EXPECT_TRUE(stated ? deviation == *stated : std::isnan(deviation));
  }
}

TEST(CModel, OpensAFolderAndItsOwnBytes) {
  const ScratchFolder scratch;
  haptics::write_model(scratch / "m", haptics::sheet_model());
  palpate_model* model = nullptr;
  ASSERT_EQ(palpate_model_open((scratch / "m").c_str(), &model), PALPATE_OK);
  const OwnedModel owned(model);
  std::uint64_t size = 0;
  ASSERT_EQ(palpate_model_bytes(model, nullptr, &size), PALPATE_OK);
  std::vector<std::byte> bytes(size);
  std::uint64_t small = size - 1;
  EXPECT_EQ(palpate_model_bytes(model, bytes.data(), &small), PALPATE_INVALID);
  EXPECT_EQ(small, size);
  ASSERT_EQ(palpate_model_bytes(model, bytes.data(), &size), PALPATE_OK);
  palpate_model* again = nullptr;
  ASSERT_EQ(palpate_model_open_bytes(bytes.data(), size, &again), PALPATE_OK);
  palpate_model_close(again);
}

TEST(CModel, SaysWhatIsWrong) {
  palpate_model* none = nullptr;
  EXPECT_EQ(palpate_model_open("/no/such/folder", &none), PALPATE_FILE);
  EXPECT_NE(error_text().find("/no/such/folder: there is no such folder"), std::string::npos);
  EXPECT_EQ(palpate_model_open_bytes("0123456789", 10, &none), PALPATE_INVALID);
  EXPECT_NE(error_text().find("another version"), std::string::npos) << error_text();
  const std::vector<std::byte> bytes = haptics::to_bytes(haptics::sheet_model());
  EXPECT_EQ(palpate_model_open_bytes(bytes.data(), bytes.size() / 2, &none), PALPATE_INVALID);
  EXPECT_NE(error_text().find("truncated"), std::string::npos) << error_text();
  EXPECT_EQ(none, nullptr);
  EXPECT_EQ(palpate_model_open(nullptr, &none), PALPATE_INVALID);
  const OwnedModel handle = opened();
  std::vector<float> few(3);
  EXPECT_EQ(palpate_model_vertices(handle.get(), few.data(), few.size()), PALPATE_INVALID);
  EXPECT_NE(error_text().find("count is 3; there are 363"), std::string::npos) << error_text();
  const double place[3] = {0, NAN, 0};
  double force[3];
  EXPECT_EQ(palpate_model_force(handle.get(), place, place, force, nullptr), PALPATE_INVALID);
  std::string elsewhere = "?";
  std::thread([&] { elsewhere = palpate_error_text(); }).join();
  EXPECT_EQ(elsewhere, "") << "each thread has its own";
  palpate_model_close(nullptr);
}

}  // namespace
}  // namespace palpate::c
