// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/decode_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <string_view>

#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/pictures/draw_deviation.h"
#include "palpate/pictures/draw_labels.h"
#include "palpate/pictures/draw_range_map.h"
#include "palpate/sensing/reason_image.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigits = 6;

bool ends_so(std::string_view rest) {
  for (const char* ending : {".tiff", ".png", ".ply", ".obj", ".stl", "_sigma.tiff", "_sigma.png",
                             "_reasons.tiff", "_reasons.png"}) {
    if (rest == ending) return true;
  }
  return false;
}

/// The name without the mark of a temporary: "000001.tmp-12-3.tiff" is for "000001.tiff".
std::string final_name(std::string name) {
  const std::size_t mark = name.find(".tmp-");
  if (mark != std::string::npos) name.erase(mark, name.find_last_of('.') - mark);
  return name;
}

}  // namespace

fs::path numbered(const fs::path& folder, std::size_t number, const std::string& ending) {
  return folder / fmt::format("{:0{}}{}", number, kDigits, ending);
}

bool is_numbered(const fs::path& name) {
  const std::string text = final_name(name.string());
  const auto digits = static_cast<std::size_t>(
      std::find_if(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) == 0; }) -
      text.begin());
  return digits >= kDigits && ends_so(std::string_view(text).substr(digits));
}

void write_outputs(const DecodeOutputs& outputs, std::size_t number,
                   const sensing::DecodeResult& result) {
  const auto file = [&](const std::string& ending) {
    return numbered(outputs.folder, number, ending);
  };
  if (outputs.sigma) geometry::write_depth_tiff(file("_sigma.tiff"), result.sigma);
  if (outputs.reasons) sensing::write_reasons(file("_reasons.tiff"), result.reasons);
  if (!outputs.meshes.empty()) {
    const geometry::RangeMapMesh surface = geometry::mesh_range_map(result.range);
    if (surface.mesh.triangles.cols() > 0)
      geometry::write_mesh(file("." + outputs.meshes), surface.mesh);
  }
  // Last: where there is a range map, the rest is there.
  geometry::write_depth_tiff(file(".tiff"), result.range.z);
}

bool has_outputs(const DecodeOutputs& outputs, std::size_t number, bool has_surface) {
  const auto lacks = [&](const std::string& ending) {
    return !is_there(numbered(outputs.folder, number, ending));
  };
  if (lacks(".tiff")) return false;
  if (outputs.sigma && lacks("_sigma.tiff")) return false;
  if (outputs.reasons && lacks("_reasons.tiff")) return false;
  return outputs.meshes.empty() || !has_surface || !lacks("." + outputs.meshes);
}

void draw_outputs(const DecodeOutputs& outputs, std::size_t number, const std::string& title,
                  bool missing_only) {
  const auto file = [&](const std::string& ending) {
    return numbered(outputs.folder, number, ending);
  };
  const auto draw = [&](bool wanted, const std::string& ending,
                        const std::function<void(const fs::path&)>& drawing) {
    if (wanted && !(missing_only && is_there(file(ending)))) drawing(file(ending));
  };
  draw(outputs.reasons, "_reasons.png", [&](const fs::path& png) {
    pictures::draw_labels(png, sensing::read_reasons(file("_reasons.tiff")), reason_words(), title);
  });
  const geometry::RangeMap map = load_range_map(file(".tiff"), outputs.folder / "rig.yaml");
  if (!(map.z > 0).any()) return;
  draw(outputs.pictures, ".png",
       [&](const fs::path& png) { pictures::draw_range_map(png, map, title); });
  draw(outputs.sigma, "_sigma.png", [&](const fs::path& png) {
    pictures::draw_deviation(png, geometry::read_depth_tiff(file("_sigma.tiff")), title);
  });
}

}  // namespace palpate::apps
