// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "clouds/shape_search.h"

#include "clouds/known_points.h"

namespace palpate::geometry {

void visit(CloudShapeOptions& options, FieldVisitor& visitor) {
  visitor.begin("CloudShapeOptions");
  visitor.real({"tolerance",
                "Points at most this far from a shape are on it; about three standard deviations "
                "of the noise",
                "mm", false, "plane"},
               options.tolerance, above(0).finite());
  visitor.real({"min_share", "A shape is found if at least this share of the points is on it"},
               options.min_share, above(0).at_most(1));
  visitor.real({"max_radius",
                "Largest radius of a sphere or cylinder, as a plane is nearly a sphere of a large "
                "radius; inf: the diagonal of the points' bounding box",
                "mm"},
               options.max_radius, above(0));
  visitor.whole({"seed", "Seed of the random samples that propose shapes", "", true}, options.seed,
                at_least(0));
}

ShapeSearch prepare_search(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                           const CloudShapeOptions& options, int sample) {
  // With this number of points, a share of a tenth is known to a fifteenth of itself.
  constexpr int kJudges = 2000;
  static_cast<void>(in_range(options));
  require_given("CloudShapeOptions::tolerance", options.tolerance.has_value());
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
  search.tolerance = *options.tolerance * search.frame.scale;
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
