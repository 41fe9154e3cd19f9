// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/color_evidence.h"

#include <opencv2/imgproc.hpp>
#include <span>
#include <vector>

namespace palpate::sensing {
namespace {

/// A colour is evidence for a patch iff it covers at least this share of the patch's pixels that
/// are well inside a stripe; a smaller share may be a stripe edge displaced by blur.
constexpr double kLeastEvidenceShare = 0.05;

/// Counts of the pixels for which a patch's depths predict one colour.
struct Evidence {
  int wanted = 0;
  int agreeing = 0;
};

}  // namespace

void find_unproven_patches(const Plane& z, const ColorSays& says, int colors, Mask& marked) {
  const long rows = z.rows();
  const long columns = z.cols();
  marked = (z == z).cast<std::uint8_t>();
  const cv::Mat known(static_cast<int>(rows), static_cast<int>(columns), CV_8U, marked.data());
  cv::Mat_<int> patch;
  constexpr int kNeighbours = 4;
  const int patches = cv::connectedComponents(known, patch, kNeighbours, CV_32S);

  std::vector<Evidence> evidence(static_cast<std::size_t>(patches * colors));
  for (long row = 0; row < rows; ++row) {
    const int* const labels = patch[static_cast<int>(row)];
    const std::uint8_t* const said = &says(row, 0);
    for (long column = 0; column < columns; ++column) {
      if (labels[column] == 0 || said[column] == kSilent) continue;
      const int color = said[column] % kConfirms;
      Evidence& one = evidence[static_cast<std::size_t>(labels[column] * colors + color)];
      ++one.wanted;
      one.agreeing += said[column] / kConfirms;
    }
  }

  std::vector<std::uint8_t> unproven(static_cast<std::size_t>(patches), 0);
  for (std::size_t k = 1; k < unproven.size(); ++k) {
    const std::span<const Evidence> of_patch(&evidence[k * static_cast<std::size_t>(colors)],
                                             static_cast<std::size_t>(colors));
    int all = 0;
    for (const Evidence& one : of_patch) all += one.wanted;
    int speaking = 0;
    for (const Evidence& one : of_patch) {
      if (one.wanted >= kLeastEvidenceShare * all && one.wanted > 0 &&
          2 * one.agreeing > one.wanted)
        ++speaking;
    }
    unproven[k] = speaking < 2 ? 1 : 0;
  }
  for (long row = 0; row < rows; ++row) {
    const int* const labels = patch[static_cast<int>(row)];
    for (long column = 0; column < columns; ++column) {
      marked(row, column) = unproven[static_cast<std::size_t>(labels[column])];
    }
  }
}

}  // namespace palpate::sensing
