// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "c_calls.h"
#include "palpate/core/field_text.h"
#include "palpate/haptics/deformed_shape.h"
#include "palpate/haptics/playback.h"

namespace palpate::c {

/// The object behind a `palpate_player`.
struct Player {
  std::shared_ptr<const haptics::Model> model;
  std::shared_ptr<const haptics::BlendedField> field;
  haptics::Playback playback;
  geometry::GeodesicSurface surface;
  haptics::LoopState state;
};

static Player* behind(palpate_player* handle) noexcept { return reinterpret_cast<Player*>(handle); }

}  // namespace palpate::c

using palpate::c::behind;
using palpate::c::fail;
using palpate::c::guarded;
using palpate::haptics::ContactState;

static_assert(static_cast<int>(ContactState::free) == PALPATE_FREE);
static_assert(static_cast<int>(palpate::haptics::ShapeRule::blended) == PALPATE_SHAPE_BLENDED);
static_assert(static_cast<int>(palpate::haptics::ShapeRule::nearest) == PALPATE_SHAPE_NEAREST);
static_assert(static_cast<int>(ContactState::stick) == PALPATE_STICK);
static_assert(static_cast<int>(ContactState::slip) == PALPATE_SLIP);

palpate_status palpate_player_create(const palpate_model* model, const char* options,
                                     palpate_player** player) {
  if (model == nullptr || player == nullptr) {
    return fail(PALPATE_INVALID, "palpate_player_create: model or player is null");
  }
  return guarded([&] {
    palpate::haptics::PlaybackOptions playback;
    if (options != nullptr) palpate::assign_words(palpate::fields_of(playback), options);
    const std::shared_ptr<const palpate::haptics::Model>& shared = behind(model)->model;
    *player = reinterpret_cast<palpate_player*>(
        new palpate::c::Player{shared,
                               behind(model)->field,
                               palpate::haptics::Playback(*shared, playback),
                               shared->surface,
                               {}});
  });
}

void palpate_player_destroy(palpate_player* player) { delete behind(player); }

palpate_status palpate_player_step(palpate_player* player, const double tool[3], double seconds,
                                   palpate_tick* tick) {
  if (player == nullptr || tool == nullptr || tick == nullptr) {
    return fail(PALPATE_INVALID, "palpate_player_step: player, tool or tick is null");
  }
  if (!(seconds > 0 && std::isfinite(seconds))) {
    return fail(PALPATE_INVALID, "palpate_player_step: seconds must be > 0 and finite");
  }
  const palpate::haptics::Command command =
      behind(player)->playback.step(Eigen::Vector3d::Map(tool), behind(player)->state, seconds);
  palpate_tick all{};
  all.state = static_cast<int32_t>(command.state);
  Eigen::Vector3d::Map(all.force) = command.force;
  Eigen::Vector3d::Map(all.contact) = command.contact;
  palpate::c::give(all, *tick);
  return PALPATE_OK;
}

palpate_status palpate_player_reset(palpate_player* player) {
  if (player == nullptr) return fail(PALPATE_INVALID, "palpate_player_reset: player is null");
  behind(player)->state = {};
  return PALPATE_OK;
}

palpate_status palpate_player_shape(const palpate_player* player, int32_t rule, float* xyz,
                                    uint64_t count) {
  if (player == nullptr || xyz == nullptr) {
    return fail(PALPATE_INVALID, "palpate_player_shape: player or xyz is null");
  }
  if (rule != PALPATE_SHAPE_BLENDED && rule != PALPATE_SHAPE_NEAREST) {
    return fail(
        PALPATE_INVALID,
        "palpate_player_shape: rule must be PALPATE_SHAPE_BLENDED or PALPATE_SHAPE_NEAREST");
  }
  return guarded([&] {
    const auto& played = *reinterpret_cast<const palpate::c::Player*>(player);
    palpate::c::copy_floats(palpate::haptics::displayed_shape(
                                *played.model, *played.field, played.surface, played.state,
                                static_cast<palpate::haptics::ShapeRule>(rule)),
                            xyz, count, "palpate_player_shape");
  });
}
