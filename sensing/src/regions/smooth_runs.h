// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "image/image_plane.h"

namespace palpate::sensing {

using Labels = Eigen::Array<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Pixels that belong to no region have this class; the others 0 (the smoothest) ...
/// kSmoothClasses - 1.
inline constexpr std::uint8_t kNotSmooth = 255;
inline constexpr int kSmoothClasses = 4;

/// Unwraps a phase image in order of quality, by runs instead of pixels.
///
/// A run is a stretch of a row whose pixels are of one class and follow each other by steps that
/// need no turn; it moves as a whole. Runs are linked where neighbouring pixels step by at most a
/// limit, and joined link by link, those between the smoothest pixels first (Kruskal's algorithm
/// for the best spanning tree; the flood from pixel to pixel is Prim's). Where the steps round
/// every loop add up to zero, as they do wherever no steps are missing inside the loop, any order
/// gives the same phase; where they do not, the break comes to lie in the roughest class. Keeps its
/// memory from call to call.
class SmoothRuns {
 public:
  /// \param wrapped [rad] in [-pi, pi] where the class is not kNotSmooth.
  /// \param max_step [rad] < pi
  void find(const Plane& wrapped, const Mask& classes, double max_step);

  /// Number of regions: runs that hang together. They are numbered in the order of their first
  /// pixels.
  [[nodiscard]] int count() const { return count_; }
  /// -1 outside all regions.
  void write_labels(Labels& labels) const;
  /// The wrapped phase plus the turns that make it continuous within each region.
  void write_phase(const Plane& wrapped, Plane& phase) const;
  /// The first pixel of each region, in the order of rows, and how many it has.
  struct Extent {
    int first = 0;
    int pixels = 0;
  };
  void measure(std::vector<Extent>& extents) const;

 private:
  struct Run {
    int first = 0;  ///< pixel; the next run begins where this one ends
    int label = 0;  ///< or -1; while linking, the class
  };
  /// `turns` are what the phase of the run has more than that of its parent.
  struct Node {
    int parent = 0;
    int turns = 0;
  };
  struct Link {
    int a = 0;
    int b = 0;
    int turns = 0;  ///< of b over a
  };

  void start_rows(long rows, long columns);
  void scan_row(const float* phase, const std::uint8_t* classes, int row, float max_step);
  void add_link(const Link& link);
  void join(const Link& link);
  int root_of(int run);
  void label_runs();
  template <typename Each>
  void for_each_run(const Each& each) const;

  long rows_ = 0;
  long columns_ = 0;
  int count_ = 0;
  std::vector<Run> runs_;
  std::vector<Node> nodes_;
  std::array<std::vector<Link>, kSmoothClasses> links_;
  std::vector<std::uint8_t> across_;  ///< links to the right, in this row
  std::vector<std::uint8_t> down_;    ///< links from the row above
  std::vector<std::uint8_t> starts_;  ///< 1 where a run starts, in this row
  std::vector<std::uint8_t> above_;   ///< the same in the row above
  std::vector<std::uint8_t> events_;  ///< where any of these changes
  int first_above_ = 0;               ///< run of the row above
};

}  // namespace palpate::sensing
