// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/decoder_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "image/hot_loop.h"
#include "image/hue.h"
#include "image/reasons.h"

namespace palpate::sensing {
namespace {

/// Constants of planes through the projector's centre. Each contains the projector pixels with one
/// coordinate along `axis`, which is pixels_per_phase times the phase.
SurfaceConstants surface_constants(const Rig& rig, int axis, double pixels_per_phase) {
  const geometry::Camera& projector = rig.projector;
  const bool x = axis == 0;
  const Eigen::Vector3d& t = rig.T_projector_camera.translation();
  const double focal = x ? projector.fx : projector.fy;
  const double center = x ? projector.cx : projector.cy;
  const auto normalized = [&](double pixel) {
    return static_cast<float>((pixel - center) / focal);
  };
  SurfaceConstants constants;
  constants.t_along = static_cast<float>(t[axis]);
  constants.t_across = static_cast<float>(t[1 - axis]);
  constants.t_forward = static_cast<float>(t.z());
  constants.first_along = normalized(-0.5);
  constants.last_along = normalized((x ? projector.width : projector.height) - 0.5);
  constants.first_across_px = -0.5F;
  constants.last_across_px = static_cast<float>(x ? projector.height : projector.width) - 0.5F;
  constants.focal_across_px = static_cast<float>(x ? projector.fy : projector.fx);
  constants.center_across_px = static_cast<float>(x ? projector.cy : projector.cx);
  constants.along_per_pixel = static_cast<float>(1 / focal);
  constants.along_offset = normalized(0);
  constants.along_per_phase = static_cast<float>(pixels_per_phase / focal);
  std::transform(projector.distortion.begin(), projector.distortion.end(),
                 constants.distortion.begin(), [](double k) { return static_cast<float>(k); });
  if (x) std::swap(constants.distortion[2], constants.distortion[3]);  // p1 bends y
  return constants;
}

void find_surface_of(const SurfaceRow& row, const SurfaceConstants& constants) {
  const auto& lens = constants.distortion;
  if (std::any_of(lens.begin(), lens.end(), [](float k) { return k != 0; })) {
    find_surface_through_lens(row, constants);
  } else {
    find_surface(row, constants);
  }
}

/// Keeps an earlier reason.
PALPATE_HOT_LOOP void add_reasons(const std::int32_t* reason, std::uint8_t* __restrict reasons,
                                  long columns) {
  for (long i = 0; i < columns; ++i) {
    reasons[i] = reasons[i] != 0 ? reasons[i] : static_cast<std::uint8_t>(reason[i]);
  }
}

}  // namespace

DecoderGeometry::DecoderGeometry(const Rig& rig, const Pattern& pattern)
    : rig_((check_rig(rig, "rig"), rig)),
      pattern_((check_pattern(pattern, "pattern"), pattern)),
      triangulation_(rig),
      carrier_(expected_carrier(rig, pattern)),
      rows_(carrier_.transposed ? rig.camera.width : rig.camera.height),
      columns_(carrier_.transposed ? rig.camera.height : rig.camera.width),
      axis_(pattern.axis == Axis::x ? 0 : 1),
      rays_{Plane(rows_, columns_), Plane(rows_, columns_), Plane(rows_, columns_)} {
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(rig.camera);
  for (long row = 0; row < rows_; ++row) {
    for (long column = 0; column < columns_; ++column) {
      const long ray = carrier_.transposed ? column * rows_ + row : row * columns_ + column;
      const Eigen::Vector3f d = triangulation_.direction(rays.col(ray)).cast<float>();
      rays_.along(row, column) = d[axis_];
      rays_.across(row, column) = d[1 - axis_];
      rays_.forward(row, column) = d.z();
    }
  }
  prepare_chromatic(rays);
}

DecoderGeometry::DecoderGeometry(const DecoderGeometry& whole, const ImagePart& part)
    : rig_(whole.rig_),
      pattern_(whole.pattern_),
      triangulation_(whole.triangulation_),
      carrier_(whole.carrier_),
      rows_(part.rows),
      columns_(part.columns),
      axis_(whole.axis_),
      rays_{part_of(whole.rays_.along, part), part_of(whole.rays_.across, part),
            part_of(whole.rays_.forward, part)},
      chromatic_(part_of(whole.chromatic_, part)) {}

Eigen::Vector3d DecoderGeometry::direction(long row, long column) const {
  Eigen::Vector3f d;
  d[axis_] = rays_.along(row, column);
  d[1 - axis_] = rays_.across(row, column);
  d.z() = rays_.forward(row, column);
  return d.cast<double>();
}

void DecoderGeometry::prepare_chromatic(const Eigen::Matrix2Xd& rays) {
  Plane& expected = chromatic_.expected_pixel;
  expected.resize(rows_, columns_);
  for (long row = 0; row < rows_; ++row) {
    for (long column = 0; column < columns_; ++column) {
      const Eigen::Vector2d pixel = triangulation_.project(direction(row, column), carrier_.z);
      expected(row, column) = static_cast<float>(pixel[axis_]);
    }
  }
  const ChromaticShift* const shifts[] = {&rig_.red, &rig_.blue};
  for (std::size_t i = 0; i < 2; ++i) {
    chromatic_.channels[i] =
        channel_model(channel_shift(rig_.camera, shifts[i]->alpha, rays, carrier_),
                      chromatic_lag(*shifts[i], rig_.projector, pattern_), expected);
  }
}

double DecoderGeometry::phase_of(double pixel, long row) const {
  return kFullTurn * pixel / pattern_.period + pattern_.phase -
         carrier_.along * static_cast<double>(row);
}

std::optional<double> DecoderGeometry::phase_at_depth(long row, long column, double z) const {
  const Eigen::Vector2d pixel = triangulation_.project(direction(row, column), z);
  if (!triangulation_.on_panel(pixel)) return std::nullopt;
  return phase_of(pixel[axis_], row);
}

void DecoderGeometry::find_other_pixels(int axis, const std::vector<AxisPixel>& places,
                                        std::vector<float>& pixels) const {
  // The same computation as for the depths of a row; here a "row" is a list of places.
  SurfaceConstants constants = surface_constants(rig_, axis, 1);
  constants.max_sensitivity = std::numeric_limits<float>::infinity();
  const Plane& rays_along = axis == axis_ ? rays_.along : rays_.across;
  const Plane& rays_across = axis == axis_ ? rays_.across : rays_.along;
  constexpr std::size_t kChunk = 256;
  using Numbers = std::array<float, kChunk>;
  Numbers known, along, across, forward, z, z_per_phase;
  const Numbers zero{};
  std::array<std::int32_t, kChunk> reason;
  pixels.resize(places.size());
  for (std::size_t start = 0; start < places.size(); start += kChunk) {
    const std::size_t count = std::min(kChunk, places.size() - start);
    for (std::size_t i = 0; i < count; ++i) {
      const AxisPixel& place = places[start + i];
      known[i] = place.pixel;
      along[i] = rays_along(place.row, place.column);
      across[i] = rays_across(place.row, place.column);
      forward[i] = rays_.forward(place.row, place.column);
    }
    find_surface_of({.phase = known.data(),
                     .along_at_zero_phase = constants.along_offset,
                     .along = along.data(),
                     .across = across.data(),
                     .forward = forward.data(),
                     .expected = zero.data(),
                     .red = zero.data(),
                     .blue = zero.data(),
                     .z = z.data(),
                     .stripe_pixel = &pixels[start],
                     .z_per_phase = z_per_phase.data(),
                     .reason = reason.data(),
                     .columns = static_cast<long>(count)},
                    constants);
    for (std::size_t i = 0; i < count; ++i) {
      if (reason[i] != code(Reason::reconstructed)) pixels[start + i] = kUnknown;
    }
  }
}

void DecoderGeometry::phases_at_edges(const std::vector<Transition>& transitions,
                                      std::vector<PhaseGuess>& guesses) const {
  std::vector<AxisPixel> places;
  places.reserve(transitions.size());
  for (const Transition& transition : transitions) {
    const double edge = pattern_.stripe_edges[static_cast<std::size_t>(transition.edge)];
    places.push_back({transition.row, std::lround(transition.column), static_cast<float>(edge)});
  }
  std::vector<float> pixels;
  find_other_pixels(1 - axis_, places, pixels);
  guesses.clear();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (std::isnan(pixels[i])) continue;
    const Transition& transition = transitions[i];
    guesses.push_back({.row = transition.row,
                       .column = static_cast<int>(places[i].column),
                       .phase = phase_of(static_cast<double>(pixels[i]), transition.row),
                       .score = static_cast<double>(transition.score),
                       .edge = transition.edge});
  }
}

std::pair<int, int> DecoderGeometry::turns_on_panel(const PhaseGuess& guess) const {
  const int size = axis_ == 0 ? rig_.projector.width : rig_.projector.height;
  const auto turns = [&](double pixel) {
    return (phase_of(pixel, guess.row) - guess.phase) / kFullTurn;
  };
  return {static_cast<int>(std::ceil(turns(-0.5))),
          static_cast<int>(std::floor(turns(size - 0.5)))};
}

void DecoderGeometry::stripes_at_phases(const std::vector<PhaseGuess>& phases, int turns,
                                        std::vector<float>& pixels) const {
  std::vector<AxisPixel> places;
  places.reserve(phases.size());
  for (const PhaseGuess& guess : phases) {
    const double absolute = guess.phase + kFullTurn * turns - pattern_.phase +
                            carrier_.along * static_cast<double>(guess.row);
    places.push_back(
        {guess.row, guess.column, static_cast<float>(absolute / kFullTurn * pattern_.period)});
  }
  find_other_pixels(axis_, places, pixels);
}

void DecoderGeometry::find_surfaces(const Plane& phase, const ChannelShares& shares,
                                    double max_sensitivity, SurfaceImages& surfaces,
                                    ReasonImage& reasons) const {
  const double per_pixel = kFullTurn / pattern_.period;
  SurfaceConstants constants = surface_constants(rig_, axis_, 1 / per_pixel);
  constants.max_sensitivity = static_cast<float>(max_sensitivity);
  const bool colored = shares.red.size() > 0;
  if (colored) {
    constants.lag_red = static_cast<float>(chromatic_.channels[0].lag.slope / per_pixel);
    constants.lag_blue = static_cast<float>(chromatic_.channels[1].lag.slope / per_pixel);
  }
  for (Plane* const plane : {&surfaces.z, &surfaces.stripe_pixel, &surfaces.z_per_phase}) {
    plane->resize(rows_, columns_);
  }
  std::vector<std::int32_t> reason(static_cast<std::size_t>(columns_));
  for (long row = 0; row < rows_; ++row) {
    const double pixel_at_zero =
        (carrier_.along * static_cast<double>(row) - pattern_.phase) / per_pixel;
    const double focal = axis_ == 0 ? rig_.projector.fx : rig_.projector.fy;
    const double center = axis_ == 0 ? rig_.projector.cx : rig_.projector.cy;
    const float* const expected = &chromatic_.expected_pixel(row, 0);
    find_surface_of({.phase = &phase(row, 0),
                     .along_at_zero_phase = static_cast<float>((pixel_at_zero - center) / focal),
                     .along = &rays_.along(row, 0),
                     .across = &rays_.across(row, 0),
                     .forward = &rays_.forward(row, 0),
                     .expected = expected,
                     .red = colored ? &shares.red(row, 0) : expected,
                     .blue = colored ? &shares.blue(row, 0) : expected,
                     .z = &surfaces.z(row, 0),
                     .stripe_pixel = &surfaces.stripe_pixel(row, 0),
                     .z_per_phase = &surfaces.z_per_phase(row, 0),
                     .reason = reason.data(),
                     .columns = columns_},
                    constants);
    add_reasons(reason.data(), &reasons(row, 0), columns_);
  }
}

}  // namespace palpate::sensing
