// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/range_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "export/page_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/packed_image.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/reason_image.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// Depths are rounded to a step that is at most this fraction of the smallest deviation, so that
/// rounding moves them by at most half of it: a twentieth.
constexpr double kStepOfSigma = 0.1;
/// The same without deviations: fraction of the smallest depth of the colour scale. At 700 mm it
/// gives 5 um; the best measured depths have errors of about 30 um.
constexpr double kStepOfDepth = 1e-5;
/// Deviations are rounded to powers of exp(0.02), so that they change by at most 1 %.
constexpr double kStepOfLogSigma = 0.02;
/// Rays are given at about this number of grid points. Between them the page interpolates: with a
/// lens of 50 degrees and k1 = -0.21 this moves points by 1.3e-5 of their depth.
constexpr double kRayCount = 10'000;
/// Of tangents; 2e-6 is 1.4 um at 700 mm. Rays of more than 83 degrees are left out.
constexpr double kRayStep = 2e-6;
/// [px] Browsers draw no larger images.
constexpr Eigen::Index kLargestSide = 16384;

struct RangeFrame {
  geometry::RangeMap map;
  std::optional<geometry::ImageF> sigma;
  std::optional<sensing::ReasonImage> reasons;
};

fs::path file_beside(const fs::path& map, const char* ending) {
  return map.parent_path() / (map.stem().string() + ending);
}

void check_map_size(const fs::path& path, Eigen::Index rows, Eigen::Index cols,
                    const geometry::ImageF& z) {
  if (rows == z.rows() && cols == z.cols()) return;
  throw InvalidInput(fmt::format(
      "{}: has {} x {} px, but its range map {} x {}. Decode this frame again, or remove the file.",
      path.string(), cols, rows, z.cols(), z.rows()));
}

RangeFrame read_range_frame(const fs::path& path, const MapCamera& camera) {
  RangeFrame frame{.map = load_range_map(path, camera), .sigma = {}, .reasons = {}};
  if (const fs::path file = file_beside(path, "_sigma.tiff"); is_there(file)) {
    frame.sigma = geometry::read_depth_tiff(file);
    check_map_size(file, frame.sigma->rows(), frame.sigma->cols(), frame.map.z);
  }
  if (const fs::path file = file_beside(path, "_reasons.tiff"); is_there(file)) {
    frame.reasons = sensing::read_reasons(file);
    check_map_size(file, frame.reasons->rows(), frame.reasons->cols(), frame.map.z);
  }
  return frame;
}

std::span<const double> values_of(const geometry::ImageD& image) {
  return {image.data(), static_cast<std::size_t>(image.size())};
}

/// Properties of all frames that are needed before the first one is packed.
struct RangeSurvey {
  geometry::Camera camera;
  ValueRange depth, sigma;
  Json frames = Json::array();
  bool reasons = false;
  double step = 0;  ///< [mm] of depths
};

double step_of(const RangeSurvey& survey, const MapCamera& camera) {
  if (camera.scale) return *camera.scale;  // a depth image holds whole multiples of it
  if (survey.depth.is_empty()) return 1;
  const double fine = survey.sigma.is_empty()
                          ? kStepOfDepth * survey.depth.to_json()["low"].get<double>()
                          : kStepOfSigma * survey.sigma.min();
  // `round_step` may divide by up to 2.5; codes must have room for the farthest depth.
  return geometry::round_step(std::max(fine, 2.6 * survey.depth.max() / geometry::kCodeLimit));
}

void check_camera_of(const fs::path& map, const geometry::Camera& camera,
                     const geometry::Camera& first) {
  if (camera.width > kLargestSide || camera.height > kLargestSide) {
    throw InvalidInput(fmt::format("{}: has {} x {} px; a page shows at most {} in each direction.",
                                   map.string(), camera.width, camera.height, kLargestSide));
  }
  if (camera.width == first.width && camera.height == first.height) return;
  throw InvalidInput(fmt::format(
      "{}: has {} x {} px, but the first frame has {} x {}. A page shows frames of one camera.",
      map.string(), camera.width, camera.height, first.width, first.height));
}

RangeSurvey survey_of(const std::vector<fs::path>& maps, const MapCamera& camera) {
  RangeSurvey survey;
  Progress progress("reading");
  for (const fs::path& path : maps) {
    const RangeFrame frame = read_range_frame(path, camera);
    if (survey.frames.empty()) survey.camera = frame.map.camera;
    check_camera_of(path, frame.map.camera, survey.camera);
    survey.depth.add(values_of(frame.map.z.cast<double>()));
    if (frame.sigma) survey.sigma.add(values_of(frame.sigma->cast<double>()));
    survey.reasons |= frame.reasons.has_value();
    survey.frames.push_back({{"name", path.filename().string()},
                             {"known", frame.map.z.isFinite().count()},
                             {"sigma", frame.sigma.has_value()},
                             {"reasons", frame.reasons.has_value()}});
    progress.show(survey.frames.size(), maps.size());
  }
  if (survey.depth.is_empty() && !survey.reasons) {
    throw InvalidInput(fmt::format(
        "{}: no pixel {} has a depth; there is nothing to show.{}", maps.front().string(),
        maps.size() == 1 ? std::string("of it") : fmt::format("of it and {} more", maps.size() - 1),
        is_range_map(maps.front()) ? " palpate decode --reasons tells why, and a page shows it."
                                   : ""));
  }
  survey.step = step_of(survey, camera);
  return survey;
}

void append(std::vector<std::byte>& bytes, const std::vector<std::byte>& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

std::vector<std::byte> pack_frame(const RangeFrame& frame, double step) {
  std::vector<std::byte> bytes =
      geometry::pack(geometry::codes_of(frame.map.z.cast<double>(), step));
  if (frame.sigma) {
    append(bytes,
           geometry::pack(geometry::codes_of(frame.sigma->cast<double>().log(), kStepOfLogSigma)));
  }
  if (frame.reasons) {
    const auto codes = std::as_bytes(
        std::span(frame.reasons->data(), static_cast<std::size_t>(frame.reasons->size())));
    bytes.insert(bytes.end(), codes.begin(), codes.end());
  }
  return bytes;
}

/// [px] from one point of the grid of rays to the next.
Eigen::Index ray_spacing(const geometry::Camera& camera) {
  const double pixels = static_cast<double>(camera.width) * camera.height;
  return std::lround(std::ceil(std::sqrt(pixels / kRayCount)));
}

/// Points of the grid along one side of the image; the last lies on its edge.
Eigen::Index ray_count(Eigen::Index side, Eigen::Index spacing) {
  return (side - 2 + spacing) / spacing + 1;
}

/// x / z and y / z at the points of the grid, one image after the other.
std::vector<std::byte> pack_rays(const geometry::Camera& camera) {
  const Eigen::Index spacing = ray_spacing(camera), rows = ray_count(camera.height, spacing),
                     cols = ray_count(camera.width, spacing);
  geometry::ImageD x(rows, cols), y(rows, cols);
  for (Eigen::Index row = 0; row < rows; ++row) {
    for (Eigen::Index col = 0; col < cols; ++col) {
      Eigen::Vector2d ray = geometry::undistort(
          camera, Eigen::Vector2d(std::min<Eigen::Index>(col * spacing, camera.width - 1),
                                  std::min<Eigen::Index>(row * spacing, camera.height - 1)));
      if (!(ray.cwiseAbs().maxCoeff() < geometry::kCodeLimit * kRayStep - 1))
        ray.setConstant(std::numeric_limits<double>::quiet_NaN());
      x(row, col) = ray.x();
      y(row, col) = ray.y();
    }
  }
  std::vector<std::byte> bytes = geometry::pack(geometry::codes_of(x, kRayStep));
  append(bytes, geometry::pack(geometry::codes_of(y, kRayStep)));
  return bytes;
}

Json facts_of(const RangeSurvey& survey, bool exact) {
  const Eigen::Index spacing = ray_spacing(survey.camera);
  return {{"width", survey.camera.width},
          {"height", survey.camera.height},
          {"step", survey.step},
          {"exact", exact},
          {"sigma_step", kStepOfLogSigma},
          {"depth", survey.depth.to_json()},
          {"sigma", survey.sigma.to_json()},
          {"reasons", survey.reasons ? Json(reason_words()) : Json(nullptr)},
          {"rays",
           {{"spacing", spacing},
            {"columns", ray_count(survey.camera.width, spacing)},
            {"rows", ray_count(survey.camera.height, spacing)},
            {"step", kRayStep}}},
          {"frames", survey.frames}};
}

}  // namespace

std::string write_range_page(const fs::path& output, const std::vector<fs::path>& maps,
                             const MapCamera& camera, const std::string& title) {
  const RangeSurvey survey = survey_of(maps, camera);
  const std::size_t bytes =
      write_page(output, {.kind = "range",
                          .title = title,
                          .facts = facts_of(survey, camera.scale.has_value()),
                          .common = pack_rays(survey.camera),
                          .files = maps,
                          .pack = [&](const fs::path& map) {
                            return pack_frame(read_range_frame(map, camera), survey.step);
                          }});
  const bool exact = camera.scale.has_value();
  const bool below_noise =
      !survey.sigma.is_empty() && survey.step <= kStepOfSigma * survey.sigma.min();
  return fmt::format("{}, {}; depths are {}{}",
                     counted(maps.size(), exact ? "depth image" : "range map"), megabytes(bytes),
                     exact ? "exact" : fmt::format("rounded to {:g} um", 1000 * survey.step),
                     below_noise ? ", at most a tenth of any predicted deviation" : "");
}

}  // namespace palpate::apps
