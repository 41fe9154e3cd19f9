// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern_colors.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "image/hue.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

constexpr int kTurnDegrees = 360;
constexpr int kLeastColors = 2;
constexpr int kMostColors = 24;  // 15 degrees apart, the limit of the best cameras
constexpr int kLeastTrained = 3;

/// Smallest deviation of a hue [rad]: half a degree, the error of rounding to whole degrees. Keeps
/// a class trained with a perfect image from having zero width.
constexpr double kLeastDeviation = 0.5 * kFullTurn / kTurnDegrees;

/// 2^-20 of the circle is far below the degree to which hues are rounded.
constexpr int kBisections = 20;

/// The steps between neighbouring hues sum to one turn within this share, or to more than one.
constexpr double kRounding = 1e-9;

/// Trained colours that are confused no more often than this are left unchanged, because regions
/// are identified by many stripe edges of many pixels each.
constexpr double kNegligibleOverlap = 1e-4;

constexpr std::array<char, 6> kColorNames = {'R', 'Y', 'G', 'C', 'B', 'M'};
constexpr int kNamedStep = kTurnDegrees / static_cast<int>(kColorNames.size());

void check_count(int count) {
  require("pattern colours: count", count, at_least(kLeastColors).at_most(kMostColors));
}

std::string name_of(int degrees) {
  if (degrees % kNamedStep == 0)
    return {kColorNames[static_cast<std::size_t>(degrees / kNamedStep) % kColorNames.size()]};
  std::string digits = std::to_string(degrees);
  digits.insert(0, 3 - digits.size(), '0');
  return "H" + digits;
}

/// Hue in degrees, or -1 if the name is not one of ours.
int degrees_of(const std::string& name) {
  if (name.size() == 1) {
    const auto* const found = std::find(kColorNames.begin(), kColorNames.end(), name[0]);
    return found == kColorNames.end() ? -1
                                      : kNamedStep * static_cast<int>(found - kColorNames.begin());
  }
  const bool is_number =
      name.size() == 4 && name[0] == 'H' &&
      std::all_of(name.begin() + 1, name.end(), [](unsigned char c) { return std::isdigit(c); });
  const int degrees = is_number ? std::stoi(name.substr(1)) : -1;
  return degrees < kTurnDegrees ? degrees : -1;
}

PatternColor color_at(int degrees) {
  return {name_of(degrees), rgb_of_hue(degrees * kFullTurn / kTurnDegrees)};
}

double deviation(const TrainedColor& color) {
  return std::max(std::sqrt(color.variance), kLeastDeviation);
}

/// An angle brought to [0, 2 pi).
double within_turn(double angle) {
  const double rest = std::fmod(angle, kFullTurn);
  return rest < 0 ? rest + kFullTurn : rest;
}

/// Hues that the camera sees for each projected degree.
struct HueResponse {
  std::array<double, kTurnDegrees> mean{};       ///< [rad], in [0, 2 pi)
  std::array<double, kTurnDegrees> deviation{};  ///< [rad]
};

struct Knot {
  int degrees = 0;
  const TrainedColor* seen = nullptr;
};

std::vector<Knot> sorted_knots(const TrainedColors& trained) {
  std::vector<Knot> knots;
  for (const TrainedColor& color : trained.colors) {
    const int degrees = degrees_of(color.name);
    if (degrees < 0) {
      throw InvalidInput("trained colours: '" + color.name +
                         "' does not say what was projected; names R, Y, G, C, B, M or H and the "
                         "hue in degrees (H072) are expected");
    }
    require("trained colours: " + color.name + ": mean", color.mean, finite(), "rad");
    require("trained colours: " + color.name + ": variance", color.variance, at_least(0).finite(),
            "rad^2");
    knots.push_back({degrees, &color});
  }
  if (knots.size() < kLeastTrained) {
    throw InvalidInput("trained colours: only " + std::to_string(knots.size()) + "; at least " +
                       std::to_string(kLeastTrained) + " are needed to interpolate between them");
  }
  std::sort(knots.begin(), knots.end(),
            [](const Knot& a, const Knot& b) { return a.degrees < b.degrees; });
  return knots;
}

HueResponse measured_response(const std::vector<Knot>& knots) {
  HueResponse response;
  double base = 0;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const Knot& from = knots[i];
    const Knot& to = knots[(i + 1) % knots.size()];
    int span = to.degrees - from.degrees;
    if (i + 1 == knots.size()) span += kTurnDegrees;
    const double rise = within_turn(to.seen->mean - from.seen->mean);
    if (!(rise > 0) || span <= 0 || base + rise > kFullTurn * (1 + kRounding)) {
      throw InvalidInput("trained colours: " + from.seen->name + " and " + to.seen->name +
                         " are not seen in the order in which they were projected; check that the "
                         "training images bear the right names");
    }
    for (int step = 0; step < span; ++step) {
      const auto degree = static_cast<std::size_t>((from.degrees + step) % kTurnDegrees);
      const double share = static_cast<double>(step) / span;
      response.mean[degree] = within_turn(knots[0].seen->mean + base + share * rise);
      response.deviation[degree] =
          (1 - share) * deviation(*from.seen) + share * deviation(*to.seen);
    }
    base += rise;
  }
  return response;
}

/// Separation, going forward around the circle from one projected degree to a later one by less
/// than a turn: the difference of the hues that the camera sees, in units of both deviations.
double forward_separation(const HueResponse& response, int from, int to) {
  const auto a = static_cast<std::size_t>(from % kTurnDegrees);
  const auto b = static_cast<std::size_t>(to % kTurnDegrees);
  return within_turn(response.mean[b] - response.mean[a]) /
         (response.deviation[a] + response.deviation[b]);
}

/// `count` degrees starting at `start`, each the first with at least `separation` from the one
/// before, if the last also has this separation from the first. Sorted; empty if there is no room.
std::vector<int> pack(const HueResponse& response, int count, int start, double separation) {
  std::vector<int> degrees = {start};
  while (static_cast<int>(degrees.size()) < count) {
    int next = degrees.back() + 1;
    while (next < start + kTurnDegrees &&
           forward_separation(response, degrees.back(), next) < separation)
      ++next;
    if (next >= start + kTurnDegrees) return {};
    degrees.push_back(next);
  }
  if (forward_separation(response, degrees.back(), start + kTurnDegrees) < separation) return {};
  for (int& degree : degrees) degree %= kTurnDegrees;
  std::sort(degrees.begin(), degrees.end());
  return degrees;
}

double squared_distance_to_knots(const std::vector<int>& degrees, const std::vector<Knot>& knots) {
  double sum = 0;
  for (const int degree : degrees) {
    int nearest = kTurnDegrees;
    for (const Knot& knot : knots) {
      const int distance = std::abs(degree - knot.degrees);
      nearest = std::min({nearest, distance, kTurnDegrees - distance});
    }
    sum += nearest * nearest;
  }
  return sum;
}

/// Among all choices that reach a separation, the degrees nearest to the trained ones; else empty.
std::vector<int> nearest_packing(const HueResponse& response, const std::vector<Knot>& knots,
                                 int count, double separation) {
  std::vector<int> best;
  double least = std::numeric_limits<double>::infinity();
  for (int start = 0; start < kTurnDegrees; ++start) {
    const std::vector<int> degrees = pack(response, count, start, separation);
    if (degrees.empty()) continue;
    const double distance = squared_distance_to_knots(degrees, knots);
    if (!(distance < least)) continue;
    least = distance;
    best = degrees;
  }
  return best;
}

SpreadColors expected_colors(const std::vector<int>& degrees, const HueResponse& response) {
  SpreadColors result;
  for (const int degree : degrees) {
    const auto i = static_cast<std::size_t>(degree);
    const PatternColor color = color_at(degree);
    result.colors.push_back(color);
    result.expected.push_back({.name = color.name,
                               .mean = response.mean[i],
                               .variance = response.deviation[i] * response.deviation[i]});
  }
  return result;
}

}  // namespace

Eigen::Vector3d rgb_of_hue(double hue) {
  const double sector = 3 * hue / std::numbers::pi;
  const auto channel = [&](double center) {
    const double distance = std::abs(std::remainder(sector - center, 6));
    return std::clamp(2 - distance, 0.0, 1.0);
  };
  return {channel(0), channel(2), channel(4)};
}

std::vector<PatternColor> evenly_spaced_colors(int count) {
  check_count(count);
  std::vector<PatternColor> colors;
  colors.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    colors.push_back(color_at(static_cast<int>(std::lround(i * double{kTurnDegrees} / count))));
  }
  return colors;
}

SpreadColors spread_colors(const TrainedColors& trained, int count) {
  check_count(count);
  const std::vector<Knot> knots = sorted_knots(trained);
  const HueResponse response = measured_response(knots);
  const bool as_trained = static_cast<int>(knots.size()) == count &&
                          largest_overlap(trained.colors) <= kNegligibleOverlap;
  if (as_trained) {
    std::vector<int> degrees;
    degrees.reserve(knots.size());
    for (const Knot& knot : knots) degrees.push_back(knot.degrees);
    return expected_colors(degrees, response);
  }
  // Bisection for the largest separation that leaves room for all.
  double reached = 0;
  double missed = kFullTurn / (2 * kLeastDeviation);
  std::vector<int> best = nearest_packing(response, knots, count, reached);
  for (int step = 0; step < kBisections; ++step) {
    const double middle = 0.5 * (reached + missed);
    std::vector<int> degrees = nearest_packing(response, knots, count, middle);
    (degrees.empty() ? missed : reached) = middle;
    if (!degrees.empty()) best = std::move(degrees);
  }
  return expected_colors(best, response);
}

Eigen::MatrixXd hue_separation(const std::vector<TrainedColor>& colors) {
  const auto count = static_cast<Eigen::Index>(colors.size());
  Eigen::MatrixXd separation = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = a + 1; b < count; ++b) {
      const TrainedColor& first = colors[static_cast<std::size_t>(a)];
      const TrainedColor& second = colors[static_cast<std::size_t>(b)];
      separation(a, b) = separation(b, a) =
          std::abs(wrap(first.mean - second.mean)) / (deviation(first) + deviation(second));
    }
  }
  return separation;
}

double largest_overlap(const std::vector<TrainedColor>& colors) {
  const Eigen::MatrixXd separation = hue_separation(colors);
  double largest = 0;
  for (Eigen::Index a = 0; a < separation.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < separation.cols(); ++b) {
      largest = std::max(largest, 0.5 * std::erfc(separation(a, b) / std::numbers::sqrt2));
    }
  }
  return largest;
}

}  // namespace palpate::sensing
