// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "felt_loop.h"
#include "palpate/haptics/device_run.h"

namespace palpate::view {

struct LiveLoopOptions {
  double diagonal = 1;                ///< [mm] of the object; > 0
  std::filesystem::path record = {};  ///< of the session; empty: none
  std::string session = {};           ///< text that a replay needs
};

/// The mouse at a model, in a thread of its own at 1 kHz.
class LiveLoop {
 public:
  /// \throws OutputError if the record cannot be written.
  LiveLoop(const std::shared_ptr<const haptics::Playback>& playback,
           const LiveLoopOptions& options);
  ~LiveLoop() = default;
  LiveLoop(const LiveLoop&) = delete;
  LiveLoop& operator=(const LiveLoop&) = delete;

  void set_wish(const ToolWish& wish) { wishes_.write(wish); }
  /// The next tick, in their order; none if all were taken.
  [[nodiscard]] std::optional<FeltTick> take() { return feed_.take(); }
  /// Ends the loop. \throws OutputError if the record is not complete.
  [[nodiscard]] haptics::RunReport finish();

 private:
  LatestValue<ToolWish> wishes_;
  TickFeed feed_;
  std::shared_ptr<FeltWorld> world_;
  MouseDevice device_;
  std::unique_ptr<haptics::DeviceRun> run_;
};

}  // namespace palpate::view
