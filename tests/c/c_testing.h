// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "../haptics/sheet_model.h"
#include "palpate.h"
#include "palpate/haptics/model_bytes.h"

namespace palpate::c {

struct Close {
  void operator()(palpate_model* model) const { palpate_model_close(model); }
  void operator()(palpate_player* player) const { palpate_player_destroy(player); }
};
using OwnedModel = std::unique_ptr<palpate_model, Close>;
using OwnedPlayer = std::unique_ptr<palpate_player, Close>;

inline OwnedModel opened(const haptics::Model& model = haptics::sheet_model()) {
  const std::vector<std::byte> bytes = haptics::to_bytes(model);
  palpate_model* handle = nullptr;
  EXPECT_EQ(palpate_model_open_bytes(bytes.data(), bytes.size(), &handle), PALPATE_OK)
      << palpate_error_text();
  return OwnedModel(handle);
}

inline OwnedPlayer player_of(const OwnedModel& model) {
  palpate_player* handle = nullptr;
  EXPECT_EQ(palpate_player_create(model.get(), nullptr, &handle), PALPATE_OK);
  return OwnedPlayer(handle);
}

}  // namespace palpate::c
