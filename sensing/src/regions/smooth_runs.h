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

/// Class of pixels that belong to no region; the other classes are 0 (smoothest) ...
/// kSmoothClasses - 1.
inline constexpr std::uint8_t kNotSmooth = 255;
inline constexpr int kSmoothClasses = 4;

/// Unwraps a phase image in order of quality, working on runs instead of pixels.
///
/// A run is a range of pixels in a row that have one class and need no turns between them. Runs are
/// linked where neighbouring pixels step by at most a limit, and merged link by link, starting with
/// the smoothest pixels (Kruskal's algorithm for the best spanning tree; a flood from pixel to
/// pixel is Prim's). Where the steps around every loop sum to zero, which holds unless steps are
/// missing inside the loop, the order does not change the phase; otherwise the discontinuity falls
/// into the roughest class. Keeps its memory between calls.
class SmoothRuns {
 public:
  /// \param wrapped [rad] in [-pi, pi] where the class is not kNotSmooth.
  /// \param max_step [rad] < pi
  void find(const Plane& wrapped, const Mask& classes, double max_step);

  /// Number of regions, which are connected sets of runs. They are numbered in the order of their
  /// first pixels.
  [[nodiscard]] int count() const { return count_; }
  /// Writes the region of each pixel; -1 outside all regions.
  void write_labels(Labels& labels) const;
  /// Writes the wrapped phase plus the turns that make it continuous within each region.
  void write_phase(const Plane& wrapped, Plane& phase) const;
  /// First pixel of each region, in row order, and its number of pixels.
  struct Extent {
    int first = 0;
    int pixels = 0;
  };
  void measure(std::vector<Extent>& extents) const;

 private:
  struct Run {
    int first = 0;  ///< first pixel; the next run begins where this one ends
    int label = 0;  ///< region or -1; while linking, the class
  };
  /// `turns` is the phase of the run minus that of its parent, in turns.
  struct Node {
    int parent = 0;
    int turns = 0;
  };
  struct Link {
    int a = 0;
    int b = 0;
    int turns = 0;  ///< of b relative to a
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
  std::vector<std::uint8_t> across_;  ///< links to the right in this row
  std::vector<std::uint8_t> down_;    ///< links from the row above
  std::vector<std::uint8_t> starts_;  ///< 1 where a run of this row starts
  std::vector<std::uint8_t> above_;   ///< the same for the row above
  std::vector<std::uint8_t> events_;  ///< 1 where any of these changes
  int first_above_ = 0;               ///< first run of the row above
};

}  // namespace palpate::sensing
