// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/playback.h"
#include "path_kind.h"
#include "shared/map_camera.h"
#include "view.h"

namespace palpate::view {

/// The layer of a map that the range view shows.
enum class MapLayer { depth, deviation, reason, difference };

/// The call of palpate-view.
struct ViewCall {
  std::filesystem::path path;
  // Of a model.
  std::filesystem::path trajectory, session, replay;
  haptics::PlaybackOptions playback;
  // Of range maps.
  std::filesystem::path compare;
  apps::MapCamera camera;
  MapLayer layer = MapLayer::depth;
  bool as_surface = false;
  // Of an acquisition.
  std::filesystem::path surface, model;
  // Of a mesh.
  geometry::ReadOptions mesh;
  // Pictures.
  std::filesystem::path screenshot, movie;
  std::optional<double> seconds;
  int width = 1280, height = 800;  ///< [px]

  /// Returns true if only pictures are wanted, and no window.
  [[nodiscard]] bool is_still() const { return !screenshot.empty() || !movie.empty(); }
};

/// Adds the options to the command line.
void add_options(CLI::App& app, ViewCall& call);

/// Checks what can be checked without reading a file.
/// \throws InvalidInput naming an option that means nothing for what is shown, or by itself, and
/// OutputError if an output cannot be written.
void check_call(const ViewCall& call, PathKind kind, const CLI::App& app);

/// Reads and checks all data to show. The returned function makes the view, if there is a window.
/// \throws FileError, InvalidInput as the readers do.
[[nodiscard]] std::function<std::unique_ptr<View>()> load_view(const ViewCall& call, PathKind kind);

}  // namespace palpate::view
