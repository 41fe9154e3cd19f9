// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/export_page.h"

#include <algorithm>
#include <ostream>
#include <utility>
#include <vector>

#include "export/mesh_page.h"
#include "export/page_file.h"
#include "export/range_page.h"
#include "maker/model_page.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/model_io.h"
#include "shared/played_model.h"

namespace palpate::apps {
namespace {

/// An option, whether it was given, and the exports that it applies to.
struct PageOption {
  const char* name;
  bool given;
  std::vector<PageContent> contents;
  bool of_surfaces = false;   ///< also of an export without a page
  bool of_sequences = false;  ///< also of an export of a folder without a page
};

std::vector<PageOption> options_of(const PageCall& call) {
  using enum PageContent;
  return {{"--title", !call.title.empty(), {model, range_maps, meshes}},
          {"--unknown-friction", call.unknown_friction.has_value(), {model}},
          {"--rig", !call.camera.rig.empty(), {range_maps}, true, true},
          {"--scale", call.camera.scale.has_value(), {range_maps}, true, true},
          {"--intrinsics", !call.camera.intrinsics.empty(), {range_maps}, true, true},
          {"--every", call.every.has_value(), {range_maps, meshes}, false, true},
          {"--unit", call.meshes.unit.has_value(), {meshes}, true, true}};
}

const char* plural_of(PageContent content) {
  switch (content) {
    case PageContent::model:
      return "models";
    case PageContent::range_maps:
      return "range maps";
    case PageContent::meshes:
      break;
  }
  return "meshes";
}

void check_content(const PageCall& call, const PageOption& option, PageContent content) {
  if (std::ranges::find(option.contents, content) != option.contents.end()) return;
  std::string kinds;
  for (const PageContent kind : option.contents)
    kinds += (kinds.empty() ? "" : " and ") + std::string(plural_of(kind));
  throw InvalidInput(std::string(option.name) + ": is for " + kinds + "; " + call.input.string() +
                     " is one of " + plural_of(content) + ".");
}

bool holds_range_maps(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (is_hidden(path) || is_sigma(path) || is_reasons(path)) continue;
    if (is_range_map(path) || (is_image(path) && is_depth_image(path))) return true;
  }
  return false;
}

std::string page_title(const PageCall& call) {
  if (!call.title.empty()) return call.title;
  const fs::path whole = fs::weakly_canonical(call.input);
  return whole.filename().empty() ? whole.parent_path().filename().string()
                                  : whole.filename().string();
}

void write_model_page(const PageCall& call, const fs::path& output) {
  haptics::Model model = haptics::read_model(call.input);
  const double friction = call.unknown_friction.value_or(0);
  check_friction(call.input, haptics::unknown_friction_count(model), friction);
  const std::string page =
      web::model_page(std::move(model), {.title = page_title(call), .unknown_friction = friction},
                      page_template_path("model"));
  write_file(output, [&](std::ostream& file) { file << page; });
}

/// The frames that --every takes, the first one among them.
std::vector<fs::path> each_nth(const std::vector<fs::path>& files, int every) {
  std::vector<fs::path> taken;
  for (std::size_t i = 0; i < files.size(); i += static_cast<std::size_t>(every))
    taken.push_back(files[i]);
  return taken;
}

}  // namespace

void check_page_options(const PageCall& call, PageContent content, bool is_page, bool is_sequence) {
  for (const PageOption& option : options_of(call)) {
    if (!option.given) continue;
    if (!is_page && !(is_sequence ? option.of_sequences : option.of_surfaces)) {
      throw InvalidInput(
          std::string(option.name) + ": is that of a page (--html)" +
          (option.of_sequences
               ? ", or of a folder of meshes as --glb, or of range maps as --png or --npy"
               : ""));
    }
    check_content(call, option, content);
  }
}

std::vector<fs::path> frames_of(const PageCall& call, PageContent content) {
  const bool folder = is_folder(call.input);
  if (call.every && !folder) {
    throw InvalidInput("--every: is for a folder, whose files are a sequence; " +
                       call.input.string() + " is one file.");
  }
  const std::vector<fs::path> files = content == PageContent::range_maps
                                          ? list_range_maps({call.input}, call.camera)
                                      : folder ? list_meshes(call.input)
                                               : std::vector<fs::path>{call.input};
  return each_nth(files, call.every.value_or(1));
}

PageContent content_of(const fs::path& path) {
  if (!is_folder(path)) return is_image(path) ? PageContent::range_maps : PageContent::meshes;
  if (is_there(path / "field.json") || is_there(path / "field.cbor")) return PageContent::model;
  if (holds_range_maps(path)) return PageContent::range_maps;
  if (!list_meshes(path).empty()) return PageContent::meshes;
  throw FileError(
      path.string() + (fs::is_empty(path) ? ": is empty" : ": holds nothing that can be exported") +
      "; expected a model (field.json or field.cbor, and surface.ply), range maps (tiff), as "
      "palpate decode writes them, or depth images (16-bit PNG), or meshes, as palpate track "
      "writes them.");
}

fs::path usual_name(PageContent content) {
  switch (content) {
    case PageContent::model:
      return "model";
    case PageContent::range_maps:
      return "range";
    case PageContent::meshes:
      break;
  }
  return "mesh";
}

std::string export_page(const PageCall& call, PageContent content, const fs::path& output) {
  if (content == PageContent::model) {
    write_model_page(call, output);
    return {};
  }
  const std::vector<fs::path> files = frames_of(call, content);
  if (content == PageContent::meshes)
    return write_mesh_page(output, files, call.meshes, page_title(call));
  check_camera_options(files.front(), call.camera);
  return write_range_page(output, files, call.camera, page_title(call));
}

}  // namespace palpate::apps
