// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/evidence.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "decode/light_evidence.h"
#include "image/hue.h"
#include "image/reasons.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

/// Approximate numbers of scanlines that are compared, and of rows whose hues are.
constexpr long kScanlines = 120;
constexpr long kHueLines = 40;

/// Distance from an edge at which its sides have their own hue [px].
constexpr long kSide = 4;

/// A hue is that of a trained colour if it is within this number of its deviations.
constexpr double kReach = 3;

/// An exchange of channels explains something only if it takes the colours of a pattern closer
/// than this to colours of the pattern (distance of red, green and blue).
constexpr double kSameColor = 0.2;

/// Trained hues fit the pattern if their mean cosine with its own hues is at least this: 45
/// degrees.
constexpr double kFittingHues = 0.7;

/// In a part of the frame, of which there are kRowBands x kPartColumns, d is about the same if the
/// mean of exp(2 pi i d) is at least kSteady long; with fewer than kLeastInPart edges that is no
/// evidence.
constexpr long kPartColumns = 4;
constexpr double kSteady = 0.6;
constexpr long kLeastInPart = 8;
/// Blur and lateral chromatic aberration of lenses displace stripe edges by at most this [px] on
/// average.
constexpr double kDisplaced = 0.35;

/// Difference in periods above which an edge is no evidence of a trend: it was misread, or a whole
/// period is as likely.
constexpr double kTrendTurns = 0.25;

/// With fewer stripe edges than this, the sinusoid may run along the other axis; this test takes a
/// millisecond.
constexpr long kFewEdges = 60;

/// An agreement below this needs an explanation; finding it takes a millisecond.
constexpr double kNeedsExplanation = 0.6;

using Recolor = Eigen::Vector3d (*)(const Eigen::Vector3d&);

/// Index of each colour after the change; empty if one is not among the pattern's.
std::vector<int> recolored(const Pattern& pattern, Recolor recolor) {
  std::vector<int> indices;
  for (const PatternColor& color : pattern.colors) {
    const Eigen::Vector3d wanted = recolor(color.rgb);
    const auto near = [&](const PatternColor& other) {
      return (other.rgb - wanted).norm() < kSameColor;
    };
    const auto found = std::find_if(pattern.colors.begin(), pattern.colors.end(), near);
    if (found == pattern.colors.end()) return {};
    indices.push_back(static_cast<int>(found - pattern.colors.begin()));
  }
  return indices;
}

/// Mean cosine of the angle between trained hues and the pattern's own.
double hue_fit(const std::vector<PatternColor>& colors, const std::vector<HueSpread>& trained) {
  double sum = 0;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const Eigen::Vector3f rgb = colors[i].rgb.cast<float>();
    const auto own = static_cast<double>(hue_of(rgb.x(), rgb.y(), rgb.z()).angle);
    sum += std::cos(trained[i].mean - own);
  }
  return sum / static_cast<double>(colors.size());
}

EdgeMotion edge_motion(const DecoderGeometry& model) {
  constexpr double kSmallStep = 1e-3;  // of the depth
  const Triangulation triangulation(model.rig());
  const int axis = model.pattern().axis == Axis::x ? 0 : 1;
  const geometry::Camera& camera = model.rig().camera;
  const auto project = [&](double du, double dv, double z) {
    const Eigen::Vector2d place((camera.width - 1) / 2.0 + du, (camera.height - 1) / 2.0 + dv);
    return triangulation.project(triangulation.direction(geometry::undistort(camera, place)), z);
  };
  const double z = model.carrier().z;
  const bool transposed = model.carrier().transposed;
  const Eigen::Vector2d moved = project(0, 0, z * (1 + kSmallStep)) - project(0, 0, z);
  const Eigen::Vector2d beside = project(transposed ? 0 : 1, transposed ? 1 : 0, z);
  const double across_per_pixel = beside[1 - axis] - project(0, 0, z)[1 - axis];
  const double edge_moves = std::abs(moved[1 - axis] / across_per_pixel);
  const double periods = std::abs(moved[axis]) / model.pattern().period;
  return {.per_period = edge_moves / periods, .disparity = edge_moves / kSmallStep * z};
}

/// Sums over the stripe edges in a part of the frame, of cos(2 pi d) and sin(2 pi d).
struct Part {
  double cosine = 0;
  double sine = 0;
  long edges = 0;
};

/// Difference of the phase at an edge from the measured one, in periods, without whole
/// periods.
double turns_apart(const Regions& regions, const PhaseGuess& guess) {
  return (guess.phase - static_cast<double>(regions.phase(guess.row, guess.column))) / kFullTurn;
}

}  // namespace

EvidenceFinder::EvidenceFinder(const DecoderGeometry& model, const TrainedColors& colors)
    : stripes_(model.pattern().stripes), by_colors_(model.pattern()), motion_(edge_motion(model)) {
  const Pattern& pattern = model.pattern();
  const std::vector<HueSpread> trained = trained_hues(pattern, colors);
  colors_fit_ = hue_fit(pattern.colors, trained) >= kFittingHues;
  for (const HueSpread& hue : trained)
    hues_.push_back({static_cast<float>(hue.mean), static_cast<float>(kReach * hue.deviation)});
  for (std::size_t step = 0; step < trained_.size(); ++step) {
    const auto hue = static_cast<float>(kFullTurn * (static_cast<double>(step) + 0.5) /
                                        static_cast<double>(trained_.size()));
    for (int color = 0; color < static_cast<int>(hues_.size()); ++color) {
      if (has_hue(hue, color)) trained_[step] = 1;
    }
  }
  const auto change = [&](FrameExplanation explanation) -> Change& {
    return changes_[static_cast<std::size_t>(explanation)];
  };
  using enum FrameExplanation;
  change(red_blue_swapped).color = recolored(
      pattern, [](const Eigen::Vector3d& c) { return Eigen::Vector3d(c.z(), c.y(), c.x()); });
  change(red_green_swapped).color = recolored(
      pattern, [](const Eigen::Vector3d& c) { return Eigen::Vector3d(c.y(), c.x(), c.z()); });
  change(green_blue_swapped).color = recolored(
      pattern, [](const Eigen::Vector3d& c) { return Eigen::Vector3d(c.x(), c.z(), c.y()); });
  change(negative).color = recolored(pattern, [](const Eigen::Vector3d& c) {
    return Eigen::Vector3d(Eigen::Vector3d::Ones() - c);
  });
  change(negative).turns = 0.5;
  change(stripes_reversed).exchange = change(stripes_reversed).reverse = true;
  const bool transposed = model.carrier().transposed;
  Change& along_columns = change(transposed ? flipped : mirrored);
  along_columns.exchange = along_columns.mirror = true;
  change(transposed ? mirrored : flipped).flip = true;
  change(rotated).exchange = change(rotated).mirror = change(rotated).flip = true;
}

bool EvidenceFinder::has_hue(float hue, int color) const {
  const Hues& trained = hues_[static_cast<std::size_t>(color)];
  return std::abs(wrap(hue - trained.mean)) <= trained.reach;
}

std::vector<Transition> EvidenceFinder::trusted_edges(const Workspace& work) const {
  std::vector<Transition> edges;
  const long columns = work.hue.cols();
  const long step = step_for(work.hue.rows(), kScanlines);
  for (const Transition& edge : work.transitions) {
    if (edge.row % step != 0) continue;
    const long column = std::lround(edge.column);
    if (column < kSide || column + kSide >= columns) continue;
    const long before = static_cast<long>(edge.column);
    const int label = work.regions.label(edge.row, before);
    if (label < 0 || label != work.regions.label(edge.row, before + 1)) continue;
    // Blur mixes the colours of two surfaces and displaces the edge.
    if (work.reasons(edge.row, column) == code(Reason::border)) continue;
    const auto at = static_cast<std::size_t>(edge.edge);
    const float left = work.hue(edge.row, column - kSide);
    const float right = work.hue(edge.row, column + kSide);
    const bool as_read = has_hue(left, stripes_[at]) && has_hue(right, stripes_[at + 1]);
    const bool other_way = has_hue(right, stripes_[at]) && has_hue(left, stripes_[at + 1]);
    if (as_read || other_way) edges.push_back(edge);
  }
  return edges;
}

std::vector<Transition> EvidenceFinder::changed(const std::vector<Transition>& edges,
                                                const Change& change, const ImagePart& part,
                                                const DecoderGeometry& whole) const {
  std::vector<Transition> moved;
  for (Transition edge : edges) {
    int first = stripes_[static_cast<std::size_t>(edge.edge)];
    int second = stripes_[static_cast<std::size_t>(edge.edge) + 1];
    if (!change.color.empty()) {
      first = change.color[static_cast<std::size_t>(first)];
      second = change.color[static_cast<std::size_t>(second)];
    }
    if (change.exchange) std::swap(first, second);
    edge.edge = by_colors_.find(first, second);
    if (edge.edge < 0) continue;
    if (change.reverse) edge.edge = static_cast<int>(stripes_.size()) - 2 - edge.edge;
    edge.row += static_cast<int>(part.row);
    edge.column += static_cast<float>(part.column);
    if (change.mirror)
      edge.column = static_cast<float>(whole.columns() - 1 - std::lround(edge.column));
    if (change.flip) edge.row = static_cast<int>(whole.rows()) - 1 - edge.row;
    moved.push_back(edge);
  }
  return moved;
}

std::vector<EvidenceFinder::Comparison> EvidenceFinder::compared(
    const std::vector<Transition>& edges, const Workspace& work,
    const DecoderGeometry& whole) const {
  // An edge lies between two pixels, at both of which its phase is known.
  std::vector<Transition> both;
  for (Transition edge : edges) {
    const float before = std::floor(edge.column);
    for (const float column : {before, before + 1}) {
      edge.column = column;
      both.push_back(edge);
    }
  }
  std::vector<PhaseGuess> guesses;
  work.model(whole).phases_at_edges(both, guesses);
  std::vector<Comparison> comparisons;
  auto edge = edges.begin();
  for (std::size_t i = 0; i + 1 < guesses.size(); ++i) {
    const PhaseGuess& first = guesses[i];
    const PhaseGuess& second = guesses[i + 1];
    if (second.row != first.row || second.column != first.column + 1 || second.edge != first.edge) {
      continue;
    }
    // Both lists have the same order; some edges have no guess.
    while (edge->row != first.row || static_cast<int>(edge->column) != first.column) ++edge;
    const double share = static_cast<double>(edge->column) - first.column;
    comparisons.push_back({.row = first.row,
                           .column = first.column,
                           .edge = first.edge,
                           .turns = (1 - share) * turns_apart(work.regions, first) +
                                    share * turns_apart(work.regions, second)});
    ++i;
  }
  return comparisons;
}

void EvidenceFinder::compare(const std::vector<Transition>& edges, const Workspace& work,
                             const DecoderGeometry& whole, DecodeEvidence& evidence) const {
  const std::vector<Comparison> comparisons = compared(edges, work, whole);
  evidence.edges = static_cast<long>(comparisons.size());
  evidence.off_panel = static_cast<long>(edges.size() - comparisons.size());
  std::set<int> different;
  std::array<std::array<Part, kPartColumns>, kRowBands> bands{};
  // In the frame, not in the working image, because rows of the frame are lost or shifted.
  const bool transposed = whole.carrier().transposed;
  const long rows = transposed ? whole.columns() : whole.rows();
  const long columns = transposed ? whole.rows() : whole.columns();
  evidence.rows = work.full_size.empty() ? rows : 2 * rows;
  const Comparison* last = nullptr;
  for (const Comparison& one : comparisons) {
    const double cosine = std::cos(kFullTurn * one.turns);
    const double sine = std::sin(kFullTurn * one.turns);
    long row = work.part.row + one.row, column = work.part.column + one.column;
    if (transposed) std::swap(row, column);
    Part& part = bands[static_cast<std::size_t>(row * kRowBands / rows)]
                      [static_cast<std::size_t>(column * kPartColumns / columns)];
    part.cosine += cosine;
    part.sine += sine;
    ++part.edges;
    evidence.agreement += cosine;
    evidence.shift += sine;
    different.insert(one.edge);
    add_to_trend(one, static_cast<double>(work.surfaces.z(one.row, one.column)), evidence.trend);
    const auto label = [&](const Comparison& at) { return work.regions.label(at.row, at.column); };
    if (last != nullptr && last->row == one.row && label(*last) == label(one)) {
      ++evidence.neighbours;
      evidence.smoothness += std::cos(kFullTurn * (one.turns - last->turns));
    }
    last = &one;
  }
  evidence.stripe_edges = static_cast<long>(different.size());
  for (std::size_t band = 0; band < bands.size(); ++band) {
    for (const Part& part : bands[band]) {
      const auto edges_in_part = static_cast<double>(part.edges);
      const bool steady = std::hypot(part.cosine, part.sine) >= kSteady * edges_in_part;
      if (part.edges < kLeastInPart || !steady) continue;
      evidence.steady_edges[band] += part.edges;
      const double turns = std::atan2(part.sine, part.cosine) / kFullTurn;
      if (std::abs(turns) * motion_.per_period > kDisplaced)
        evidence.displaced_edges[band] += part.edges;
    }
  }
}

void EvidenceFinder::add_to_trend(const Comparison& one, double z, DepthTrend& trend) const {
  const double turns = one.turns - std::round(one.turns);
  if (!(z > 0) || std::abs(turns) > kTrendTurns) return;
  const double disparity = motion_.disparity / z;
  const double shift = turns * motion_.per_period;
  trend += {.edges = 1,
            .disparity = disparity,
            .disparity_squares = disparity * disparity,
            .shift = shift,
            .products = disparity * shift};
}

double EvidenceFinder::explained(const std::vector<Transition>& edges, const Change& change,
                                 const Workspace& work, const DecoderGeometry& whole) const {
  std::vector<PhaseGuess> guesses;
  whole.phases_at_edges(changed(edges, change, work.part, whole), guesses);
  double sum = 0;
  for (const PhaseGuess& guess : guesses) {
    const long row = (change.flip ? whole.rows() - 1 - guess.row : guess.row) - work.part.row;
    const long column =
        (change.mirror ? whole.columns() - 1 - guess.column : guess.column) - work.part.column;
    // Both phases with their carrier, which is opposite in a flipped image.
    const double carrier = whole.carrier().along;
    const double expected = guess.phase + carrier * static_cast<double>(guess.row);
    const double seen =
        static_cast<double>(work.regions.phase(row, column)) + carrier * static_cast<double>(row);
    sum += std::cos(expected - (change.flip ? -seen : seen) + kFullTurn * change.turns);
  }
  return sum;
}

DecodeEvidence EvidenceFinder::find(const Workspace& work, const DecoderGeometry& whole) const {
  DecodeEvidence evidence;
  evidence.colors_fit_pattern = colors_fit_;
  add_light(work, evidence);
  add_row_steps(work, whole.carrier(), evidence);
  for (long row = 0; row < work.hue.rows(); row += step_for(work.hue.rows(), kHueLines)) {
    for (long column = 0; column < work.hue.cols(); ++column) {
      evidence.lit += work.lit(row, column);
      if (work.modulated(row, column) == 0) continue;
      ++evidence.hues;
      evidence.trained_hues +=
          trained_[static_cast<std::size_t>(HueClassifier::step_of(work.hue(row, column)))];
    }
  }
  const std::vector<Transition> edges = trusted_edges(work);
  compare(edges, work, whole, evidence);
  if (static_cast<long>(edges.size()) < kFewEdges) {
    add_sinusoid_across(work, std::abs(whole.carrier().along), step_for(work.hue.rows(), kHueLines),
                        evidence);
  }
  if (evidence.agreement >= kNeedsExplanation * static_cast<double>(edges.size())) return evidence;
  evidence.explained_edges = static_cast<long>(edges.size());
  for (std::size_t i = 0; i < changes_.size(); ++i) {
    const Change& change = changes_[i];
    const bool changes_nothing = change.color.empty() && !change.exchange && !change.flip;
    if (!changes_nothing) evidence.explained[i] = explained(edges, change, work, whole);
  }
  return evidence;
}

}  // namespace palpate::sensing
