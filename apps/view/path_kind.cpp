// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "path_kind.h"

#include <algorithm>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "shared/inputs.h"

namespace palpate::view {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExpected =
    "expected a model (a folder with surface.ply and field.json), a folder of range maps (tiff) or "
    "one of them, a mesh (ply, obj, stl, ...), or an acquisition (.db).";

PathKind kind_of_folder(const fs::path& folder) {
  for (const char* name : {"field.json", "field.cbor", "surface.ply"}) {
    if (apps::is_there(folder / name)) return PathKind::model;
  }
  bool any = false;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_hidden(entry.path())) continue;
    any = true;
    if (apps::is_image(entry.path())) return PathKind::range_maps;
  }
  throw FileError(
      folder.string() +
      (any ? ": is a folder without a model or range maps in it; " : ": is an empty folder; ") +
      kExpected);
}

}  // namespace

PathKind kind_of(const fs::path& path) {
  if (apps::is_folder(path)) return kind_of_folder(path);
  const std::string ending = lower_extension(path);
  if (ending == ".db" || ending == ".sqlite") return PathKind::acquisition;
  if (apps::is_image(path)) return PathKind::range_maps;
  for (const char* other :
       {".json", ".cbor", ".csv", ".yaml", ".yml", ".txt", ".html", ".mkv", ".mp4", ".avi"}) {
    if (ending == other)
      throw FileError(path.string() + ": is of no kind that can be shown; " + kExpected);
  }
  return PathKind::mesh;  // its reader knows many endings, and says if it does not know this one
}

}  // namespace palpate::view
