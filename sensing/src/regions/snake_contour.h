// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "image/image_plane.h"
#include "regions/smooth_runs.h"

namespace palpate::sensing {

/// A growing snake: a closed contour of points that deforms until it fills a smooth region (thesis
/// 3.3.4). Coordinates are (column, row) of an image [px].
///
/// Each point moves along the normal by the sum of three forces: a constant outward expansion,
/// which vanishes as the roughness approaches 1; an image force against the gradient of the
/// roughness, interpolated from four pixels; and a rigidity force proportional to the curvature.
/// Between points that are held, a front bulges no farther than the radius at which rigidity and
/// expansion cancel, so the snake does not pass gaps in a border that are narrower than twice this
/// radius. Points are added where they are too far apart and removed where they are too close. A
/// point does not move if the contour would then cross itself, enter a finished region or leave the
/// image.
class SnakeContour {
 public:
  /// Radius at which rigidity cancels expansion [px]: a circle grows if its radius is larger.
  static constexpr double kCriticalRadius = 4;

  /// Starts as a circle. `roughness` and `finished` must outlive the contour.
  /// \param roughness of each pixel, >= 0: expansion ends at 1.
  /// \param finished labels >= 0 are regions that must not be entered.
  SnakeContour(const Eigen::Vector2d& center, double radius, const Plane& roughness,
               const Labels& finished);

  /// Moves the points until the contour is at rest or `max_rounds` have passed.
  /// \return true if the contour is at rest.
  bool grow(int max_rounds);

  /// The points in contour order, 2 x N.
  [[nodiscard]] Eigen::Matrix2Xd points() const;

 private:
  struct Point {
    Eigen::Vector2d at;
    int previous = 0;
    int next = 0;
    int still = 0;  ///< rounds without a move; -1 if removed
  };

  [[nodiscard]] Eigen::Vector2d force(const Point& point) const;
  [[nodiscard]] Eigen::Vector2d gradient(const Eigen::Vector2d& at) const;
  [[nodiscard]] bool open(const Eigen::Vector2d& at) const;
  [[nodiscard]] bool crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b, int first,
                             int last) const;
  [[nodiscard]] double area() const;
  bool move_all();
  bool move(int number);
  void split_after(int number);
  bool remove_after(int number);
  void resample(int number);
  void wake(int number);
  std::vector<int>& cell_of(const Eigen::Vector2d& at);
  void forget(int number);

  const Plane* roughness_;
  const Labels* finished_;
  long cells_across_ = 0;
  std::vector<Point> points_;
  int count_ = 0;
  std::vector<std::vector<int>> cells_;  ///< points by location
};

}  // namespace palpate::sensing
