// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/in_both.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace palpate::apps {

InBoth points_in_both(const Eigen::Matrix3Xd& a, const Eigen::ArrayXd& depths,
                      const geometry::TriangleMesh& b, double within) {
  const Eigen::VectorXd distances = geometry::distances_in_both(a, b, within);
  InBoth found{.error = geometry::error_statistics({distances.begin(), distances.end()})};
  const auto count = static_cast<double>(found.error.count);
  found.share = count / static_cast<double>(distances.size());
  const auto is_in_both = distances.array() == distances.array();
  found.camera_distance = is_in_both.select(depths, 0).sum() / count;
  return found;
}

InBoth area_in_both(const geometry::SurfaceDistances& a, const geometry::TriangleMesh& b,
                    double within) {
  const Eigen::Matrix3Xi& cells = a.cells.triangles;
  Eigen::Matrix3Xd centres(3, cells.cols());
  for (Eigen::Index c = 0; c < cells.cols(); ++c)
    centres.col(c) = a.cells.vertices(Eigen::all, cells.col(c)).rowwise().mean();
  const Eigen::VectorXd distances = geometry::distances_in_both(centres, b, within);
  std::vector<Eigen::Index> common;
  for (Eigen::Index c = 0; c < cells.cols(); ++c)
    if (!std::isnan(distances[c])) common.push_back(c);
  if (common.empty()) return {.error = geometry::error_statistics({})};
  const geometry::TriangleMesh parts{a.cells.vertices, cells(Eigen::all, common)};
  const geometry::SurfaceDistances of_parts =
      geometry::surface_distances(parts, b, {.cells = 1});  // of a triangle, at least
  return {.error = {.count = static_cast<long>(common.size()),
                    .rms = of_parts.rms,
                    .median = of_parts.median,
                    .p90 = of_parts.p90,
                    .max = of_parts.distance.cwiseAbs().maxCoeff()},
          .share = of_parts.area / a.area};
}

Json to_json(const InBoth& found) {
  const geometry::ErrorStatistics& error = found.error;
  Json json = {{"count", error.count}, {"rms", error.rms}, {"median", error.median},
               {"p90", error.p90},     {"max", error.max}, {"share", found.share}};
  if (found.camera_distance && error.count > 0) {
    json["distance"] = *found.camera_distance;
    json["rms_percent"] = 100 * error.rms / *found.camera_distance;
  }
  return json;
}

std::string in_words(const InBoth& found) {
  const geometry::ErrorStatistics& error = found.error;
  std::string words =
      fmt::format("Only where both have a surface ({:.1f} % of A's {}): ", 100 * found.share,
                  found.camera_distance ? "points" : "area");
  if (error.count == 0) return words + "nothing.\n";
  words += fmt::format("RMS {:.3f} mm, median {:.3f} mm, 90 % within {:.3f} mm, largest {:.3f} mm",
                       error.rms, error.median, error.p90, error.max);
  if (found.camera_distance) {
    words += fmt::format("; the RMS is {:.3f} % of the mean distance of {:.1f} mm",
                         100 * error.rms / *found.camera_distance, *found.camera_distance);
  }
  return words + ".\n";
}

}  // namespace palpate::apps
