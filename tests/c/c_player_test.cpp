// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../haptics/playback/allocation_counter.h"
#include "c_testing.h"
#include "palpate/haptics/playback.h"

namespace palpate::c {
namespace {

/// A tool that presses on the middle, slides and lifts.
Eigen::Vector3d tool_at(int tick) {
  return {0.02 * std::max(tick, 300) - 10, 3, 695 + 0.02 * std::min(tick, 1000 - tick)};
}

palpate_tick sized_tick() {
  palpate_tick tick{};
  tick.struct_size = sizeof(tick);
  return tick;
}

TEST(CPlayer, PlaysTheSameBitsAsPlayback) {
  const haptics::Model model = haptics::uneven_model();
  const haptics::Playback playback(model);
  haptics::LoopState state;
  const OwnedPlayer player = player_of(opened(model));  // the model is closed already
  palpate_tick tick = sized_tick();
  int seen[3] = {0, 0, 0};
  for (int i = 0; i < 1000; ++i) {
    const haptics::Command command = playback.step(tool_at(i), state);
    ASSERT_EQ(palpate_player_step(player.get(), tool_at(i).data(), 1e-3, &tick), PALPATE_OK);
    EXPECT_EQ(Eigen::Vector3d(tick.force), command.force);
    EXPECT_EQ(Eigen::Vector3d(tick.contact), command.contact);
    EXPECT_EQ(tick.state, static_cast<int>(command.state));
    ++seen[tick.state];
  }
  EXPECT_GT(seen[PALPATE_FREE], 10);
  EXPECT_GT(seen[PALPATE_STICK], 10);
  EXPECT_GT(seen[PALPATE_SLIP], 10);
}

TEST(CPlayer, DoesNotAllocateInAStep) {
  if (!test::counts_allocations()) GTEST_SKIP() << "the sanitizer's allocator cannot be counted";
  const OwnedPlayer player = player_of(opened(haptics::uneven_model()));
  palpate_tick tick = sized_tick();
  const Eigen::Vector3d nowhere(0, NAN, 0);
  int failed = 0;
  const long before = test::allocations();
  for (int i = 0; i < 1000; ++i) {
    failed += palpate_player_step(player.get(), tool_at(i).data(), 1e-3, &tick) != PALPATE_OK;
    failed += palpate_player_step(player.get(), nowhere.data(), 1e-3, &tick) != PALPATE_OK;
    failed += palpate_player_step(player.get(), nowhere.data(), 0, &tick) != PALPATE_INVALID;
  }
  failed += palpate_player_reset(player.get()) != PALPATE_OK;
  EXPECT_EQ(test::allocations(), before);
  EXPECT_EQ(failed, 0);
}

TEST(CPlayer, BeginsAgainAfterAReset) {
  const OwnedPlayer player = player_of(opened());
  palpate_tick tick = sized_tick();
  double last = 0;
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 500; ++i) {
      ASSERT_EQ(palpate_player_step(player.get(), tool_at(i).data(), 1e-3, &tick), PALPATE_OK);
    }
    if (round > 0) {
      EXPECT_EQ(tick.force[2], last);
    }
    last = tick.force[2];
    EXPECT_EQ(palpate_player_reset(player.get()), PALPATE_OK);
  }
  EXPECT_LT(last, -0.1);  // the outside is towards -z
}

TEST(CPlayer, TakesAFrictionForContactsWithoutOne) {
  haptics::Model model = haptics::sheet_model();
  for (haptics::ContactModel& contact : model.contacts) {
    contact.friction = 0;
    contact.friction_source = haptics::FrictionSource::none;
  }
  const OwnedModel handle = opened(model);
  double across[2] = {0, 0};
  for (const int rough : {0, 1}) {
    const char* options = rough == 1 ? "unknown_friction=1 tolerance=1e-3" : nullptr;
    palpate_player* created = nullptr;
    ASSERT_EQ(palpate_player_create(handle.get(), options, &created), PALPATE_OK);
    const OwnedPlayer player(created);
    palpate_tick tick = sized_tick();
    for (int i = 0; i < 500; ++i) {
      ASSERT_EQ(palpate_player_step(created, tool_at(i).data(), 1e-3, &tick), PALPATE_OK);
    }
    across[rough] = std::abs(tick.force[0]);
  }
  EXPECT_LT(across[0], 1e-3);
  EXPECT_GT(across[1], 0.05);
  palpate_player* none = nullptr;
  EXPECT_EQ(palpate_player_create(handle.get(), "unknown_friction=-1", &none), PALPATE_INVALID);
  EXPECT_NE(std::string(palpate_error_text()).find("friction"), std::string::npos);
  EXPECT_EQ(palpate_player_create(handle.get(), "frction=1", &none), PALPATE_INVALID);
  EXPECT_NE(std::string(palpate_error_text()).find("unknown_friction, tolerance"),
            std::string::npos);
}

TEST(CPlayer, DrawsADentUnderTheTool) {
  const haptics::Model model = haptics::sheet_model();
  const OwnedPlayer player = player_of(opened(model));
  Eigen::Matrix3Xf shape(3, 121);
  const auto count = static_cast<std::uint64_t>(shape.size());
  ASSERT_EQ(palpate_player_shape(player.get(), PALPATE_SHAPE_BLENDED, shape.data(), count),
            PALPATE_OK);
  EXPECT_EQ(shape, model.surface.vertices.cast<float>());
  palpate_tick tick = sized_tick();
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(palpate_player_step(player.get(), tool_at(i).data(), 1e-3, &tick), PALPATE_OK);
  }
  ASSERT_EQ(palpate_player_shape(player.get(), PALPATE_SHAPE_BLENDED, shape.data(), count),
            PALPATE_OK);
  const float deepest = (shape - model.surface.vertices.cast<float>()).row(2).maxCoeff();
  EXPECT_GT(deepest, 1);
  EXPECT_LT(deepest, 5.001F);  // as deep as the tool
  EXPECT_EQ(palpate_player_shape(player.get(), PALPATE_SHAPE_BLENDED, shape.data(), count - 1),
            PALPATE_INVALID);
  EXPECT_EQ(palpate_player_shape(player.get(), 7, shape.data(), count), PALPATE_INVALID);
  EXPECT_NE(std::string(palpate_error_text()).find("rule"), std::string::npos);
}

}  // namespace
}  // namespace palpate::c
