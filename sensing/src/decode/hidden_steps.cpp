// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/hidden_steps.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/hot_loop.h"
#include "image/hue.h"

namespace palpate::sensing {
namespace {

/// Phases of neighbouring pixels are continuous up to this [rad], without whole turns.
constexpr float kContinuous = 0.6F;
/// Farthest pixel from a step that may belong to the other surface [px].
constexpr int kFarthest = 40;
/// Surfaces differ in brightness if, kBeside pixels from the step, their strongest channels differ
/// by more than a factor that is larger than the difference of the channels of one surface.
constexpr long kBeside = 6;
constexpr float kOtherLight = 1.7F;

/// A pixel beside a step, from which the row is followed away from it.
struct Start {
  int row = 0;
  int column = 0;
  int direction = 1;
  int turns = 0;  ///< to be added to the phase for that of the other surface
};

/// Squared half amplitude of the strongest channel.
float largest_power(const std::vector<Demodulated>& channels, long row, long column) {
  float largest = 0;
  for (const Demodulated& channel : channels)
    largest = std::max(largest, channel.power(row, column));
  return largest;
}

/// Returns true if the surfaces to both sides of a step, to the right of a pixel, differ in light.
bool differ_in_light(const std::vector<Demodulated>& channels, long row, long column) {
  const long last = channels[0].re.cols() - 1;
  const float left = largest_power(channels, row, std::max(0L, column - kBeside));
  const float right = largest_power(channels, row, std::min(last, column + 1 + kBeside));
  return std::max(left, right) > kOtherLight * kOtherLight * std::min(left, right);
}

/// Returns true if there is a step anywhere between the pixels of a row.
PALPATE_HOT_LOOP bool has_steps(const float* phase, float least, long columns) {
  int any = 0;
  for (long i = 0; i + 1 < columns; ++i) any |= std::abs(phase[i + 1] - phase[i]) > least ? 1 : 0;
  return any != 0;
}

std::vector<Start> find_starts(const std::vector<Demodulated>& channels, const Plane& phase) {
  const auto turn = static_cast<float>(kFullTurn);
  std::vector<Start> starts;
  for (int row = 0; row < phase.rows(); ++row) {
    if (!has_steps(&phase(row, 0), turn / 2, phase.cols())) continue;
    for (int column = 0; column + 1 < phase.cols(); ++column) {
      const float step = phase(row, column + 1) - phase(row, column);
      if (!(std::abs(step) > turn / 2)) continue;  // also NaN
      const float turns = std::round(step / turn);
      if (std::abs(step - turns * turn) > kContinuous) continue;
      if (differ_in_light(channels, row, column)) continue;
      starts.push_back({row, column, -1, static_cast<int>(turns)});
      starts.push_back({row, column + 1, 1, -static_cast<int>(turns)});
    }
  }
  return starts;
}

/// The pixels of the row from a step to the next one, or to the end of the surface.
void follow_row(const Plane& phase, const Start& start, std::vector<PhaseGuess>& places) {
  places.clear();
  float before = phase(start.row, start.column);
  for (int i = 0; i < kFarthest; ++i) {
    const int column = start.column + start.direction * i;
    if (column < 0 || column >= phase.cols()) return;
    const float here = phase(start.row, column);
    if (!(std::abs(here - before) <= static_cast<float>(kFullTurn / 2))) return;
    places.push_back({.row = start.row, .column = column, .phase = static_cast<double>(here)});
    before = here;
  }
}

}  // namespace

void find_hidden_steps(const std::vector<Demodulated>& channels, const Plane& phase,
                       const Plane& hue, const HueClassifier& classifier,
                       const StripeColors& stripes, const DecoderGeometry& model, Mask& marked) {
  marked.setZero(phase.rows(), phase.cols());
  std::vector<PhaseGuess> places;
  std::vector<float> pixels;
  for (const Start& start : find_starts(channels, phase)) {
    follow_row(phase, start, places);
    model.stripes_at_phases(places, start.turns, pixels);
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (std::isnan(pixels[i])) break;  // the projector does not light the other surface there
      const PhaseGuess& place = places[i];
      const int color = stripes.color(pixels[i]);
      if (color >= 0 && classifier.best(hue(place.row, place.column)) != color) break;
      marked(place.row, place.column) = 1;
    }
  }
}

}  // namespace palpate::sensing
