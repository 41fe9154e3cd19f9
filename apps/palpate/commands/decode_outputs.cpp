// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/decode_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
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

bool is_ending(std::string_view rest) {
  for (const char* ending : {".tiff", ".png", ".ply", ".obj", ".stl", "_sigma.tiff", "_sigma.png",
                             "_noise.tiff", "_reasons.tiff", "_reasons.png"}) {
    if (rest == ending) return true;
  }
  return false;
}

}  // namespace

fs::path numbered(const fs::path& folder, std::size_t number, const std::string& ending) {
  return folder / fmt::format("{:0{}}{}", number, kDigits, ending);
}

bool is_numbered(const fs::path& name) {
  const std::string text = name.string();
  const auto digits = static_cast<std::size_t>(
      std::find_if(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) == 0; }) -
      text.begin());
  return digits >= kDigits && is_ending(std::string_view(text).substr(digits));
}

void write_outputs(const DecodeOutputs& outputs, std::size_t number,
                   const sensing::DecodeResult& result) {
  const auto file = [&](const std::string& ending) {
    return numbered(outputs.folder, number, ending);
  };
  if (outputs.sigma) geometry::write_depth_tiff(file("_sigma.tiff"), result.sigma);
  if (outputs.noise) geometry::write_depth_tiff(file("_noise.tiff"), result.noise);
  if (outputs.reasons) sensing::write_reasons(file("_reasons.tiff"), result.reasons);
  if (!outputs.meshes.empty()) {
    const geometry::RangeMapMesh surface = geometry::mesh_range_map(result.range);
    if (surface.mesh.triangles.cols() > 0)
      geometry::write_mesh(file("." + outputs.meshes), surface.mesh);
  }
  // Last: whoever waits for the range map finds the rest.
  geometry::write_depth_tiff(file(".tiff"), result.range.z);
}

void draw_outputs(const DecodeOutputs& outputs, std::size_t number,
                  const sensing::DecodeResult& result, const std::string& title) {
  const auto file = [&](const std::string& ending) {
    return numbered(outputs.folder, number, ending);
  };
  if (outputs.reasons)
    pictures::draw_labels(file("_reasons.png"), result.reasons, reason_words(), title);
  if (!(result.range.z > 0).any()) return;
  if (outputs.pictures) pictures::draw_range_map(file(".png"), result.range, title);
  if (outputs.sigma) pictures::draw_deviation(file("_sigma.png"), result.sigma, title);
}

bool has_outputs(const DecodeOutputs& outputs, std::size_t number, bool has_surface) {
  const auto has = [&](bool wanted, const std::string& ending) {
    return !wanted || is_there(numbered(outputs.folder, number, ending));
  };
  return has(true, ".tiff") && has(outputs.sigma, "_sigma.tiff") &&
         has(outputs.sigma && has_surface, "_sigma.png") && has(outputs.noise, "_noise.tiff") &&
         has(outputs.reasons, "_reasons.tiff") && has(outputs.reasons, "_reasons.png") &&
         has(outputs.pictures && has_surface, ".png") &&
         has(!outputs.meshes.empty() && has_surface, "." + outputs.meshes);
}

}  // namespace palpate::apps
