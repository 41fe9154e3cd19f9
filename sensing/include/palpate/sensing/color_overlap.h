// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// Predicts the confusion matrix of the decoder's colour classifier from the trained Gaussians:
/// the probability that a hue of colour A (wrapped around the circle) lies where B is the most
/// probable colour.
/// \return N x N in the order of the trained colours; rows: projected colour; columns: classified
/// colour. Each row sums to 1.
/// \throws InvalidInput if there is no colour or a colour is not valid.
[[nodiscard]] Eigen::MatrixXd predict_overlap(const TrainedColors& trained);

/// Measures the same matrix from the pixels of training images; a row without pixels is NaN.
/// \throws InvalidInput as `train_colors`, or if the colour of an image was not trained.
[[nodiscard]] Eigen::MatrixXd measure_overlap(const std::vector<NamedImages>& images,
                                              const TrainedColors& trained,
                                              const TrainingOptions& options = {});

/// Histogram of the hues of the pixels that train a colour, in `steps` equal bins around the circle
/// starting at hue 0.
/// \throws InvalidInput as `train_colors`, or unless steps > 0.
[[nodiscard]] Eigen::VectorXd hue_histogram(const NamedImages& images, int steps,
                                            const TrainingOptions& options = {});

/// Two colours that are hard to distinguish.
struct ConfusedColors {
  int first = 0;           ///< index of the projected colour
  int second = 0;          ///< index of the colour it is mistaken for
  double probability = 0;  ///< probability of this mistake
};

/// Finds the pairs whose probability of confusion exceeds `limit`, the worst first.
[[nodiscard]] std::vector<ConfusedColors> find_confused(const Eigen::MatrixXd& overlap,
                                                        double limit);

}  // namespace palpate::sensing
