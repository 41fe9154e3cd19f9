// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/slippage.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/rigid_motion.h"
#include "palpate/core/parallel_for.h"

// A motion is a rotation about a centre, times the spacing of the nodes, and a translation.

namespace palpate::geometry {
namespace {

using Vector6d = Eigen::Vector<double, 6>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Radius of a patch in spacings of the nodes: the surface deforms little over it.
constexpr double kPatch = 3;

/// Of the mean of the motions that a patch is asked about. Makes those solvable that nothing shows.
constexpr double kRounding = 1e-9;

/// Sums over the samples of a node or a patch, for motions about one centre.
struct Moments {
  Matrix6d planes = Matrix6d::Zero();   ///< changes of the distances, squared
  Matrix6d surface = Matrix6d::Zero();  ///< the same without the noise of the planes
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();

  Moments& operator+=(const Moments& other) {
    planes += other.planes;
    surface += other.surface;
    normal += other.normal;
    return *this;
  }
};

/// Change of the distance of a point along `normal` for each part of a motion about the origin.
Vector6d change(const Eigen::Vector3d& place, const Eigen::Vector3d& normal, double spacing) {
  Vector6d row;
  row << place.cross(normal) / spacing, normal;
  return row;
}

/// For each node, about `origin`. All samples together weigh as much as there are nodes.
std::vector<Moments> moments_of_nodes(const DeformationGraph& graph,
                                      std::span<const SeenSample> samples,
                                      const Eigen::Vector3d& origin) {
  const auto nodes = static_cast<std::size_t>(graph.nodes().cols());
  const double scale = static_cast<double>(nodes) / static_cast<double>(samples.size());
  std::vector<Moments> moments(nodes);
  for (const SeenSample& sample : samples) {
    if (!(sample.pair.weight > 0)) continue;
    Eigen::Index nearest = 0;
    graph.weights().col(sample.vertex).maxCoeff(&nearest);
    Moments& sum = moments[static_cast<std::size_t>(graph.influences()(nearest, sample.vertex))];
    const double weight = scale * sample.pair.weight;
    const Eigen::Vector3d arm = sample.place - origin;
    const Vector6d plane = change(arm, sample.pair.normal, graph.spacing());
    const Vector6d surface = change(arm, sample.normal, graph.spacing());
    sum.planes += weight * plane * plane.transpose();
    const Matrix6d both = weight * plane * surface.transpose();
    sum.surface += (both + both.transpose()) / 2;
    sum.normal += weight * sample.normal;
    const Vector6d intensity = change(arm, sample.intensity.normal, graph.spacing());
    const Matrix6d squared = scale * sample.intensity.weight * intensity * intensity.transpose();
    sum.planes += squared;
    sum.surface += squared;
  }
  return moments;
}

/// The nodes that each node has a link with.
std::vector<std::vector<int>> links_of(const DeformationGraph& graph) {
  std::vector<std::vector<int>> links(static_cast<std::size_t>(graph.nodes().cols()));
  for (const auto& edge : graph.edges().colwise()) {
    links[static_cast<std::size_t>(edge[0])].push_back(edge[1]);
    links[static_cast<std::size_t>(edge[1])].push_back(edge[0]);
  }
  return links;
}

/// The nodes around one that are connected with it within the radius of a patch.
std::vector<int> patch_around(const DeformationGraph& graph,
                              const std::vector<std::vector<int>>& links, int centre) {
  const double radius = kPatch * graph.spacing();
  std::vector<int> patch = {centre};
  for (std::size_t i = 0; i < patch.size(); ++i) {
    for (const int next : links[static_cast<std::size_t>(patch[i])]) {
      const double distance = (graph.nodes().col(next) - graph.nodes().col(centre)).norm();
      if (distance <= radius && std::ranges::find(patch, next) == patch.end())
        patch.push_back(next);
    }
  }
  return patch;
}

/// \param arm from the origin of the moments to the centre of the motions [mm]
/// \param held by the links of the patch, as a weight
double determined(Moments sums, const Eigen::Vector3d& arm, double spacing, double held) {
  if (!(sums.normal.squaredNorm() > 0)) return 0;
  // Coordinates of a motion: two along the surface, one along the normal, a rotation about the
  // centre.
  const Eigen::Vector3d normal = sums.normal.normalized();
  const Eigen::Vector3d first = normal.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << first, normal.cross(first), normal;
  Matrix6d to_centre = Matrix6d::Zero();
  to_centre.topRightCorner<3, 3>() = axes.transpose();
  to_centre.bottomLeftCorner<3, 3>().setIdentity();
  to_centre.bottomRightCorner<3, 3>() = -cross_matrix(arm) / spacing;
  const Matrix6d planes = to_centre * sums.planes * to_centre.transpose();
  // What goes best with each translation along the surface.
  Eigen::Matrix4d rest = planes.bottomRightCorner<4, 4>();
  rest.diagonal().array() += kRounding * rest.trace();
  Eigen::Matrix<double, 6, 2> slides;
  slides << Eigen::Matrix2d::Identity(), -rest.ldlt().solve(planes.bottomLeftCorner<4, 2>());
  const Eigen::Matrix2d seen =
      slides.transpose() * (to_centre * sums.surface * to_centre.transpose()) * slides;
  const Eigen::Matrix2d all = slides.transpose() * planes * slides +
                              (held + kRounding * planes.trace()) * Eigen::Matrix2d::Identity();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> share(
      seen, all, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  const double least = share.eigenvalues()[0];
  return least > 0 ? std::min(least, 1.0) : 0;
}

}  // namespace

Eigen::VectorXd determined_along(const DeformationGraph& graph, const Eigen::Matrix3Xd& places,
                                 std::span<const SeenSample> samples, double stiffness) {
  const Eigen::Vector3d origin = places.rowwise().mean();
  const std::vector<Moments> moments = moments_of_nodes(graph, samples, origin);
  const std::vector<std::vector<int>> links = links_of(graph);
  Eigen::VectorXd of_nodes(graph.nodes().cols());
  parallel_for(static_cast<int>(graph.nodes().cols()), [&](int node) {
    const std::vector<int> patch = patch_around(graph, links, node);
    Moments sums;
    long leaving = 0;
    for (const int member : patch) {
      sums += moments[static_cast<std::size_t>(member)];
      leaving += std::ranges::count_if(links[static_cast<std::size_t>(member)], [&](int next) {
        return std::ranges::find(patch, next) == patch.end();
      });
    }
    // Each link has a term at both of its ends.
    const double held = 2 * stiffness * static_cast<double>(leaving);
    of_nodes[node] = determined(sums, places.col(node) - origin, graph.spacing(), held);
  });
  Eigen::VectorXd along(graph.mesh().vertices.cols());
  for (Eigen::Index v = 0; v < along.size(); ++v) {
    along[v] = graph.weights().col(v).dot(of_nodes(graph.influences().col(v)));
  }
  return along;
}

}  // namespace palpate::geometry
