// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/nonrigid_registration.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "base/numbers.h"
#include "deformation/deformation_equations.h"
#include "deformation/intensity_pairs.h"
#include "deformation/measured_surface.h"
#include "deformation/vertex_deviations.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/core/work_steps.h"

namespace palpate::geometry {
namespace {

/// Approximate number of vertices per node that are attracted to the map. More cost time and change
/// the result by less than the noise of a sensor.
constexpr std::size_t kSamplesPerNode = 60;

/// Weight of a known vertex, in those of all measured points around a node.
constexpr double kKnown = 10;

/// Fewer pairs do not even determine a rigid motion.
constexpr int kMinPairs = 6;

/// The stiffness decreases and the gate narrows geometrically in this many levels.
constexpr int kLevels = 6;
/// First level of a surface that was tracked from the previous frame.
constexpr int kFirstTrackedLevel = 3;
/// Initial stiffness relative to the final one: the surface moves almost rigidly at first.
constexpr double kStiffStart = 1000;
/// A level ends when the nodes move by at most this fraction of their spacing (rms), or after
/// kMaxStepsOfLevel steps.
constexpr double kLevelSettled = 0.02;
constexpr int kMaxStepsOfLevel = 4;
/// The same for the last level. Smaller motions are due to changing pixels, not to the surface.
constexpr double kSettled = 1e-3;

/// Limits of the correspondences of one iteration.
struct Gate {
  double distance;    ///< [mm]
  double min_cosine;  ///< of the angle between the normals
};

struct Association {
  VertexSight sight = VertexSight::outside;
  int pixel = -1;
  MeasuredPlane plane;
  PlanePair pair;
};

Association associate(const MeasuredSurface& surface, const Eigen::Vector3d& vertex,
                      const Eigen::Vector3d& normal, const Gate& gate, int pixel_before = -1) {
  Association found;
  const int pixel = surface.pixel_of(vertex, pixel_before);
  if (pixel < 0) return found;
  if (normal.dot(vertex) >= 0) {
    found.sight = VertexSight::turned_away;
    return found;
  }
  found.plane = surface.at(pixel);
  if (std::isnan(found.plane.point.z())) {
    found.sight = VertexSight::hole;
    return found;
  }
  const bool has_normal = !std::isnan(found.plane.normal.x());
  const double distance = has_normal ? found.plane.normal.dot(vertex - found.plane.point)
                                     : found.plane.point.z() - vertex.z();
  if (std::abs(distance) >= gate.distance) {
    found.sight = distance < 0 ? VertexSight::occluded : VertexSight::unmatched;
  } else if (!has_normal) {
    found.sight = VertexSight::hole;
  } else if (!(found.plane.normal.dot(normal) >= gate.min_cosine)) {
    found.sight = VertexSight::unmatched;
  } else {
    found.sight = VertexSight::seen;
    found.pixel = pixel;
    // Tukey's biweight: the influence of a pair falls to zero at the gate.
    const double fraction = distance / gate.distance;
    const double root = 1 - fraction * fraction;
    found.pair = {found.plane.normal, distance, root * root};
  }
  return found;
}

struct PlacedVertex {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  ///< unit, or NaN if the vertex has none
};

PlacedVertex place(const DeformationGraph& graph, const std::vector<Eigen::Isometry3d>& motions,
                   int vertex) {
  const Eigen::Vector3d rest = graph.mesh().vertices.col(vertex);
  const Eigen::Vector3d rest_normal = graph.normals().col(vertex);
  PlacedVertex placed{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
    const double weight = graph.weights()(k, vertex);
    const Eigen::Isometry3d& motion =
        motions[static_cast<std::size_t>(graph.influences()(k, vertex))];
    placed.position += weight * (motion * rest);
    placed.normal += weight * (motion.linear() * rest_normal);
  }
  placed.normal.normalize();
  return placed;
}

/// About kSamplesPerNode vertices per node that have a normal, evenly but not regularly spaced: a
/// regular selection from a range map would consist of columns.
std::vector<int> choose_samples(const DeformationGraph& graph) {
  const auto count = static_cast<std::size_t>(graph.mesh().vertices.cols());
  const std::size_t wanted = kSamplesPerNode * static_cast<std::size_t>(graph.nodes().cols());
  const double golden = std::numbers::phi - 1;
  const double fraction = static_cast<double>(wanted) / static_cast<double>(count);
  std::vector<int> samples;
  for (std::size_t v = 0; v < count; ++v) {
    // Multiples of the golden section modulo 1 fill [0, 1) evenly.
    const double place = static_cast<double>(v) * golden;
    if (place - std::floor(place) >= fraction) continue;
    if (graph.normals().col(static_cast<Eigen::Index>(v)).allFinite()) {
      samples.push_back(static_cast<int>(v));
    }
  }
  return samples;
}

/// Stiffness and gate of level 0 (stiff, wide) to kLevels - 1.
double between(double start, double end, int level) {
  return start * std::pow(end / start, static_cast<double>(level) / (kLevels - 1));
}

void check_options(const NonRigidOptions& options) {
  require("NonRigidOptions::max_iterations", options.max_iterations, at_least(1));
  require("NonRigidOptions::max_correspondence", options.max_correspondence, above(0).finite(),
          "of the mesh's diagonal");
  require("NonRigidOptions::min_correspondence (at most max_correspondence)",
          options.min_correspondence, above(0).at_most(options.max_correspondence),
          "of the mesh's diagonal");
  require("NonRigidOptions::max_normal_angle", options.max_normal_angle,
          above(0).below(std::numbers::pi / 2), "rad");
  require("NonRigidOptions::stiffness", options.stiffness, above(0).finite());
  require("NonRigidOptions::hold", options.hold, at_least(0).finite());
  require("NonRigidOptions::min_matched", options.min_matched, at_least(0).at_most(1));
}

std::vector<Eigen::Isometry3d> check_start(const DeformationGraph& graph,
                                           std::span<const Eigen::Isometry3d> start) {
  const auto nodes = static_cast<std::size_t>(graph.nodes().cols());
  if (start.empty()) return std::vector(nodes, Eigen::Isometry3d::Identity());
  if (start.size() != nodes) {
    throw InvalidInput("register_deformed: the start has " + std::to_string(start.size()) +
                       " node motions, the graph has " + std::to_string(nodes) +
                       " nodes; pass those of a result of the same graph");
  }
  for (std::size_t i = 0; i < start.size(); ++i) {
    if (!start[i].matrix().allFinite()) {
      throw InvalidInput("register_deformed: motion " + std::to_string(i) +
                         " of the start is not finite; pass those of a result");
    }
  }
  return {start.begin(), start.end()};
}

void check_known(const DeformationGraph& graph, std::span<const KnownVertex> known) {
  for (const KnownVertex& one : known) {
    if (one.vertex < 0 || one.vertex >= graph.mesh().vertices.cols()) {
      throw InvalidInput("register_deformed: vertex " + std::to_string(one.vertex) +
                         " is known, and the surface has " +
                         std::to_string(graph.mesh().vertices.cols()) + " vertices");
    }
    if (!one.place.allFinite()) {
      throw InvalidInput("register_deformed: the known place of vertex " +
                         std::to_string(one.vertex) + " is not finite");
    }
  }
}

void check_intensities(const DeformationGraph& graph, const SeenIntensities& intensities) {
  if (intensities.image.size() > 0 && intensities.vertices.cols() != graph.mesh().vertices.cols()) {
    throw InvalidInput("register_deformed: " + std::to_string(intensities.vertices.cols()) +
                       " vertices have intensities, and the surface has " +
                       std::to_string(graph.mesh().vertices.cols()) + " vertices");
  }
}

/// The samples; the same again for their intensities, if there is an image; and then each known
/// vertex three times: it is attracted to a plane across each axis.
std::vector<int> all_attracted(std::vector<int> samples, bool has_image,
                               std::span<const KnownVertex> known) {
  const std::vector<int> seen = samples;
  if (has_image) samples.insert(samples.end(), seen.begin(), seen.end());
  for (const KnownVertex& one : known) samples.insert(samples.end(), 3, one.vertex);
  return samples;
}

class Fit {
 public:
  Fit(const DeformationGraph& graph, const RangeMap& map, const NonRigidOptions& options,
      std::vector<Eigen::Isometry3d> start, std::span<const KnownVertex> known,
      const SeenIntensities& intensities)
      : graph_(graph),
        options_(options),
        steps_(options.progress, options.max_iterations + 1),
        diagonal_(bounding_diagonal(graph.mesh())),
        pixel_width_(1 / map.camera.fx),
        surface_(map),
        known_(known),
        samples_(choose_samples(graph)),
        intensities_(intensities.vertices),
        equations_(graph, all_attracted(samples_, intensities.image.size() > 0, known),
                   samples_.size()) {
    if (intensities.image.size() > 0) images_.emplace(map.camera, intensities.image);
    result_.node_motions = std::move(start);
  }

  DeformedSurface run(bool is_tracked) {
    if (is_tracked && may_grow()) scale_ = equations_.scale_of(result_.node_motions);
    iterate(is_tracked);
    look_at_all_vertices();
    state_deviations();
    steps_.end();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Gate gate(int level) const {
    return {diagonal_ * between(options_.max_correspondence, options_.min_correspondence, level),
            std::cos(options_.max_normal_angle)};
  }

  /// A surface that is held does not grow or shrink as a whole.
  [[nodiscard]] bool may_grow() const { return options_.hold == 0; }

  void iterate(bool is_tracked) {
    int level = is_tracked ? kFirstTrackedLevel : 0;
    int steps_of_level = 0;
    std::vector<PlanePair> pairs(equations_.samples().size());
    std::vector<int> pixels(samples_.size(), -1);
    Eigen::Matrix3Xd anchors = places_of_nodes();
    while (result_.iterations < options_.max_iterations) {
      if (draw(level, pixels, pairs) < kMinPairs) {
        result_.stop = NonRigidStop::no_overlap;
        return;
      }
      // A tracked surface is already deformed, and a higher stiffness would undo this.
      const double stiffness =
          options_.stiffness * (is_tracked ? 1 : between(kStiffStart, 1, level));
      const double move =
          equations_.step(pairs, stiffness, anchors, options_.hold,
                          may_grow() && level >= kFirstTrackedLevel, scale_, result_.node_motions);
      ++result_.iterations;
      steps_.tell();
      ++steps_of_level;
      if (level + 1 < kLevels) {
        if (move <= kLevelSettled * graph_.spacing() || steps_of_level >= kMaxStepsOfLevel) {
          ++level;
          steps_of_level = 0;
          // Reset the anchors at each level, so that they slow the surface down but do not hold it
          // back.
          anchors = places_of_nodes();
          // Release the pixels that were kept during this level, because they lag behind.
          std::ranges::fill(pixels, -1);
        }
      } else if (move <= kSettled * graph_.spacing()) {
        result_.stop = NonRigidStop::converged;
        return;
      }
    }
  }

  [[nodiscard]] Eigen::Matrix3Xd places_of_nodes() const {
    Eigen::Matrix3Xd places = graph_.nodes();
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      places.col(i) = result_.node_motions[static_cast<std::size_t>(i)] * places.col(i);
    }
    return places;
  }

  /// Pairs the samples with the map; returns how many found a plane. Keeps each sample's pixel if
  /// possible, because noise that changes from pixel to pixel prevents convergence.
  long draw(int level, std::vector<int>& pixels, std::vector<PlanePair>& pairs) const {
    const Gate limit = gate(level);
    std::vector<IntensitySample> places(samples_.size());
    parallel_for(samples_.size(), [&](std::size_t s) {
      const PlacedVertex placed = place(graph_, result_.node_motions, samples_[s]);
      const Association found =
          associate(surface_, placed.position, placed.normal, limit, pixels[s]);
      pixels[s] = found.pixel;
      pairs[s] = found.pair;
      if (found.plane.at_border) pairs[s].weight = 0;
      places[s] = {samples_[s], placed.position, found.pair.distance, pairs[s].weight > 0};
    });
    const auto found = std::ranges::count_if(std::span(pairs).first(samples_.size()),
                                             [](const PlanePair& pair) { return pair.weight > 0; });
    std::size_t end = samples_.size();
    if (images_) {
      std::ranges::copy(attract_intensities(level, places),
                        pairs.begin() + static_cast<std::ptrdiff_t>(end));
      end += samples_.size();
    }
    attract_known(std::span(pairs).subspan(end));
    return found;
  }

  [[nodiscard]] std::vector<PlanePair> attract_intensities(
      int level, std::span<const IntensitySample> places) const {
    const int blur = std::max(kIntensityBlurs - kLevels + level, 0);
    return intensity_pairs(graph_, *images_, intensities_, blur, places);
  }

  /// \param pairs three for each known vertex
  void attract_known(std::span<PlanePair> pairs) const {
    const double weight =
        kKnown * static_cast<double>(samples_.size()) / static_cast<double>(graph_.nodes().cols());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const KnownVertex& one = known_[i / 3];
      const auto axis = static_cast<Eigen::Index>(i % 3);
      const Eigen::Vector3d off =
          place(graph_, result_.node_motions, one.vertex).position - one.place;
      pairs[i] = {Eigen::Vector3d::Unit(axis), off[axis], weight};
    }
  }

  void state_deviations() {
    FittedGraph fitted{
        .motions = result_.node_motions,
        .scale = scale_,
        .scale_is_free = may_grow(),
        .stiffness = options_.stiffness,
        .least_noise = kLeastDepthNoise * pixel_width_ * places_of_nodes().colwise().norm().mean(),
        .reach = options_.max_correspondence * diagonal_,
        .pairs = std::vector<PlanePair>(equations_.samples().size()),
        .planes = samples_.size(),
        .measured = samples_.size() * (images_ ? 2 : 1)};
    std::vector<int> pixels(samples_.size(), -1);
    draw(kLevels - 1, pixels, fitted.pairs);
    if (images_) {
      for (const int vertex : samples_) {
        fitted.pixels.push_back(
            images_->pixel_of(place(graph_, result_.node_motions, vertex).position));
      }
    }
    VertexDeviations deviations = vertex_deviations(graph_, equations_, fitted);
    result_.sigma_across = std::move(deviations.across);
    result_.sigma_along = std::move(deviations.along);
  }

  void look_at_all_vertices() {
    const Eigen::Index count = graph_.mesh().vertices.cols();
    result_.vertices.resize(3, count);
    result_.measured.setConstant(3, count, kNan);
    result_.distance.setConstant(count, kNan);
    result_.sight.resize(static_cast<std::size_t>(count));
    result_.pixel.resize(static_cast<std::size_t>(count));
    const Gate last = gate(kLevels - 1);
    parallel_for(static_cast<int>(count), [&](int v) {
      const PlacedVertex placed = place(graph_, result_.node_motions, v);
      const Association found = associate(surface_, placed.position, placed.normal, last);
      result_.vertices.col(v) = placed.position;
      result_.sight[static_cast<std::size_t>(v)] = found.sight;
      result_.pixel[static_cast<std::size_t>(v)] = found.pixel;
      if (found.sight != VertexSight::seen) return;
      result_.distance[v] = found.pair.distance;
      // Move along the ray until the point is on the plane.
      const double per_depth = found.plane.normal.dot(placed.position);
      result_.measured.col(v) = placed.position * (1 - found.pair.distance / per_depth);
    });
    const auto with = [&](VertexSight sight) {
      return static_cast<double>(std::ranges::count(result_.sight, sight));
    };
    const double seen = with(VertexSight::seen);
    const double measured = seen + with(VertexSight::occluded) + with(VertexSight::unmatched);
    const auto is_seen = result_.distance.array().isFinite();
    result_.rms = std::sqrt(is_seen.select(result_.distance, 0).squaredNorm() / seen);
    result_.matched = measured > 0 ? seen / measured : 0;
    if (result_.stop == NonRigidStop::converged && result_.matched < options_.min_matched) {
      result_.stop = NonRigidStop::poor_match;
    }
  }

  const DeformationGraph& graph_;
  const NonRigidOptions& options_;
  WorkSteps steps_;
  double diagonal_;     ///< [mm]
  double pixel_width_;  ///< relative to the depth
  MeasuredSurface surface_;
  std::span<const KnownVertex> known_;
  std::vector<int> samples_;
  const VertexIntensities& intensities_;
  std::optional<BlurredImages> images_;  // with an image only
  DeformationEquations equations_;       // of `all_attracted`
  double scale_ = 1;                     // of the links at rest
  DeformedSurface result_;
};

}  // namespace

DeformedSurface register_deformed(const DeformationGraph& graph, const RangeMap& map,
                                  const NonRigidOptions& options,
                                  std::span<const Eigen::Isometry3d> start,
                                  std::span<const KnownVertex> known,
                                  const SeenIntensities& intensities) {
  check_options(options);
  check_known(graph, known);
  check_intensities(graph, intensities);
  Fit fit(graph, map, options, check_start(graph, start), known, intensities);
  return fit.run(!start.empty());
}

}  // namespace palpate::geometry
