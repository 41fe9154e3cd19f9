// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_sampling.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <cstdint>
#include <utility>

#include "clouds/cell_numbers.h"
#include "clouds/known_points.h"
#include "palpate/core/require.h"
#include "palpate/core/work_steps.h"

namespace palpate::geometry {
namespace {

using PointsRef = Eigen::Ref<const Eigen::Matrix3Xd>;

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
  value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
  return value ^ (value >> 31U);
}

/// Steps into which the least distance is divided to order the places.
constexpr double kOrderSteps = 1024;
/// Start of the steps, in steps: places on a grid are not between two, where rounding decides.
constexpr double kOrderStart = 0.38196601125;

/// The known points in the order of a hash of their offsets from `origin` in units of the least
/// distance. These do not depend on the unit of length nor, apart from rounding, on the position.
std::vector<int> shuffled(const PointsRef& points, const std::vector<int>& known,
                          const Eigen::Vector3d& origin, double min_distance) {
  struct Entry {
    std::uint64_t hash;
    std::array<double, 3> offset;  // tells those apart whose steps are the same
    int index;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> order;
  order.reserve(known.size());
  for (const int i : known) {
    Entry entry{.hash = 0, .offset = {}, .index = i};
    for (int k = 0; k < 3; ++k) {
      const double offset = (points(k, i) - origin[k]) / min_distance;
      // A coordinate too far away for a whole number is refused later, by the cells.
      const double step = std::floor(kOrderSteps * offset + kOrderStart);
      entry.hash = mixed(entry.hash + 0x9e3779b97f4a7c15U + std::bit_cast<std::uint64_t>(step));
      entry.offset[static_cast<std::size_t>(k)] = offset;
    }
    order.push_back(entry);
  }
  std::sort(order.begin(), order.end());
  std::vector<int> indices;
  indices.reserve(order.size());
  for (const Entry& entry : order) indices.push_back(entry.index);
  return indices;
}

/// Chosen points by cell. Cells are a little wider than the least distance, so that points that are
/// closer are in the same cell or in neighbours despite rounding.
class ChosenPoints {
 public:
  ChosenPoints(const PointsRef& points, const Eigen::Vector3d& origin, double min_distance)
      : points_(points), origin_(origin), least_(min_distance) {}

  [[nodiscard]] bool takes(int point) {
    const Eigen::Vector3d place = points_.col(point);
    const Cell cell = cell_of(place, origin_, kCellWidth * least_, "poisson_sample: min_distance");
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z)
          if (has_near(place, cell + Cell(x, y, z))) return false;
    const auto number = static_cast<std::size_t>(numbers_.number(cell));
    if (number == in_cell_.size()) in_cell_.emplace_back();
    in_cell_[number].push_back(point);
    return true;
  }

 private:
  static constexpr double kCellWidth = 1 + 0x1p-10;

  [[nodiscard]] bool has_near(const Eigen::Vector3d& place, const Cell& cell) const {
    const int number = numbers_.find(cell);
    if (number == kNone) return false;
    const std::vector<int>& chosen = in_cell_[static_cast<std::size_t>(number)];
    return std::any_of(chosen.begin(), chosen.end(),
                       [&](int other) { return (points_.col(other) - place).norm() < least_; });
  }

  const PointsRef& points_;
  Eigen::Vector3d origin_;
  double least_;
  CellNumbers numbers_;
  std::vector<std::vector<int>> in_cell_;
};

}  // namespace

VoxelSample voxel_sample(const PointsRef& points, double edge) {
  require("voxel_sample: edge", edge, above(0).finite(), "mm");
  VoxelSample sample{.points = {},
                     .voxel = std::vector<int>(static_cast<std::size_t>(points.cols()), kNone)};
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  CellNumbers numbers;
  std::vector<int> count;
  for (const int i : known_points(points)) {
    const int voxel = numbers.number(cell_of(points.col(i), origin, edge, "voxel_sample: edge"));
    sample.voxel[static_cast<std::size_t>(i)] = voxel;
    count.resize(numbers.cells().size());
    ++count[static_cast<std::size_t>(voxel)];
  }
  // Sums of offsets from the voxel's corner: they round less than sums of coordinates.
  const auto corner = [&](int voxel) -> Eigen::Vector3d {
    return numbers.cells()[static_cast<std::size_t>(voxel)].cast<double>() * edge;
  };
  sample.points.setZero(3, static_cast<Eigen::Index>(count.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int voxel = sample.voxel[static_cast<std::size_t>(i)];
    if (voxel != kNone) sample.points.col(voxel) += points.col(i) - corner(voxel);
  }
  for (int voxel = 0; voxel < static_cast<int>(count.size()); ++voxel) {
    sample.points.col(voxel) =
        corner(voxel) + sample.points.col(voxel) / count[static_cast<std::size_t>(voxel)];
  }
  return sample;
}

std::vector<int> poisson_sample(const PointsRef& points, double min_distance,
                                const WorkSteps::Progress& progress) {
  require("poisson_sample: min_distance", min_distance, above(0).finite(), "mm");
  const std::vector<int> known = known_points(points);
  if (known.empty()) return {};
  Eigen::Vector3d origin = points.col(known.front());
  for (const int i : known) origin = origin.cwiseMin(points.col(i));
  const std::vector<int> order = shuffled(points, known, origin, min_distance);
  ChosenPoints taken(points, origin, min_distance);
  std::vector<int> chosen;
  constexpr int kReport = 50'000;
  WorkSteps steps(progress, static_cast<int>(order.size()) / kReport + 1);
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (taken.takes(order[k])) chosen.push_back(order[k]);
    if ((k + 1) % kReport == 0) steps.tell();
  }
  steps.end();
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace palpate::geometry
