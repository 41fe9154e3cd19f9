// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/winding_number.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "query/local_frame.h"

namespace palpate::geometry {
namespace {

/// Clusters of at most this number of triangles are not divided.
constexpr std::ptrdiff_t kLeaf = 8;
/// A cluster with a larger bound is opened at once: nothing is learnt from its moments.
constexpr double kOpenAtOnce = 1;
/// A winding number farther away (local frame) is below 1e-60.
constexpr double kFarAway = 1e30;
constexpr double kFullAngle = 4 * std::numbers::pi;
/// Inside is where the winding number exceeds this.
constexpr double kInsideValue = 0.5;

/// Solid angle of a triangle seen from the origin (van Oosterom and Strackee 1983).
double solid_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double na = a.norm(), nb = b.norm(), nc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)),
                        na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
}

}  // namespace

/// The data of a WindingNumber.
namespace winding {

/// A sum over triangles and a bound of its error.
struct Estimate {
  double value = 0;
  double bound = kInfinity;
};

/// Moments of the oriented area of some triangles about their centroid p: integrals of n, n y^T and
/// n y y^T over the area with y = x - p, as far as they are seen in the potential of a dipole.
struct Cluster {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;  ///< of a ball about the centre that has all triangles
  double cubed = 0;   ///< at least the integral of |y|^3
  Eigen::Vector3d zeroth = Eigen::Vector3d::Zero();
  Eigen::Matrix3d first = Eigen::Matrix3d::Zero();
  Eigen::Vector3d traces = Eigen::Vector3d::Zero();  ///< of the second moments
  Eigen::Matrix<double, 10, 1> second = Eigen::Matrix<double, 10, 1>::Zero();  ///< cubic in r
  std::ptrdiff_t begin = 0, end = 0;                                           ///< its triangles
  int left = kNone, right = kNone;  ///< its two parts, unless it is a leaf

  /// Adds n (y y^T) in the order xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz.
  void add_second(const Eigen::Vector3d& n, const Eigen::Matrix3d& m) {
    traces += 2 * m * n + m.trace() * n;
    second[0] += n[0] * m(0, 0);
    second[1] += 2 * n[0] * m(0, 1) + n[1] * m(0, 0);
    second[2] += 2 * n[0] * m(0, 2) + n[2] * m(0, 0);
    second[3] += n[0] * m(1, 1) + 2 * n[1] * m(0, 1);
    second[4] += 2 * (n[0] * m(1, 2) + n[1] * m(0, 2) + n[2] * m(0, 1));
    second[5] += n[0] * m(2, 2) + 2 * n[2] * m(0, 2);
    second[6] += n[1] * m(1, 1);
    second[7] += 2 * n[1] * m(1, 2) + n[2] * m(1, 1);
    second[8] += n[1] * m(2, 2) + 2 * n[2] * m(1, 2);
    second[9] += n[2] * m(2, 2);
  }

  [[nodiscard]] double second_along(const Eigen::Vector3d& r) const {
    const double x = r[0], y = r[1], z = r[2];
    return x * (x * (second[0] * x + second[1] * y + second[2] * z) +
                y * (second[3] * y + second[4] * z) + second[5] * z * z) +
           y * y * (second[6] * y + second[7] * z) + z * z * (second[8] * y + second[9] * z);
  }

  /// Its winding number by the Taylor expansion of (x - q) / |x - q|^3 about the centroid. The next
  /// term has the fourth derivatives of 1 / |x - q|, at most 4! / |x - q|^5 in any directions; over
  /// 3! and 4 pi this is the bound.
  [[nodiscard]] Estimate seen_from(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d r = centre - point;
    const double square = r.squaredNorm(), distance = std::sqrt(square);
    const double gap = distance - radius;
    if (!(gap > 0)) return {};
    const double bound = cubed / (std::numbers::pi * gap * gap * gap * gap * gap);
    if (!(bound <= kOpenAtOnce)) return {};
    const double sum = zeroth.dot(r) + first.trace() -
                       (3 * r.dot(first * r) + 1.5 * traces.dot(r)) / square +
                       7.5 * second_along(r) / (square * square);
    return {.value = sum / (kFullAngle * square * distance), .bound = bound};
  }
};

}  // namespace winding

struct WindingNumber::Tree {
  using Estimate = winding::Estimate;
  using Cluster = winding::Cluster;

  explicit Tree(const TriangleMesh& mesh);

  /// \param stop tells from the sum and its bound whether that is enough.
  template <typename Stop>
  [[nodiscard]] double sum(const Eigen::Vector3d& point, const Stop& stop) const;

  LocalFrame frame;

 private:
  int divide(std::vector<std::pair<Eigen::Vector3d, int>>& centroids, std::ptrdiff_t begin,
             std::ptrdiff_t end);
  void set_moments(Cluster& cluster) const;
  [[nodiscard]] Corners corners(std::ptrdiff_t place) const {
    const Eigen::Vector3i& of = triangles_[static_cast<std::size_t>(place)];
    return {vertices_.col(of[0]), vertices_.col(of[1]), vertices_.col(of[2])};
  }

  Eigen::Matrix3Xd vertices_;               ///< local frame
  std::vector<Eigen::Vector3i> triangles_;  ///< those of a cluster one after the other
  std::vector<Cluster> clusters_;
};

WindingNumber::Tree::Tree(const TriangleMesh& mesh) : frame(local_frame(bounding_box(mesh))) {
  vertices_ = frame.to_local(mesh.vertices);
  std::vector<std::pair<Eigen::Vector3d, int>> centroids;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    centroids.emplace_back(vertices_(Eigen::all, mesh.triangles.col(t)).rowwise().mean(), t);
  }
  divide(centroids, 0, std::ssize(centroids));
  for (const auto& [centroid, t] : centroids) triangles_.emplace_back(mesh.triangles.col(t));
  parallel_for(clusters_.size(), [&](std::size_t i) { set_moments(clusters_[i]); });
}

/// Halves along the longest side of the box of the centroids. Returns the number of the cluster.
int WindingNumber::Tree::divide(std::vector<std::pair<Eigen::Vector3d, int>>& centroids,
                                std::ptrdiff_t begin, std::ptrdiff_t end) {
  const std::size_t number = clusters_.size();
  clusters_.emplace_back();
  clusters_[number].begin = begin;
  clusters_[number].end = end;
  if (end - begin > kLeaf) {
    Eigen::AlignedBox3d box;
    for (std::ptrdiff_t i = begin; i < end; ++i)
      box.extend(centroids[static_cast<std::size_t>(i)].first);
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const std::ptrdiff_t middle = (begin + end) / 2;
    // Equal coordinates are ordered by number, so that the tree is the same everywhere.
    std::nth_element(centroids.begin() + begin, centroids.begin() + middle, centroids.begin() + end,
                     [axis](const auto& a, const auto& b) {
                       return std::pair(a.first[axis], a.second) <
                              std::pair(b.first[axis], b.second);
                     });
    const int left = divide(centroids, begin, middle);
    const int right = divide(centroids, middle, end);
    clusters_[number].left = left;
    clusters_[number].right = right;
  }
  return static_cast<int>(number);
}

void WindingNumber::Tree::set_moments(winding::Cluster& cluster) const {
  double area = 0;
  for (std::ptrdiff_t i = cluster.begin; i < cluster.end; ++i) {
    const auto [a, b, c] = corners(i);
    const double part = (b - a).cross(c - a).norm() / 2;
    cluster.centre += part / 3 * (a + b + c);
    area += part;
  }
  cluster.centre =
      area > 0 ? Eigen::Vector3d(cluster.centre / area) : corners(cluster.begin).front();
  for (std::ptrdiff_t i = cluster.begin; i < cluster.end; ++i) {
    Corners y = corners(i);
    const Eigen::Vector3d n = (y[1] - y[0]).cross(y[2] - y[0]) / 2;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double cubes = 0;
    for (Eigen::Vector3d& corner : y) {
      corner -= cluster.centre;
      sum += corner;
      squares += corner * corner.transpose();
      const double length = corner.norm();
      cluster.radius = std::max(cluster.radius, length);
      cubes += length * length * length;
    }
    // |y|^3 is convex: its mean over a triangle is at most that of the corners.
    cluster.cubed += n.norm() * cubes / 3;
    cluster.zeroth += n;
    cluster.first += n * sum.transpose() / 3;
    cluster.add_second(n, (squares + sum * sum.transpose()) / 12);
  }
}

template <typename Stop>
double WindingNumber::Tree::sum(const Eigen::Vector3d& point, const Stop& stop) const {
  struct Closed {
    Estimate estimate;
    int cluster;
    bool operator<(const Closed& other) const {
      return std::pair(estimate.bound, cluster) < std::pair(other.estimate.bound, other.cluster);
    }
  };
  std::vector<Closed> closed;
  std::vector<int> to_see = {0};
  Estimate total{.value = 0, .bound = 0};
  const auto open = [&](const Cluster& cluster) {
    if (cluster.left != kNone) {
      to_see.push_back(cluster.right);
      to_see.push_back(cluster.left);
      return;
    }
    for (std::ptrdiff_t i = cluster.begin; i < cluster.end; ++i) {
      const auto [a, b, c] = corners(i);
      total.value += solid_angle(a - point, b - point, c - point) / kFullAngle;
    }
  };
  while (true) {
    while (!to_see.empty()) {
      const int number = to_see.back();
      to_see.pop_back();
      const Cluster& cluster = clusters_[static_cast<std::size_t>(number)];
      const Estimate estimate = cluster.seen_from(point);
      if (estimate.bound < kInfinity) {
        total.value += estimate.value;
        total.bound += estimate.bound;
        closed.push_back({estimate, number});
        std::push_heap(closed.begin(), closed.end());
      } else {
        open(cluster);
      }
    }
    if (closed.empty() || stop(total)) return total.value;
    std::pop_heap(closed.begin(), closed.end());
    const Closed worst = closed.back();
    closed.pop_back();
    total.value -= worst.estimate.value;
    total.bound -= worst.estimate.bound;
    open(clusters_[static_cast<std::size_t>(worst.cluster)]);
  }
}

WindingNumber::WindingNumber(const TriangleMesh& mesh) {
  check_mesh(mesh, "WindingNumber");
  tree_ = std::make_unique<Tree>(mesh);
}
WindingNumber::~WindingNumber() = default;
WindingNumber::WindingNumber(WindingNumber&&) noexcept = default;
WindingNumber& WindingNumber::operator=(WindingNumber&&) noexcept = default;

double WindingNumber::at(const Eigen::Vector3d& point, double tolerance) const {
  require("WindingNumber::at(): tolerance", tolerance, at_least(0));
  if (!point.allFinite()) return kNan;
  const Eigen::Vector3d local = tree_->frame.to_local(point);
  if (!(local.cwiseAbs().maxCoeff() <= kFarAway)) return 0;
  return tree_->sum(local,
                    [tolerance](const winding::Estimate& e) { return e.bound <= tolerance; });
}

bool WindingNumber::contains(const Eigen::Vector3d& point) const {
  if (!point.allFinite()) return false;
  const Eigen::Vector3d local = tree_->frame.to_local(point);
  if (!(local.cwiseAbs().maxCoeff() <= kFarAway)) return false;
  return tree_->sum(local, [](const winding::Estimate& e) {
    return std::abs(e.value - kInsideValue) > e.bound;
  }) > kInsideValue;
}

Eigen::VectorXd winding_numbers(const WindingNumber& winding,
                                const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                double tolerance) {
  require("winding_numbers(): tolerance", tolerance, at_least(0));
  Eigen::VectorXd numbers(points.cols());
  parallel_for(points.cols(),
               [&](Eigen::Index i) { numbers[i] = winding.at(points.col(i), tolerance); });
  return numbers;
}

Eigen::VectorX<bool> contained(const WindingNumber& winding,
                               const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  Eigen::VectorX<bool> inside(points.cols());
  parallel_for(points.cols(), [&](Eigen::Index i) { inside[i] = winding.contains(points.col(i)); });
  return inside;
}

}  // namespace palpate::geometry
