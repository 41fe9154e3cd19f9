// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/deformation_equations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "base/rigid_motion.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"

// The unknowns of a node are its rotation about its own position, times the spacing of the nodes,
// and its translation. All six are lengths, so the matrix does not depend on the unit of length.

namespace palpate::geometry {
namespace {

constexpr int kUnknowns = 6;
constexpr int kPairs = DeformationGraph::kInfluences * (DeformationGraph::kInfluences - 1) / 2;

/// The sums are always computed in this many parts and added in order, whatever the number of
/// threads.
constexpr std::size_t kParts = 8;

/// Each node is held at its anchor by this fraction of the stiffness, so that parts that neither
/// data nor neighbours determine (a sheet that slides in itself, a piece that is not seen) stay.
constexpr double kAnchor = 0.005;

/// Growth of the whole surface costs this fraction of the cost of stretching each link. With less,
/// smooth surfaces shrink where nothing shows their size, because nodes can follow a smaller
/// surface more closely.
constexpr double kScale = 0.05;

/// A surface that grows or shrinks more than by this factor is not followed.
constexpr double kMostScale = 2;

/// Damping of a step relative to the weight of the data. It makes the equations solvable: nothing
/// else determines the rotation of an isolated node that is not seen.
constexpr double kDamping = 1e-5;

}  // namespace

DeformationEquations::DeformationEquations(const DeformationGraph& graph, std::vector<int> samples,
                                           std::size_t unit)
    : graph_(graph),
      samples_(std::move(samples)),
      scale_(static_cast<double>(graph.nodes().cols()) / static_cast<double>(unit)) {
  const Eigen::Matrix2Xi& edges = graph.edges();
  const auto nodes = static_cast<std::size_t>(graph.nodes().cols());
  first_edge_.assign(nodes + 1, 0);
  for (const int a : edges.row(0)) ++first_edge_[static_cast<std::size_t>(a) + 1];
  std::partial_sum(first_edge_.begin(), first_edge_.end(), first_edge_.begin());

  const auto edge_of = [&](int a, int b) {
    const auto first = first_edge_[static_cast<std::size_t>(a)];
    const auto end = first_edge_[static_cast<std::size_t>(a) + 1];
    for (int e = first; e < end; ++e) {
      if (edges(1, e) == b) return e;
    }
    return -1;  // one of the two nodes has no weight
  };
  pair_blocks_.reserve(samples_.size() * kPairs);
  for (const int v : samples_) {
    for (int i = 0; i < DeformationGraph::kInfluences; ++i) {
      for (int j = i + 1; j < DeformationGraph::kInfluences; ++j) {
        const int edge = edge_of(graph.influences()(i, v), graph.influences()(j, v));
        pair_blocks_.push_back(edge < 0 ? -1 : static_cast<int>(nodes) + edge);
      }
    }
  }

  std::vector<Eigen::Triplet<double>> pattern;
  const auto add_block = [&](int row, int col) {
    for (int c = 0; c < kUnknowns; ++c) {
      for (int r = row == col ? c : 0; r < kUnknowns; ++r) {
        pattern.emplace_back(kUnknowns * row + r, kUnknowns * col + c, 1.0);
      }
    }
  };
  for (int a = 0; a < static_cast<int>(nodes); ++a) add_block(a, a);
  for (const auto& edge : edges.colwise()) add_block(edge[1], edge[0]);
  const auto size = static_cast<Eigen::Index>(kUnknowns * nodes);
  matrix_.resize(size, size);
  matrix_.setFromTriplets(pattern.begin(), pattern.end());
  solver_.analyzePattern(matrix_);
}

/// Derivative of the distance of a vertex along a normal by the unknowns of one of its nodes.
DeformationEquations::Vector6d DeformationEquations::derivative(
    int vertex, int influence, const Eigen::Vector3d& normal,
    const std::vector<Eigen::Isometry3d>& motions) const {
  const int node = graph_.influences()(influence, vertex);
  // Noise of a vertex is also in its distance. In both, it would turn the surroundings.
  const Eigen::Vector3d arm = motions[static_cast<std::size_t>(node)].linear() *
                              (graph_.smooth_vertices().col(vertex) - graph_.nodes().col(node));
  Vector6d row;
  row << arm.cross(normal) / graph_.spacing(), normal;
  return graph_.weights()(influence, vertex) * row;
}

DeformationEquations::Sums DeformationEquations::sum_of_planes(
    std::span<const PlanePair> pairs, const std::vector<Eigen::Isometry3d>& motions) const {
  const auto nodes = static_cast<std::size_t>(graph_.nodes().cols());
  const std::size_t block_count = nodes + static_cast<std::size_t>(graph_.edges().cols());
  std::vector<Sums> parts(kParts);
  parallel_for(kParts, [&](std::size_t part) {
    Sums& sums = parts[part];
    sums.blocks.assign(block_count, Matrix6d::Zero());
    sums.gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kUnknowns * nodes));
    for (std::size_t s = part * pairs.size() / kParts; s < (part + 1) * pairs.size() / kParts;
         ++s) {
      const PlanePair& pair = pairs[s];
      if (!(pair.weight > 0)) continue;
      const int v = samples_[s];
      // Derivative of the distance with respect to the unknowns of each node.
      std::array<Vector6d, DeformationGraph::kInfluences> row;
      for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
        row[static_cast<std::size_t>(k)] = derivative(v, k, pair.normal, motions);
      }
      const int* block = &pair_blocks_[s * kPairs];
      for (int i = 0; i < DeformationGraph::kInfluences; ++i) {
        const Vector6d weighted = pair.weight * row[static_cast<std::size_t>(i)];
        const auto node = static_cast<std::size_t>(graph_.influences()(i, v));
        sums.blocks[node].noalias() += weighted * row[static_cast<std::size_t>(i)].transpose();
        sums.gradient.segment<kUnknowns>(static_cast<Eigen::Index>(kUnknowns * node)) +=
            pair.distance * weighted;
        for (int j = i + 1; j < DeformationGraph::kInfluences; ++j) {
          const int at = *block++;
          if (at < 0) continue;
          sums.blocks[static_cast<std::size_t>(at)].noalias() +=
              row[static_cast<std::size_t>(j)] * weighted.transpose();
        }
      }
    }
  });
  Sums total = std::move(parts[0]);
  for (std::size_t part = 1; part < kParts; ++part) {
    for (std::size_t b = 0; b < block_count; ++b) total.blocks[b] += parts[part].blocks[b];
    total.gradient += parts[part].gradient;
  }
  for (Matrix6d& block : total.blocks) block *= scale_;
  total.gradient *= scale_;
  return total;
}

/// |s l_jk R_j (g_k - g_j) - (g'_k - g'_j)|^2 for both directions of each edge.
/// \param links s l_jk (g_k - g_j), see `rest_links`
void DeformationEquations::add_stiffness(double stiffness, const Eigen::Matrix3Xd& links,
                                         const std::vector<Eigen::Isometry3d>& motions,
                                         Sums& sums) const {
  const auto nodes = static_cast<std::size_t>(graph_.nodes().cols());
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  for (Eigen::Index e = 0; e < graph_.edges().cols(); ++e) {
    const int low = graph_.edges()(0, e);
    const int high = graph_.edges()(1, e);
    Matrix6d& coupling = sums.blocks[nodes + static_cast<std::size_t>(e)];
    for (const auto& [j, k] : {std::pair(low, high), std::pair(high, low)}) {
      const Eigen::Isometry3d& motion = motions[static_cast<std::size_t>(j)];
      const Eigen::Vector3d g_j = motion * graph_.nodes().col(j);
      const Eigen::Vector3d g_k = motions[static_cast<std::size_t>(k)] * graph_.nodes().col(k);
      const Eigen::Vector3d arm = (j == low ? 1.0 : -1.0) * (motion.linear() * links.col(e));
      const Eigen::Vector3d error = arm - (g_k - g_j);
      Eigen::Matrix<double, 3, kUnknowns> of_j;
      of_j << -cross_matrix(arm) / graph_.spacing(), identity;
      sums.blocks[static_cast<std::size_t>(j)] += stiffness * of_j.transpose() * of_j;
      sums.blocks[static_cast<std::size_t>(k)].bottomRightCorner<3, 3>() += stiffness * identity;
      // The derivative with respect to the translation of k is -I.
      if (j == low) {
        coupling.bottomRows<3>() -= stiffness * of_j;
      } else {
        coupling.rightCols<3>() -= stiffness * of_j.transpose();
      }
      sums.gradient.segment<kUnknowns>(kUnknowns * j) += stiffness * of_j.transpose() * error;
      sums.gradient.segment<3>(kUnknowns * k + 3) -= stiffness * error;
    }
  }
}

/// Both directions of an edge together cost 2 |s l_jk (R_j + R_k)/2 (g_k - g_j) - (g'_k - g'_j)|^2,
/// which is stretch, and bending. The scale follows from the stretch alone: bending costs less on a
/// smaller surface.
void DeformationEquations::add_stretch(double stiffness, double scale,
                                       const Eigen::Matrix3Xd& links,
                                       const std::vector<Eigen::Isometry3d>& motions,
                                       Sums& sums) const {
  sums.of_scale_and_nodes.setZero(kUnknowns * graph_.nodes().cols());
  for (Eigen::Index e = 0; e < graph_.edges().cols(); ++e) {
    const int low = graph_.edges()(0, e);
    const int high = graph_.edges()(1, e);
    const Eigen::Isometry3d& of_low = motions[static_cast<std::size_t>(low)];
    const Eigen::Isometry3d& of_high = motions[static_cast<std::size_t>(high)];
    const Eigen::Vector3d chord =
        of_high * graph_.nodes().col(high) - of_low * graph_.nodes().col(low);
    const Eigen::Vector3d arm = (of_low.linear() + of_high.linear()) * links.col(e) / 2;
    // Turning does not lengthen an arm.
    const Eigen::Vector3d per_scale = 2 * stiffness * arm / scale;
    sums.of_scale += per_scale.dot(arm - chord);
    sums.of_scale_twice += per_scale.dot(arm) / scale;
    sums.of_scale_and_nodes.segment<3>(kUnknowns * low + 3) += per_scale;
    sums.of_scale_and_nodes.segment<3>(kUnknowns * high + 3) -= per_scale;
  }
  sums.of_scale += kScale * sums.of_scale_twice * (scale - 1);
}

void DeformationEquations::add_anchors(double weight, const Eigen::Matrix3Xd& anchors,
                                       const std::vector<Eigen::Isometry3d>& motions,
                                       Sums& sums) const {
  for (Eigen::Index node = 0; node < anchors.cols(); ++node) {
    const auto i = static_cast<std::size_t>(node);
    sums.blocks[i].bottomRightCorner<3, 3>().diagonal().array() += weight;
    sums.gradient.segment<3>(kUnknowns * node + 3) +=
        weight * (motions[i] * graph_.nodes().col(node) - anchors.col(node));
  }
}

/// The columns of a node hold its diagonal block and those of its edges to higher nodes, ascending.
void DeformationEquations::fill_matrix(const Sums& sums, double damping) {
  const auto nodes = static_cast<std::size_t>(graph_.nodes().cols());
  double* value = matrix_.valuePtr();
  for (std::size_t a = 0; a < nodes; ++a) {
    for (int c = 0; c < kUnknowns; ++c) {
      for (int r = c; r < kUnknowns; ++r) {
        *value++ = sums.blocks[a](r, c) + (r == c ? damping : 0);
      }
      for (int e = first_edge_[a]; e < first_edge_[a + 1]; ++e) {
        const Matrix6d& block = sums.blocks[nodes + static_cast<std::size_t>(e)];
        value = std::copy_n(block.col(c).data(), kUnknowns, value);
      }
    }
  }
}

double DeformationEquations::scale_of(const std::vector<Eigen::Isometry3d>& motions) const {
  Sums sums;
  add_stretch(1, 1, rest_links(graph_, motions, 1), motions, sums);
  if (!(sums.of_scale_twice > 0)) return 1;
  return std::clamp(1 - sums.of_scale / ((1 + kScale) * sums.of_scale_twice), 1 / kMostScale,
                    kMostScale);
}

/// The second derivative with respect to the scale if the nodes follow it: at least that of the
/// term that holds the scale. A strongly bent surface that nothing attracts has less.
double DeformationEquations::left_of_scale(const Sums& sums,
                                           const Eigen::VectorXd& moves_per_scale) const {
  const double held = kScale * sums.of_scale_twice;
  return std::max(held + sums.of_scale_twice - sums.of_scale_and_nodes.dot(moves_per_scale), held);
}

double DeformationEquations::step(std::span<const PlanePair> pairs, double stiffness,
                                  const Eigen::Matrix3Xd& anchors, double hold, bool scale_is_free,
                                  double& scale, std::vector<Eigen::Isometry3d>& motions) {
  Sums sums = sum_of_planes(pairs, motions);
  const Eigen::Matrix3Xd links = rest_links(graph_, motions, scale);
  add_stiffness(stiffness, links, motions, sums);
  add_anchors(kAnchor * stiffness, anchors, motions, sums);
  if (hold > 0) add_anchors(hold, graph_.nodes(), motions, sums);
  fill_matrix(sums, kDamping);
  solver_.factorize(matrix_);
  Eigen::VectorXd moves = solver_.solve(-sums.gradient);
  if (scale_is_free) {
    add_stretch(stiffness, scale, links, motions, sums);
    const Eigen::VectorXd per_scale = solver_.solve(sums.of_scale_and_nodes);
    const double left = left_of_scale(sums, per_scale);
    if (left > 0) {
      const double change = -(sums.of_scale + sums.of_scale_and_nodes.dot(moves)) / left;
      const double changed = std::clamp(scale + change, 1 / kMostScale, kMostScale);
      moves -= (changed - scale) * per_scale;
      scale = changed;
    }
  }
  if (solver_.info() != Eigen::Success || !moves.allFinite()) {
    throw SolverError(
        "register_deformed: the equations of a step cannot be solved; raise the "
        "stiffness");
  }
  double sum_of_squares = 0;
  for (Eigen::Index node = 0; node < graph_.nodes().cols(); ++node) {
    const Eigen::Vector3d turn = moves.segment<3>(kUnknowns * node) / graph_.spacing();
    const Eigen::Vector3d shift = moves.segment<3>(kUnknowns * node + 3);
    Eigen::Isometry3d& motion = motions[static_cast<std::size_t>(node)];
    const Eigen::Vector3d place = motion * graph_.nodes().col(node);
    const double angle = turn.norm();
    if (angle > 0) {
      const Eigen::Quaterniond turned =
          Eigen::AngleAxisd(angle, turn / angle) * Eigen::Quaterniond(motion.linear());
      motion.linear() = turned.normalized().toRotationMatrix();
    }
    motion.translation() = place + shift - motion.linear() * graph_.nodes().col(node);
    sum_of_squares += shift.squaredNorm() + std::pow(angle * graph_.spacing(), 2);
  }
  return std::sqrt(sum_of_squares / static_cast<double>(graph_.nodes().cols()));
}

bool DeformationEquations::linearize(std::span<const PlanePair> pairs, double stiffness,
                                     double damping, bool scale_is_free, double scale,
                                     const std::vector<Eigen::Isometry3d>& motions) {
  Sums sums = sum_of_planes(pairs, motions);
  const Eigen::Matrix3Xd links = rest_links(graph_, motions, scale);
  add_stiffness(stiffness, links, motions, sums);
  fill_matrix(sums, damping);
  solver_.factorize(matrix_);
  at_ = {.motions = motions,
         .arms = Eigen::Matrix3Xd(3, links.cols()),
         .stiffness = stiffness,
         .damping = damping,
         .scale = scale,
         .of_scale_and_nodes = {},
         .moves_per_scale = {}};
  for (Eigen::Index e = 0; e < links.cols(); ++e) {
    at_.arms.col(e) = (motions[static_cast<std::size_t>(graph_.edges()(0, e))].linear() +
                       motions[static_cast<std::size_t>(graph_.edges()(1, e))].linear()) *
                      links.col(e) / 2;
  }
  if (solver_.info() != Eigen::Success) return false;
  if (!scale_is_free) return true;
  add_stretch(stiffness, scale, links, motions, sums);
  at_.moves_per_scale = solver_.solve(sums.of_scale_and_nodes);
  at_.scale_held = kScale * sums.of_scale_twice;
  at_.scale_left = left_of_scale(sums, at_.moves_per_scale);
  at_.of_scale_and_nodes = std::move(sums.of_scale_and_nodes);
  return true;
}

/// \param force on the nodes
/// \param of_scale derivative of half the energy with respect to the scale
DeformationEquations::Response DeformationEquations::solved(const Eigen::VectorXd& force,
                                                            double of_scale) const {
  Response response{solver_.solve(force), 0};
  if (at_.scale_left > 0) {
    response.scale = -(of_scale + at_.of_scale_and_nodes.dot(response.moves)) / at_.scale_left;
    response.moves -= response.scale * at_.moves_per_scale;
  }
  return response;
}

DeformationEquations::Response DeformationEquations::response_to_distances(
    std::span<const PlanePair> pairs, std::span<const double> errors) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(matrix_.rows());
  for (std::size_t s = 0; s < errors.size(); ++s) {
    const PlanePair& pair = pairs[s];
    if (!(pair.weight > 0)) continue;
    for (int k = 0; k < DeformationGraph::kInfluences; ++k) {
      const int node = graph_.influences()(k, samples_[s]);
      force.segment<kUnknowns>(kUnknowns * node) -=
          scale_ * pair.weight * errors[s] * derivative(samples_[s], k, pair.normal, at_.motions);
    }
  }
  return solved(force, 0);
}

DeformationEquations::Response DeformationEquations::response_to_links(
    const Eigen::VectorXd& stretch) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(matrix_.rows());
  double of_scale = 0;
  for (Eigen::Index e = 0; e < stretch.size(); ++e) {
    // Each link has a term at both of its ends, see `add_stretch`.
    const Eigen::Vector3d pull = 2 * at_.stiffness * stretch[e] * at_.arms.col(e);
    force.segment<3>(kUnknowns * graph_.edges()(0, e) + 3) -= pull;
    force.segment<3>(kUnknowns * graph_.edges()(1, e) + 3) += pull;
    of_scale += pull.dot(at_.arms.col(e)) / at_.scale;
  }
  return solved(force, of_scale);
}

DeformationEquations::Response DeformationEquations::response_to_moves(
    const Eigen::VectorXd& moves) const {
  return solved(at_.damping * moves, 0);
}

DeformationEquations::Response DeformationEquations::response_to_scale() const {
  const Eigen::VectorXd no_force = Eigen::VectorXd::Zero(matrix_.rows());
  if (!(at_.scale_left > at_.scale_held)) return {no_force, 0};
  // The scale that was found is pulled, too: by scale_held / scale_left of its distance from 1.
  const double free = 1 + (at_.scale - 1) / (1 - at_.scale_held / at_.scale_left);
  return solved(no_force, -at_.scale_held * (std::clamp(free, 1 / kMostScale, kMostScale) - 1));
}

}  // namespace palpate::geometry
