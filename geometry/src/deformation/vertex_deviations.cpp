// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/vertex_deviations.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>

#include "base/disjoint_sets.h"
#include "base/numbers.h"
#include "deformation/intensity_pairs.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/robust_weights.h"

namespace palpate::geometry {
namespace {

using Response = DeformationEquations::Response;

/// Random errors of each kind. The deviations are right to 1 / sqrt(2 kDraws), 16 %.
constexpr std::size_t kDraws = 20;

/// Waves of a random strain.
constexpr int kWaves = 12;

/// Largest deviation of strain: links that follow any strain would not show it.
constexpr double kMostStrain = 1;

/// Weight of the neighbours of a node in the fit of its normal. With more, less noise is left, but
/// also less relief.
constexpr double kNeighbour = 0.05;

/// The rotation of a node, times the spacing.
Eigen::Vector3d turn_of(const Response& response, int node) {
  return response.moves.segment<3>(6 * node);
}
Eigen::Vector3d shift_of(const Response& response, int node) {
  return response.moves.segment<3>(6 * node + 3);
}

/// The node that moves a vertex most.
int main_node(const DeformationGraph& graph, int vertex) {
  Eigen::Index nearest = 0;
  graph.weights().col(vertex).maxCoeff(&nearest);
  return graph.influences()(nearest, vertex);
}

/// Position of a vertex of the deformed surface, without the noise of single ones.
Eigen::Vector3d place_of(const DeformationGraph& graph,
                         const std::vector<Eigen::Isometry3d>& motions, int vertex) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
    const auto node = static_cast<std::size_t>(graph.influences()(k, vertex));
    place += graph.weights()(k, vertex) * (motions[node] * graph.smooth_vertices().col(vertex));
  }
  return place;
}

/// Weighted sums over places x and normals n.
struct NormalSums {
  double weight = 0;
  Eigen::Vector3d x = Eigen::Vector3d::Zero(), n = Eigen::Vector3d::Zero();
  Eigen::Matrix3d xx = Eigen::Matrix3d::Zero(), nx = Eigen::Matrix3d::Zero();

  void add(const NormalSums& other, double share) {
    weight += share * other.weight;
    x += share * other.x;
    n += share * other.n;
    xx += share * other.xx;
    nx += share * other.nx;
  }
};

/// A normal that is linear in the place, n + slope (x - x_mean), as on a sphere. Fitted to the
/// planes around a node, it has little of the noise of single ones.
struct LinearNormal {
  Eigen::Vector3d x = Eigen::Vector3d::Zero(), n = Eigen::Vector3d::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();

  [[nodiscard]] Eigen::Vector3d at(const Eigen::Vector3d& place) const {
    return n + slope * (place - x);
  }
};

LinearNormal fit_normal(const NormalSums& sums) {
  constexpr double kFlat = 0.05;  // of the largest variance: across the surface there is less
  LinearNormal fit;
  if (!(sums.weight > 0)) return fit;
  fit.x = sums.x / sums.weight;
  fit.n = sums.n / sums.weight;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(sums.xx / sums.weight -
                                                              fit.x * fit.x.transpose());
  const Eigen::Matrix3d together = sums.nx / sums.weight - fit.n * fit.x.transpose();
  const Eigen::Vector3d& variances = spread.eigenvalues();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(variances[axis] > kFlat * variances[2])) continue;
    const Eigen::Vector3d direction = spread.eigenvectors().col(axis);
    fit.slope += together * direction * direction.transpose() / variances[axis];
  }
  return fit;
}

/// The pairs with the normals around the nodes in place of those of single planes.
std::vector<PlanePair> without_noise(const DeformationGraph& graph, std::span<const int> samples,
                                     const FittedGraph& fitted) {
  const Eigen::Vector3d origin = place_of(graph, fitted.motions, 0);
  const auto place = [&](std::size_t s) -> Eigen::Vector3d {
    return place_of(graph, fitted.motions, samples[s]) - origin;
  };
  std::vector<NormalSums> sums(static_cast<std::size_t>(graph.nodes().cols()));
  for (std::size_t s = 0; s < fitted.planes; ++s) {
    const PlanePair& pair = fitted.pairs[s];
    if (!(pair.weight > 0)) continue;
    const Eigen::Vector3d x = place(s);
    sums[static_cast<std::size_t>(main_node(graph, samples[s]))].add(
        {1, x, pair.normal, x * x.transpose(), pair.normal * x.transpose()}, pair.weight);
  }
  std::vector<NormalSums> around = sums;
  for (const auto& edge : graph.edges().colwise()) {
    around[static_cast<std::size_t>(edge[0])].add(sums[static_cast<std::size_t>(edge[1])],
                                                  kNeighbour);
    around[static_cast<std::size_t>(edge[1])].add(sums[static_cast<std::size_t>(edge[0])],
                                                  kNeighbour);
  }
  std::vector<LinearNormal> fits;
  for (const NormalSums& sum : around) fits.push_back(fit_normal(sum));
  std::vector<PlanePair> pairs = fitted.pairs;
  for (std::size_t s = 0; s < fitted.planes; ++s) {
    if (!(pairs[s].weight > 0)) continue;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
      const auto node = static_cast<std::size_t>(graph.influences()(k, samples[s]));
      normal += graph.weights()(k, samples[s]) * fits[node].at(place(s));
    }
    pairs[s].normal = normal.normalized();
  }
  return pairs;
}

/// Deviation of the distances; 0 if there are none.
double noise_of(std::span<const PlanePair> pairs) {
  std::vector<double> distances;
  for (const PlanePair& pair : pairs)
    if (pair.weight > 0) distances.push_back(std::abs(pair.distance));
  return distances.empty() ? 0 : deviation_of_median(quantile(distances, 0.5));
}

/// Deviations of the distances of pairs.
struct Noise {
  double planes = 0;       ///< [mm]
  double intensities = 0;  ///< in the unit of the image
};

/// Nodes in whose surroundings something was measured.
std::vector<char> measured_nodes(const DeformationGraph& graph, std::span<const int> samples,
                                 const FittedGraph& fitted) {
  std::vector<char> measured(static_cast<std::size_t>(graph.nodes().cols()), 0);
  for (std::size_t s = 0; s < fitted.pairs.size(); ++s) {
    if (fitted.pairs[s].weight > 0)
      measured[static_cast<std::size_t>(main_node(graph, samples[s]))] = 1;
  }
  return measured;
}

/// Nodes that are connected with a measured one.
std::vector<char> reached_nodes(const DeformationGraph& graph, const std::vector<char>& measured) {
  SignedSets pieces(static_cast<int>(measured.size()));
  for (const auto& edge : graph.edges().colwise()) pieces.join(edge[0], edge[1], false);
  std::vector<char> of_piece(measured.size(), 0), reached(measured.size(), 0);
  const auto piece = [&](std::size_t node) {
    return static_cast<std::size_t>(pieces.root_of(static_cast<int>(node)).root);
  };
  for (std::size_t n = 0; n < measured.size(); ++n) of_piece[piece(n)] |= measured[n];
  for (std::size_t n = 0; n < measured.size(); ++n) reached[n] = of_piece[piece(n)];
  return reached;
}

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11U) * 0x1p-53; }

double normal(std::mt19937_64& random) {
  const double length = std::sqrt(-2 * std::log(1 - uniform(random)));
  return length * std::cos(2 * std::numbers::pi * uniform(random));
}

/// Random errors of measurements. That of a plane is plus or minus its deviation.
std::vector<double> random_errors(const FittedGraph& fitted, const Noise& noise,
                                  std::mt19937_64& random) {
  std::vector<double> errors(fitted.planes);
  for (double& error : errors) error = (random() & 1U) != 0 ? noise.planes : -noise.planes;
  for (const double error : intensity_noise(fitted.pixels, random))
    errors.push_back(noise.intensities * error);
  return errors;
}

/// Relative change in length of each link in a random field of strain, with a mean square of about
/// 1. All lengths of waves between two spacings and the extent of the nodes are equally frequent.
Eigen::VectorXd random_stretch(const DeformationGraph& graph, std::mt19937_64& random) {
  const Eigen::Matrix3Xd& nodes = graph.nodes();
  const double shortest = 2 * graph.spacing();
  const double longest =
      std::max((nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm(), shortest);
  Eigen::VectorXd stretch = Eigen::VectorXd::Zero(graph.edges().cols());
  for (int wave = 0; wave < kWaves; ++wave) {
    const double length = shortest * std::pow(longest / shortest, uniform(random));
    Eigen::Vector3d number;
    for (double& part : number) part = normal(random);
    number *= 2 * std::numbers::pi / (length * number.norm());
    const double phase = 2 * std::numbers::pi * uniform(random);
    Eigen::Matrix3d strain;
    for (double& part : strain.reshaped()) part = std::sqrt(2.0 / kWaves) * normal(random);
    for (Eigen::Index e = 0; e < stretch.size(); ++e) {
      const Eigen::Vector3d a = nodes.col(graph.edges()(0, e));
      const Eigen::Vector3d b = nodes.col(graph.edges()(1, e));
      const Eigen::Vector3d direction = (b - a).normalized();
      stretch[e] += std::cos(number.dot(a + b) / 2 + phase) * direction.dot(strain * direction);
    }
  }
  return stretch;
}

/// Motions of the whole surface, which are independent: along each axis by `size` [mm], and about
/// each axis by `size` at the ends of the surface.
std::vector<Eigen::VectorXd> rigid_motions(const DeformationGraph& graph,
                                           const std::vector<Eigen::Isometry3d>& motions,
                                           double size) {
  Eigen::Matrix3Xd places = graph.nodes();
  for (Eigen::Index n = 0; n < places.cols(); ++n)
    places.col(n) = motions[static_cast<std::size_t>(n)] * places.col(n);
  places.colwise() -= places.rowwise().mean().eval();
  const double extent = std::max(places.colwise().norm().maxCoeff(), graph.spacing());
  std::vector<Eigen::VectorXd> moves(6, Eigen::VectorXd::Zero(6 * places.cols()));
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis), turn = size / extent * unit;
    for (Eigen::Index n = 0; n < places.cols(); ++n) {
      moves[static_cast<std::size_t>(axis)].segment<3>(6 * n + 3) = size * unit;
      moves[static_cast<std::size_t>(3 + axis)].segment<6>(6 * n) << graph.spacing() * turn,
          turn.cross(places.col(n));
    }
  }
  return moves;
}

/// The links between measured nodes.
class MeasuredLinks {
 public:
  MeasuredLinks(const DeformationGraph& graph, const Eigen::Matrix3Xd& arms,
                const std::vector<char>& measured)
      : graph_(graph), arms_(arms) {
    for (Eigen::Index e = 0; e < arms.cols(); ++e) {
      if (measured[static_cast<std::size_t>(graph.edges()(0, e))] != 0 &&
          measured[static_cast<std::size_t>(graph.edges()(1, e))] != 0)
        links_.push_back(e);
    }
  }

  [[nodiscard]] bool empty() const { return links_.empty(); }

  /// Mean square of the relative stretch of a solution.
  [[nodiscard]] double square_of(const std::vector<Eigen::Isometry3d>& motions) const {
    return mean_square([&](Eigen::Index e, int low, int high) {
      const Eigen::Vector3d chord =
          motions[static_cast<std::size_t>(high)] * graph_.nodes().col(high) -
          motions[static_cast<std::size_t>(low)] * graph_.nodes().col(low);
      return chord.dot(arms_.col(e)) / arms_.col(e).squaredNorm() - 1;
    });
  }

  /// The same of a change of the solution.
  /// \param stretch of the surface itself
  [[nodiscard]] double square_of(const Response& response, double scale,
                                 const Eigen::VectorXd& stretch) const {
    return mean_square([&](Eigen::Index e, int low, int high) {
      const Eigen::Vector3d change = shift_of(response, high) - shift_of(response, low);
      return stretch[e] + change.dot(arms_.col(e)) / arms_.col(e).squaredNorm() -
             response.scale / scale;
    });
  }

 private:
  template <typename Stretch>
  [[nodiscard]] double mean_square(Stretch&& stretch) const {
    double sum = 0;
    for (const Eigen::Index e : links_)
      sum += std::pow(stretch(e, graph_.edges()(0, e), graph_.edges()(1, e)), 2);
    return sum / static_cast<double>(links_.size());
  }

  const DeformationGraph& graph_;
  const Eigen::Matrix3Xd& arms_;
  std::vector<Eigen::Index> links_;
};

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(std::span<const double> values) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const double value : values) sum += std::pow(value - mean, 2);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

/// Changes of the solution. Together, their squares are the variance.
std::vector<Response> changes_of(const DeformationGraph& graph,
                                 const DeformationEquations& equations, const FittedGraph& fitted,
                                 const Noise& noise, const std::vector<char>& measured) {
  const MeasuredLinks links(graph, equations.arms(), measured);
  const Eigen::VectorXd unstretched = Eigen::VectorXd::Zero(graph.edges().cols());
  std::vector<Response> changes(2 * kDraws);
  std::array<double, kDraws> by_noise{}, by_strain{};  // mean squares of the stretch of links
  parallel_for(kDraws, [&](std::size_t draw) {
    std::mt19937_64 random(draw);
    Response& of_noise = changes[draw];
    // With the planes as they are: their noise does not show motions, but passes errors on.
    of_noise = equations.response_to_distances(fitted.pairs, random_errors(fitted, noise, random));
    // Change of a surface that is stretched, which the links at rest are not.
    Response& of_strain = changes[kDraws + draw];
    const Eigen::VectorXd stretch = random_stretch(graph, random);
    of_strain = equations.response_to_links(-stretch);
    if (links.empty()) return;
    by_noise[draw] = links.square_of(of_noise, fitted.scale, unstretched);
    by_strain[draw] = links.square_of(of_strain, fitted.scale, stretch);
  });
  const double shown = mean_of(by_strain);
  double strain = 0;
  if (shown > 0) {
    // Strain that noise may hide counts, too.
    const double seen =
        std::max(links.square_of(fitted.motions) - mean_of(by_noise), 0.0) + deviation_of(by_noise);
    strain = std::min(seen / shown, kMostStrain * kMostStrain);
  }
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    changes[draw].moves /= std::sqrt(kDraws);
    changes[kDraws + draw].moves *= std::sqrt(strain / kDraws);
  }
  for (const Eigen::VectorXd& moves : rigid_motions(graph, fitted.motions, fitted.reach))
    changes.push_back(equations.response_to_moves(moves));
  changes.push_back(equations.response_to_scale());
  return changes;
}

}  // namespace

VertexDeviations vertex_deviations(const DeformationGraph& graph, DeformationEquations& equations,
                                   const FittedGraph& fitted) {
  const std::span<const int> samples = equations.samples();
  const std::span<const PlanePair> measured_pairs = std::span(fitted.pairs).first(fitted.measured);
  const Noise noise{
      .planes = std::max(noise_of(measured_pairs.first(fitted.planes)), fitted.least_noise),
      .intensities = noise_of(measured_pairs.subspan(fitted.planes))};
  // The precision of a motion of the whole surface by `reach`, in the weight of a measurement. Each
  // sample and each node have a share.
  const double ratio = noise.planes / fitted.reach;
  const double damping =
      ratio * ratio / static_cast<double>(std::max<std::size_t>(fitted.planes, 1));
  const std::vector<char> measured = measured_nodes(graph, samples, fitted);
  const std::vector<char> reached = reached_nodes(graph, measured);
  const Eigen::Index count = graph.mesh().vertices.cols();
  VertexDeviations deviations{Eigen::VectorXd::Constant(count, kNan),
                              Eigen::VectorXd::Constant(count, kNan)};
  const bool is_solved =
      equations.linearize(without_noise(graph, samples, fitted), fitted.stiffness, damping,
                          fitted.scale_is_free, fitted.scale, fitted.motions);
  if (!is_solved) return deviations;
  const std::vector<Response> changes = changes_of(graph, equations, fitted, noise, measured);
  parallel_for(static_cast<int>(count), [&](int v) {
    if (reached[static_cast<std::size_t>(main_node(graph, v))] == 0) return;
    const auto nodes = graph.influences().col(v);
    const auto weights = graph.weights().col(v);
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 3, DeformationGraph::kInfluences> arms;
    for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
      const Eigen::Matrix3d turn = fitted.motions[static_cast<std::size_t>(nodes[k])].linear();
      normal += weights[k] * (turn * graph.normals().col(v));
      arms.col(k) = turn * (graph.smooth_vertices().col(v) - graph.nodes().col(nodes[k]));
    }
    normal.normalize();
    double across = 0, along = 0;
    for (const Response& change : changes) {
      Eigen::Vector3d move = Eigen::Vector3d::Zero();
      for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
        const Eigen::Vector3d turn = turn_of(change, nodes[k]) / graph.spacing();
        move += weights[k] * (shift_of(change, nodes[k]) + turn.cross(arms.col(k)));
      }
      const double height = normal.dot(move);
      across += height * height;
      along += (move - height * normal).squaredNorm();
    }
    deviations.across[v] = std::sqrt(across);
    deviations.along[v] = std::sqrt(along);
  });
  return deviations;
}

}  // namespace palpate::geometry
