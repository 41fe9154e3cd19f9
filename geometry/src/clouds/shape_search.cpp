// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "clouds/shape_search.h"

#include "clouds/known_points.h"
#include "palpate/core/require.h"

namespace palpate::geometry {

ShapeSearch prepare_search(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                           const CloudShapeOptions& options, int sample) {
  // With this number of points, a share of a tenth is known to a fifteenth of itself.
  constexpr int kJudges = 2000;
  require("CloudShapeOptions::tolerance", options.tolerance, above(0).finite(), "mm");
  require("CloudShapeOptions::min_share", options.min_share, above(0).at_most(1));
  require("CloudShapeOptions::max_radius", options.max_radius, above(0), "mm");
  ShapeSearch search{.known = known_points(points),
                     .points = {},
                     .judges = {},
                     .min_share = options.min_share,
                     .seed = options.seed,
                     .progress = options.progress};
  const int count = search.size();
  search.least = std::max(sample, static_cast<int>(std::ceil(options.min_share * count)));
  if (count < sample) return search;
  const Eigen::Matrix3Xd known = points(Eigen::all, search.known);
  search.frame =
      local_frame(Eigen::AlignedBox3d(known.rowwise().minCoeff(), known.rowwise().maxCoeff()));
  search.points = search.frame.to_local(known);
  const Eigen::Vector3d extent =
      search.points.rowwise().maxCoeff() - search.points.rowwise().minCoeff();
  search.tolerance = options.tolerance * search.frame.scale;
  search.max_radius = std::min(options.max_radius * search.frame.scale, extent.norm());
  if (count <= kJudges) {
    search.judges = search.points;
    return search;
  }
  search.judges.resize(3, kJudges);
  CountedRandom random(options.seed, 0);
  for (int i = 0; i < kJudges; ++i) search.judges.col(i) = search.points.col(random.below(count));
  return search;
}

double trials_needed(double share, int size) {
  constexpr double kMissed = 1e-3, kMostTrials = 1e6;
  const double all_on_shape = std::pow(share, size);
  if (all_on_shape >= 1) return 1;
  return std::min(kMostTrials, std::ceil(std::log(kMissed) / std::log1p(-all_on_shape)));
}

}  // namespace palpate::geometry
