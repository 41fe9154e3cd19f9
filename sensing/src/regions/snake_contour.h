// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "image/image_plane.h"
#include "regions/smooth_runs.h"

namespace palpate::sensing {

/// A growing snake: a closed contour of points, which deforms until it fills a
/// smooth region (thesis 3.3.4). Coordinates are (column, row) of an image
/// [px].
///
/// Each point moves, along the normal, by the sum of three forces: a constant
/// expansion along the outward normal, which fades out as the roughness comes
/// near 1; an image force against the gradient of the roughness, interpolated
/// from four pixels; and a rigidity force proportional to the curvature.
/// Between points that are held, a front can bulge no farther than to the
/// radius at which rigidity and expansion cancel, so that gaps in a border
/// narrower than twice that radius are not passed. Points are added where they
/// get too far from each other and removed where they get too near. A point
/// stays where it is if by its move the contour would cross itself, enter a
/// finished region or leave the image.
class SnakeContour {
 public:
  /// A circle grows iff its radius is above this, at which rigidity cancels
  /// expansion [px].
  static constexpr double kCriticalRadius = 4;

  /// A circle.
  /// \param roughness of each pixel, >= 0: 1 is where expansion ends.
  /// \param finished labels >= 0 are regions that must not be entered.
  /// Both must outlive the contour.
  SnakeContour(const Eigen::Vector2d& center, double radius, const Plane& roughness,
               const Labels& finished);

  /// Moves the points until the contour is at rest or `max_rounds` are over.
  /// Returns whether it rests.
  bool grow(int max_rounds);

  /// The points in their order, 2 x N.
  [[nodiscard]] Eigen::Matrix2Xd points() const;

 private:
  struct Point {
    Eigen::Vector2d at;
    int previous = 0;
    int next = 0;
    int still = 0;  ///< rounds without a move; -1 once removed
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
  std::vector<std::vector<int>> cells_;  ///< points by place
};

}  // namespace palpate::sensing
