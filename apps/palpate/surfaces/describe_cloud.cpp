// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/describe_cloud.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/cloud_distance.h"
#include "palpate/geometry/error_statistics.h"

namespace palpate::apps {
namespace {

Json corner(const Eigen::Vector3d& corner) {
  return corner.allFinite() ? Json{corner.x(), corner.y(), corner.z()} : Json(nullptr);
}

/// Where the points are, and how far each is from its nearest.
std::string place_in_words(const Eigen::AlignedBox3d& box,
                           const geometry::ErrorStatistics& nearest) {
  if (box.isEmpty()) return "";
  std::string prose = "; " + in_words(box);
  if (nearest.count > 0)
    prose += fmt::format("; the nearest other point is {:.4g} mm away (median; 90 %: {:.4g} mm)",
                         nearest.median, nearest.p90);
  return prose;
}

std::string attributes_in_words(const geometry::Attributes& attributes,
                                const std::vector<std::string>& names) {
  if (names.empty()) return "";
  std::string prose = fmt::format("; point attributes: {}", fmt::join(names, " "));
  if (geometry::normals(attributes)) prose += "; with normals";
  if (geometry::colors(attributes)) prose += "; with colours";
  return prose;
}

/// "1.5", or "1e+30" where all digits would be many.
std::string coordinate(double value, int decimals) {
  constexpr double kLongest = 1e15;  // [mm] doubles hold no more digits
  return std::abs(value) < kLongest ? fmt::format("{:.{}f}", value, decimals)
                                    : fmt::format("{:.6g}", value);
}

}  // namespace

std::string in_words(const Eigen::AlignedBox3d& box) {
  constexpr int kDigits = 3;
  constexpr int kMost = 12;
  const double exponent = std::floor(std::log10(box.diagonal().stableNorm()));
  const int decimals = static_cast<int>(std::clamp(kDigits - 1 - exponent, 1.0, 1.0 * kMost));
  const auto range = [&](int axis) {
    return coordinate(box.min()[axis], decimals) + " to " + coordinate(box.max()[axis], decimals);
  };
  return "X " + range(0) + ", Y " + range(1) + ", Z " + range(2) + " mm";
}

void check_coordinates(const fs::path& path, const geometry::PointCloud& cloud) {
  constexpr double kLargest = 1e100;  // [mm] of cloud_distance.h and the others
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    if (cloud.points.col(i).allFinite() && cloud.points.col(i).cwiseAbs().maxCoeff() > kLargest)
      throw InvalidInput(fmt::format(
          "{}: point {} has a coordinate beyond 1e100 mm; correct it, or state the unit (--unit)",
          path.string(), i));
  }
}

Description describe_cloud(const geometry::PointCloud& cloud) {
  Eigen::AlignedBox3d box;
  Eigen::Index known = 0;
  for (const auto& point : cloud.points.colwise()) {
    if (!point.allFinite()) continue;
    box.extend(point);
    ++known;
  }
  const Eigen::VectorXd distances = geometry::neighbour_distances(cloud.points);
  const geometry::ErrorStatistics nearest =
      geometry::error_statistics({distances.begin(), distances.end()});
  const auto repeated = (distances.array() == 0).count();
  std::vector<std::string> names;
  for (const geometry::Attribute& attribute : cloud.attributes) names.push_back(attribute.name);
  std::string prose = fmt::format("{} x {} points{}, {} of them known", cloud.width, cloud.height,
                                  cloud.height > 1 ? " (organised)" : "", known) +
                      place_in_words(box, nearest) + attributes_in_words(cloud.attributes, names);
  if (repeated > 0) prose += fmt::format("; {} points are where another one is, too", repeated);
  return {{{"points", cloud.points.cols()},
           {"known", known},
           {"width", cloud.width},
           {"height", cloud.height},
           {"min", corner(box.min())},
           {"max", corner(box.max())},
           {"nearest", {{"median", nearest.median}, {"p90", nearest.p90}, {"max", nearest.max}}},
           {"repeated", repeated},
           {"attributes", names}},
          prose};
}

}  // namespace palpate::apps
