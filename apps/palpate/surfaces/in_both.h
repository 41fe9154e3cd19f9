// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_distance.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Distances [mm] of a surface A from B where both have a surface.
struct InBoth {
  geometry::ErrorStatistics error;
  double share = 0;                            ///< of A's points or area that is there
  std::optional<double> camera_distance = {};  ///< [mm] mean depth of the points of a range map
};

/// Over the points of a range map of these depths, which may be moved since: the accuracy of a
/// sensor relative to a reference (thesis 3.5.1).
/// \param within points that are farther from B are not in both.
[[nodiscard]] InBoth points_in_both(const Eigen::Matrix3Xd& a, const Eigen::ArrayXd& depths,
                                    const geometry::TriangleMesh& b, double within);

/// Over the area of a mesh, whose vertices say nothing of the surface between them.
/// \param a its distances from B.
[[nodiscard]] InBoth area_in_both(const geometry::SurfaceDistances& a,
                                  const geometry::TriangleMesh& b, double within);

[[nodiscard]] Json to_json(const InBoth& found);
/// One line.
[[nodiscard]] std::string in_words(const InBoth& found);

}  // namespace palpate::apps
