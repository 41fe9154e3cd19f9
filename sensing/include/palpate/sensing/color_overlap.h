// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// How often the classifier of the decoder takes one colour for another: N x N in the order of the
/// trained colours; row: the colour that was projected; column: what it is taken for; rows sum
/// to 1.
///
/// From the trained Gaussians: the probability of colour A's hues (wrapped around the circle) over
/// those where B is the most probable colour.
/// \throws InvalidInput if there is no colour or one is not valid.
[[nodiscard]] Eigen::MatrixXd predict_overlap(const TrainedColors& trained);

/// The same, counted over the pixels of training images; a row without pixels is NaN.
/// \throws InvalidInput as `train_colors`, or if an image's colour was not trained.
[[nodiscard]] Eigen::MatrixXd measure_overlap(const std::vector<NamedImages>& images,
                                              const TrainedColors& trained,
                                              const TrainingOptions& options = {});

/// How many of the pixels that train a colour have which hue, from hue 0 around the circle in
/// `steps` equal steps. \throws InvalidInput as `train_colors`, or unless steps > 0.
[[nodiscard]] Eigen::VectorXd hue_histogram(const NamedImages& images, int steps,
                                            const TrainingOptions& options = {});

/// Two colours that are hard to tell apart.
struct ConfusedColors {
  int first = 0;           ///< index of the colour that is taken ...
  int second = 0;          ///< ... for this one
  double probability = 0;  ///< how often
};

/// The pairs with a probability above `limit`, the worst first.
[[nodiscard]] std::vector<ConfusedColors> find_confused(const Eigen::MatrixXd& overlap,
                                                        double limit);

}  // namespace palpate::sensing
