// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/pictures/draw_deviation.h"
#include "palpate/pictures/draw_labels.h"
#include "palpate/pictures/draw_range_map.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/reason_image.h"
#include "shared/inputs.h"
#include "shared/surface_colors.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigits = 6;

bool is_ending(std::string_view rest) {
  for (const char* ending :
       {".tiff", ".png", ".ply", ".obj", ".stl", ".pcd", "_sigma.tiff", "_sigma.png", "_noise.tiff",
        "_reasons.tiff", "_reasons.png", "_color.png"}) {
    if (rest == ending) return true;
  }
  return false;
}

/// One point per pixel, as programs for depth cameras expect it, in their precision.
void write_points(const fs::path& file, const geometry::RangeMap& range, const cv::Mat& color) {
  if (!(range.z > 0).any()) return;
  geometry::write_point_cloud(file, organised_cloud(range, color), {.single_precision = true});
}

void write_surface(const fs::path& file, const geometry::RangeMap& range, const cv::Mat& color) {
  geometry::MeshFile surface;
  surface.mesh = geometry::mesh_range_map(range).mesh;
  if (surface.mesh.triangles.cols() == 0) return;
  if (!color.empty())
    surface.vertex_attributes = colors_of(surface.mesh.vertices, range.camera, color);
  geometry::write_mesh_file(file, surface);
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
                   const sensing::DecodeResult& result, const cv::Mat& color) {
  const auto file = [&](const std::string& ending) {
    return numbered(outputs.folder, number, ending);
  };
  if (outputs.sigma) geometry::write_depth_tiff(file("_sigma.tiff"), result.sigma);
  if (outputs.noise) geometry::write_depth_tiff(file("_noise.tiff"), result.noise);
  if (outputs.reasons) sensing::write_reasons(file("_reasons.tiff"), result.reasons);
  if (outputs.color) sensing::write_png(file("_color.png"), color);
  if (outputs.meshes == "pcd") {
    write_points(file(".pcd"), result.range, color);
  } else if (!outputs.meshes.empty()) {
    write_surface(file("." + outputs.meshes), result.range, color);
  }
  // Last: a program that waits for the range map then finds the other files.
  geometry::write_depth_tiff(file(".tiff"), result.range.z);
}

void draw_outputs(const DecodeOutputs& outputs, std::size_t number,
                  const sensing::DecodeResult& result, const std::string& title) {
  const auto file = [&](const std::string& ending) {
    return numbered(outputs.folder, number, ending);
  };
  if (!outputs.pictures) return;
  if (outputs.reasons)
    pictures::draw_labels(file("_reasons.png"), result.reasons, reason_words(), title);
  if (!(result.range.z > 0).any()) return;
  pictures::draw_range_map(file(".png"), result.range, title);
  if (outputs.sigma) pictures::draw_deviation(file("_sigma.png"), result.sigma, title);
}

OutputEndings output_endings(const DecodeOutputs& outputs, bool has_surface) {
  OutputEndings endings{.data = {".tiff"}, .pictures = {}};
  if (outputs.color) endings.data.emplace_back("_color.png");
  if (outputs.sigma) endings.data.emplace_back("_sigma.tiff");
  if (outputs.noise) endings.data.emplace_back("_noise.tiff");
  if (outputs.reasons) endings.data.emplace_back("_reasons.tiff");
  if (!outputs.meshes.empty() && has_surface) endings.data.push_back("." + outputs.meshes);
  if (!outputs.pictures) return endings;
  if (has_surface) endings.pictures.emplace_back(".png");
  if (has_surface && outputs.sigma) endings.pictures.emplace_back("_sigma.png");
  if (outputs.reasons) endings.pictures.emplace_back("_reasons.png");
  return endings;
}

bool has_outputs(const DecodeOutputs& outputs, std::size_t number, bool has_surface) {
  const OutputEndings endings = output_endings(outputs, has_surface);
  const auto has = [&](const std::string& ending) {
    return is_there(numbered(outputs.folder, number, ending));
  };
  return std::ranges::all_of(endings.data, has) && std::ranges::all_of(endings.pictures, has);
}

}  // namespace palpate::apps
