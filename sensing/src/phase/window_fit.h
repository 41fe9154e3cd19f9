// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "phase/demodulation.h"

namespace palpate::sensing {

/// Contribution of a row at some distance: its weight, and the weight times cosine and sine of the
/// carrier and their products.
struct Tap {
  float weight = 0;
  float cosine = 0;
  float sine = 0;
  float cosine2 = 0;
  float cosine_sine = 0;
};

/// Normal equations of a complete window; by symmetry the sine decouples.
struct WholeWindow {
  float cosine = 0;        ///< sum of weight * cos
  float cosine_scale = 0;  ///< 1 / (sum of weight * cos^2 - cosine^2)
  float sine_scale = 0;    ///< 1 / sum of weight * sin^2
};

/// Cosine and sine of the carrier at a row.
struct Turn {
  float cosine = 1;
  float sine = 0;
};

/// The rows k = -radius ... radius of the window, and its normal equations.
struct Window {
  explicit Window(const DemodulationFilter& filter);

  int radius;
  std::vector<Tap> taps;
  std::vector<Tap> pairs;  ///< the rows k above and below, k = 0 ... radius, each counted once
  WholeWindow whole;
};

/// Sum over the channels of the squared values, for the rows of a window that moves downwards.
class PowerRows {
 public:
  PowerRows(const std::vector<Plane>& channels, int radius);
  /// Computes the rows up to this one, and drops rows more than a window above.
  void reach(long row);
  [[nodiscard]] const float* at(long row, long column) const {
    return &rows_(row % rows_.rows(), column);
  }

 private:
  const std::vector<Plane>& channels_;
  long next_ = 0;
  Plane rows_;
};

/// Green, red and blue.
inline constexpr std::size_t kMostChannels = 3;

/// A range of columns of one row.
struct Block {
  long row = 0;
  long column = 0;
  long columns = 0;
};

/// Output arrays of one row of windows, column by column.
struct FittedRow {
  struct Channel {
    float* mean = nullptr;
    float* re = nullptr;
    float* im = nullptr;
    [[nodiscard]] Channel from(long column) const {
      return {mean + column, re + column, im + column};
    }
  };
  std::array<Channel, kMostChannels> channels;
  std::size_t count = 0;  ///< number of channels
  float* residual = nullptr;
};

/// Fits the windows of a block that all lie completely inside the mask: plain convolution.
void fit_whole_windows(const std::vector<Plane>& channels, const PowerRows& power,
                       const Window& window, const Block& block, Turn turn, const FittedRow& out);

/// Fits windows of which some are partly outside the mask.
void fit_cut_windows(const std::vector<Plane>& channels, const PowerRows& power, const Mask& mask,
                     const Window& window, const Block& block, Turn turn, const FittedRow& out);

/// Writes zeros for windows around pixels outside the mask.
void fit_nothing(const Block& block, const FittedRow& out);

}  // namespace palpate::sensing
