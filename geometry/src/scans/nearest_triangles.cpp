// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/nearest_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kUnreached = std::numeric_limits<float>::infinity();
/// Triangles with longer edges have samples between their corners, this far from each other.
/// [spacings]
constexpr double kSampleDistance = 2;

/// Grid points this near to a vertex are compared with more triangles. [spacings]
constexpr float kNear = 1.5F;

/// Four numbers at once, of neighbouring grid points or of triangles.
using FourFloats [[gnu::vector_size(16)]] = float;
using FourInts [[gnu::vector_size(16)]] = int;
constexpr std::size_t kFour = 4;

FourFloats least_of_two(const FourFloats& a, const FourFloats& b) { return a < b ? a : b; }
FourFloats clamped(const FourFloats& a) {
  const FourFloats zero{}, one = zero + 1;
  const FourFloats positive = a > zero ? a : zero;
  return positive < one ? positive : one;
}

/// Four triangles seen from a corner that they share, prepared for distances in single precision.
struct FanPart {
  std::array<FourFloats, 3> ab, ac;   ///< [spacings] the edges from the corner
  FourFloats bb, bc, cc;              ///< their scalar products
  FourFloats per_bb, per_cc, per_dd;  ///< reciprocals, also of the third edge; 0 without length
  FourFloats per_area;  ///< of the squared area of the parallelogram; NaN without area
  FourInts corner;      ///< corner k of triangle t: 3 t + k

  void set(std::size_t lane, const Vector3d& a, const Vector3d& b, const Vector3d& c, int of) {
    // Squares of lengths and of sines below these are rounding.
    constexpr float kTiny = 1e-12F, kTinySine = 1e-6F;
    const Vector3f to_b = (b - a).cast<float>(), to_c = (c - a).cast<float>();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ab[axis][lane] = to_b[static_cast<int>(axis)];
      ac[axis][lane] = to_c[static_cast<int>(axis)];
    }
    const float b_b = to_b.squaredNorm(), b_c = to_b.dot(to_c), c_c = to_c.squaredNorm();
    const float d_d = (to_c - to_b).squaredNorm(), area = b_b * c_c - b_c * b_c;
    bb[lane] = b_b;
    bc[lane] = b_c;
    cc[lane] = c_c;
    per_bb[lane] = b_b > kTiny ? 1 / b_b : 0;
    per_cc[lane] = c_c > kTiny ? 1 / c_c : 0;
    per_dd[lane] = d_d > kTiny ? 1 / d_d : 0;
    per_area[lane] =
        area > kTinySine * b_b * c_c ? 1 / area : std::numeric_limits<float>::quiet_NaN();
    corner[lane] = of;
  }

  /// [spacings^2] of a point that is `p` from the corner; `pp` if the corner is nearest.
  [[nodiscard]] FourFloats squared_distances(const Vector3f& p, float pp) const {
    const FourFloats bp = ab[0] * p[0] + ab[1] * p[1] + ab[2] * p[2];
    const FourFloats cp = ac[0] * p[0] + ac[1] * p[1] + ac[2] * p[2];
    const FourFloats v = (cc * bp - bc * cp) * per_area, w = (bb * cp - bc * bp) * per_area;
    const FourFloats along = cp - bp - bc + bb;
    const FourFloats s = clamped(bp * per_bb), t = clamped(cp * per_cc),
                     u = clamped(along * per_dd);
    const FourFloats to_ab = s * (s * bb - 2 * bp), to_ac = t * (t * cc - 2 * cp);
    const FourFloats to_bc = bb - 2 * bp + u * (u * (bb + cc - 2 * bc) - 2 * along);
    const auto inside = (v >= 0) & (w >= 0) & (v + w <= 1);
    return pp + (inside ? -(v * bp + w * cp) : least_of_two(least_of_two(to_ab, to_ac), to_bc));
  }
};

/// The triangles around each vertex: those of vertex v are in the parts [begin[v], begin[v + 1]).
struct Fans {
  std::vector<int> begin;
  std::vector<FanPart> parts;

  /// \param at [spacings] 3 x V, the vertices.
  Fans(const Eigen::Matrix3Xd& at, const Eigen::Matrix3Xi& triangles)
      : begin(static_cast<std::size_t>(at.cols()) + 1) {
    std::vector<int> sizes(static_cast<std::size_t>(at.cols()));
    for (const int v : triangles.reshaped()) ++sizes[static_cast<std::size_t>(v)];
    constexpr int kSize = kFour;
    for (std::size_t v = 0; v < sizes.size(); ++v)
      begin[v + 1] = begin[v] + (sizes[v] + kSize - 1) / kSize;
    parts.resize(static_cast<std::size_t>(begin.back()));
    std::vector<int> filled(sizes.size());
    for (int t = 0; t < triangles.cols(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const int v = triangles(k, t);
        const auto i = static_cast<std::size_t>(v);
        const auto lane = static_cast<std::size_t>(filled[i] % kSize);
        FanPart& part = parts[static_cast<std::size_t>(begin[i] + filled[i] / kSize)];
        ++filled[i];
        // The lanes that stay empty repeat the last triangle.
        const std::size_t last = filled[i] == sizes[i] ? kFour : lane + 1;
        for (std::size_t l = lane; l < last; ++l) {
          part.set(l, at.col(v), at.col(triangles((k + 1) % 3, t)),
                   at.col(triangles((k + 2) % 3, t)), 3 * t + k);
        }
      }
    }
  }
};

/// A point on the surface: a vertex, or between the corners of a large triangle.
struct Sample {
  Vector3d at;        ///< [spacings]
  int vertex = -1;    ///< -1: not a vertex
  int triangle = -1;  ///< of a sample that is not a vertex
};

/// The vertices, and points spread over large triangles; those on edges only once.
/// \param opposite of half-edges.
std::vector<Sample> samples_of(const Eigen::Matrix3Xd& at, const Eigen::Matrix3Xi& triangles,
                               const Eigen::Matrix3Xi& opposite, const Fans& fans) {
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(at.cols()));
  for (int v = 0; v < at.cols(); ++v) {
    const auto i = static_cast<std::size_t>(v);
    if (fans.begin[i] < fans.begin[i + 1]) samples.push_back({.at = at.col(v), .vertex = v});
  }
  Eigen::VectorXd parts(triangles.cols());  // of the edges of each triangle
  for (int t = 0; t < triangles.cols(); ++t) {
    double longest = kSampleDistance;
    for (int k = 0; k < 3; ++k) {
      longest =
          std::max(longest, (at.col(triangles((k + 1) % 3, t)) - at.col(triangles(k, t))).norm());
    }
    parts[t] = std::ceil(longest / kSampleDistance);
  }
  for (int t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int beside = opposite(k, t) < 0 ? t : opposite(k, t) / 3;
      if (beside < t) continue;
      const double most = std::max(parts[t], parts[beside]);
      const Vector3d from = at.col(triangles(k, t));
      const Vector3d edge = at.col(triangles((k + 1) % 3, t)) - from;
      for (double i = 1; i < most; ++i)
        samples.push_back({.at = from + i / most * edge, .triangle = t});
    }
    const Vector3d a = at.col(triangles(0, t)), ab = at.col(triangles(1, t)) - a,
                   ac = at.col(triangles(2, t)) - a;
    for (double i = 1; i < parts[t]; ++i) {
      for (double j = 1; i + j < parts[t]; ++j)
        samples.push_back({.at = a + i / parts[t] * ab + j / parts[t] * ac, .triangle = t});
    }
  }
  return samples;
}

/// The nearest samples at the grid points of a block.
struct NearestSamples {
  std::int64_t block = 0;
  std::array<FourFloats, kBlockPoints / kFour> squared;  ///< [spacings^2] distance
  std::array<FourInts, kBlockPoints / kFour> sample;     ///< -1 where none is near
};

class SampleSearch {
 public:
  /// \param radius [spacings] farther samples are not looked at.
  explicit SampleSearch(double radius)
      : radius_(radius), squared_radius_(static_cast<float>(radius * radius)) {}

  /// Offers a sample to all grid points within the radius.
  void offer(const Vector3d& at, int sample) {
    using Index = Eigen::Array<std::int64_t, 3, 1>;
    const Index first = (at.array() - radius_).ceil().cast<std::int64_t>();
    const Index last = (at.array() + radius_).floor().cast<std::int64_t>();
    const Index from = first / kBlockEdge, to = last / kBlockEdge;
    for (std::int64_t z = from[2]; z <= to[2]; ++z) {
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          const Index corner = Index(x, y, z) * kBlockEdge;
          const Index low = (first - corner).max(0);
          const Index high = (last - corner).min(kBlockEdge - 1);
          const Vector3f in_block = (at - corner.cast<double>().matrix()).cast<float>();
          offer(block(x, y, z), in_block, sample, low.cast<int>(), high.cast<int>());
        }
      }
    }
  }

  std::deque<NearestSamples> found;

 private:
  using Range = Eigen::Array3i;

  void offer(NearestSamples& block, const Vector3f& at, int sample, const Range& low,
             const Range& high) const {
    const FourFloats offered_at = FourFloats{} + at[0];
    const FourFloats x_0 = FourFloats{0, 1, 2, 3} - offered_at,
                     x_1 = FourFloats{4, 5, 6, 7} - offered_at;
    const FourFloats along_0 = x_0 * x_0, along_1 = x_1 * x_1;
    const FourInts offered = FourInts{} + sample;
    for (int z = low[2]; z <= high[2]; ++z) {
      const float way_z = static_cast<float>(z) - at[2];
      for (int y = low[1]; y <= high[1]; ++y) {
        const float way_y = static_cast<float>(y) - at[1];
        const float across = way_z * way_z + way_y * way_y;
        if (across > squared_radius_) continue;
        const std::size_t row = place_in_block(0, y, z) / kFour;
        for (const std::size_t half : {0, 1}) {
          const FourFloats there = (half == 0 ? along_0 : along_1) + across;
          FourFloats& squared = block.squared[row + half];
          FourInts& nearest = block.sample[row + half];
          const auto nearer = there < squared;
          squared = nearer ? there : squared;
          nearest = nearer ? offered : nearest;
        }
      }
    }
  }

  NearestSamples& block(std::int64_t x, std::int64_t y, std::int64_t z) {
    const std::int64_t key = grid_step(x, y, z) * kBlockEdge;
    Known& known = known_[static_cast<std::size_t>((z & 1) * 4 + (y & 1) * 2 + (x & 1))];
    if (key == known.key) return *known.block;
    const auto number = static_cast<std::size_t>(numbers_.add(key));
    if (number == found.size()) {
      found.emplace_back().block = key;
      found.back().squared.fill(FourFloats{} + squared_radius_);
      found.back().sample.fill(FourInts{} - 1);
    }
    known = {.key = key, .block = &found[number]};
    return *known.block;
  }

  double radius_;
  float squared_radius_;
  BlockNumbers numbers_;
  /// A block that was used last, of those whose indices are as even and odd: most samples reach
  /// the same eight blocks as the one before.
  struct Known {
    std::int64_t key = -1;
    NearestSamples* block = nullptr;
  };
  std::array<Known, 8> known_;
};

}  // namespace

std::deque<NearTriangles> nearest_triangles(const TriangleMesh& mesh,
                                            const Eigen::Matrix3Xi& opposite, const Grid& grid,
                                            double reach) {
  const Eigen::Matrix3Xd at = (mesh.vertices.colwise() - grid.origin) / grid.spacing;
  const Fans fans(at, mesh.triangles);
  const std::vector<Sample> samples = samples_of(at, mesh.triangles, opposite, fans);
  // A foot on a triangle is at most this far from a sample, if that is as far as it can be.
  constexpr double kFromSample = kSampleDistance / std::numbers::sqrt3;
  SampleSearch search(std::hypot(reach, kFromSample));
  for (std::size_t s = 0; s < samples.size(); ++s) search.offer(samples[s].at, static_cast<int>(s));

  std::deque<NearTriangles> result;
  for (const NearestSamples& found : search.found) {
    NearTriangles& block = result.emplace_back();
    block.block = found.block;
    for (std::size_t i = 0; i < kBlockPoints; ++i) {
      const int nearest = found.sample[i / kFour][i % kFour];
      if (nearest < 0) continue;
      const Sample& sample = samples[static_cast<std::size_t>(nearest)];
      const Vector3d point = grid_index(key_in_block(found.block, i));
      FourFloats best = FourFloats{} + kUnreached, at_corner = best;
      FourInts corners{};
      const auto look_around = [&](int vertex) {
        const auto v = static_cast<std::size_t>(vertex);
        const Vector3f p = (point - at.col(vertex)).cast<float>();
        const float pp = p.squaredNorm();
        for (int part = fans.begin[v]; part < fans.begin[v + 1]; ++part) {
          const FanPart& fan = fans.parts[static_cast<std::size_t>(part)];
          const FourFloats squared = fan.squared_distances(p, pp);
          const auto nearer = squared < best;
          best = nearer ? squared : best;
          at_corner = nearer ? FourFloats{} + pp : at_corner;
          corners = nearer ? fan.corner : corners;
        }
      };
      const auto nearest_lane = [&] {
        std::size_t lane = 0;
        for (std::size_t other = 1; other < kFour; ++other)
          lane = best[other] < best[lane] ? other : lane;
        return lane;
      };
      if (sample.vertex >= 0) look_around(sample.vertex);
      // A large triangle, or near the surface, where the distance matters most and a rough surface
      // may have a nearer triangle further on.
      if (sample.vertex < 0 || found.squared[i / kFour][i % kFour] < kNear * kNear) {
        const int triangle = sample.vertex < 0 ? sample.triangle : corners[nearest_lane()] / 3;
        for (const int v : mesh.triangles.col(triangle)) {
          if (v != sample.vertex) look_around(v);
        }
      }
      const std::size_t lane = nearest_lane();
      block.nearest[i] = {.triangle = corners[lane] / 3,
                          .corner = best[lane] == at_corner[lane] ? corners[lane] % 3 : -1};
    }
  }
  return result;
}

}  // namespace palpate::geometry
