// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <random>
#include <span>
#include <vector>

#include "deformation/deformation_equations.h"
#include "palpate/geometry/deformation_graph.h"
#include "palpate/geometry/nonrigid_registration.h"

namespace palpate::geometry {

/// An intensity in a blurred image, and its derivative.
struct IntensityAt {
  double value;              ///< NaN where unknown
  Eigen::Vector3d gradient;  ///< [1/mm] with respect to the point
};

/// An image, blurred with each of kIntensityBlurs standard deviations.
class BlurredImages {
 public:
  /// \throws InvalidInput unless the camera is valid and the image of its size.
  BlurredImages(const Camera& camera, const ImageF& image);

  /// Returns the intensity of the image at a point, and its derivative.
  /// \param blur index of kIntensityBlurs
  [[nodiscard]] IntensityAt at(const Eigen::Vector3d& point, int blur) const;
  /// [px] that shows a point; NaN if none does, or only one at the border
  [[nodiscard]] Eigen::Vector2d pixel_of(const Eigen::Vector3d& point) const;
  /// [mm] of a pixel that shows a point
  [[nodiscard]] double pixel_width(const Eigen::Vector3d& point) const {
    return point.z() / camera_.fx;
  }

 private:
  Camera camera_;
  std::vector<ImageF> images_;
};

/// Returns random errors of intensities in the least blurred image, with a mean square of 1. Errors
/// of its pixels are independent before it is blurred, so those of neighbouring places are alike.
/// \param pixels as `BlurredImages::pixel_of` gives them; the errors of others are 0
[[nodiscard]] std::vector<double> intensity_noise(std::span<const Eigen::Vector2d> pixels,
                                                  std::mt19937_64& random);

/// A vertex of the deformed surface.
struct IntensitySample {
  int vertex = 0;
  Eigen::Vector3d place;  ///< [mm]
  double distance = 0;    ///< [mm] from the measured plane
  bool is_seen = false;
};

/// Pairs that move samples to where the image shows their intensity: the derivative of the image in
/// place of the normal of the plane, and the difference of intensities, I - (a T + b), in place of
/// the distance. The gain a and the offset b are fitted around each node, so that light may change
/// from frame to frame and from place to place. The weight of a pair, relative to one of a plane,
/// is a product: the ratio of the variances of both kinds of residuals, for which depths count as
/// exact to a twentieth of a pixel at best; Tukey's biweight; and the share of the variance of I
/// that a T explains, which is about 0 if the image shows only noise.
/// \param reference T, of each vertex, for the blurs
[[nodiscard]] std::vector<PlanePair> intensity_pairs(const DeformationGraph& graph,
                                                     const BlurredImages& images,
                                                     const VertexIntensities& reference, int blur,
                                                     std::span<const IntensitySample> samples);

}  // namespace palpate::geometry
