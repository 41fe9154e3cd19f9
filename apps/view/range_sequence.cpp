// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "range_sequence.h"

#include <fmt/format.h>

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/sensing/reason_image.h"

namespace palpate::view {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSpanMaps = 5;  // that tell what the colours span

/// The depths of a map, without its camera.
geometry::ImageF depths_of(const fs::path& path, const apps::MapCamera& camera) {
  return apps::is_range_map(path) ? geometry::read_depth_tiff(path)
                                  : apps::load_range_map(path, camera).z;
}

}  // namespace

RangeSequence::RangeSequence(const fs::path& path, const fs::path& compare,
                             const apps::MapCamera& camera)
    : maps_(apps::list_range_maps({path}, camera)), camera_(camera) {
  if (!compare.empty()) others_ = apps::list_range_maps({compare}, camera);
  if (others_.size() > 1 && others_.size() != maps_.size()) {
    throw InvalidInput(fmt::format(
        "--compare: {} has {} range maps, {} has {}; it must have as many, or one for all.",
        compare.string(), others_.size(), path.string(), maps_.size()));
  }
}

std::string RangeSequence::name(std::size_t frame) const {
  return maps_[frame].filename().string();
}

fs::path RangeSequence::beside(std::size_t frame, const char* ending) const {
  return maps_[frame].parent_path() / (maps_[frame].stem().string() + ending);
}

bool RangeSequence::has(MapLayer layer) const {
  switch (layer) {
    case MapLayer::depth:
      return true;
    case MapLayer::deviation:
      return apps::is_there(beside(0, "_sigma.tiff"));
    case MapLayer::reason:
      return apps::is_there(beside(0, "_reasons.tiff"));
    case MapLayer::difference:
      break;
  }
  return is_compared();
}

RangeFrame RangeSequence::read(std::size_t frame, MapLayer layer) const {
  RangeFrame read{.map = apps::load_range_map(maps_[frame], camera_),
                  .deviation = {},
                  .reasons = {},
                  .score = {}};
  const auto check_size = [&](const fs::path& path, Eigen::Index rows, Eigen::Index cols) {
    if (rows == read.map.z.rows() && cols == read.map.z.cols()) return;
    throw InvalidInput(fmt::format("{}: has {} x {} pixels; {} has {} x {}, and so must it.",
                                   path.string(), cols, rows, maps_[frame].string(),
                                   read.map.z.cols(), read.map.z.rows()));
  };
  if (layer == MapLayer::deviation) {
    const fs::path path = beside(frame, "_sigma.tiff");
    read.deviation = geometry::read_depth_tiff(path);
    check_size(path, read.deviation.rows(), read.deviation.cols());
  } else if (layer == MapLayer::reason) {
    const fs::path path = beside(frame, "_reasons.tiff");
    read.reasons = sensing::read_reasons(path);
    check_size(path, read.reasons.rows(), read.reasons.cols());
  } else if (layer == MapLayer::difference) {
    const fs::path& path = others_.size() == 1 ? others_.front() : others_[frame];
    const geometry::ImageF truth = depths_of(path, camera_);
    check_size(path, truth.rows(), truth.cols());
    read.score = geometry::score_range_map(read.map.z, truth);
  }
  return read;
}

ColorSpan RangeSequence::span(MapLayer layer) const {
  std::vector<double> values;
  const std::size_t count = std::min(kSpanMaps, maps_.size());
  for (std::size_t i = 0; i < count; ++i) {
    const RangeFrame frame = read((2 * i + 1) * maps_.size() / (2 * count), layer);
    const std::vector<double> known =
        known_values(layer == MapLayer::deviation    ? frame.deviation
                     : layer == MapLayer::difference ? frame.score->difference
                                                     : frame.map.z);
    values.insert(values.end(), known.begin(), known.end());
  }
  if (layer == MapLayer::deviation) return span_of_deviations(std::move(values));
  if (layer == MapLayer::difference) return span_of_differences(std::move(values));
  return span_of_depths(values);
}

ColorImage color_frame(const RangeFrame& frame, MapLayer layer, const ColorSpan& span) {
  switch (layer) {
    case MapLayer::depth:
      break;
    case MapLayer::deviation:
      return color_image(frame.deviation, span);
    case MapLayer::reason:
      return color_image(frame.reasons);
    case MapLayer::difference:
      return color_image(frame.score->difference, span, frame.score->wrong_pixels);
  }
  return color_image(frame.map.z, span);
}

}  // namespace palpate::view
