// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

constexpr std::array<TableField::Column, 6> kBox{{{"x0", finite()},
                                                  {"y0", finite()},
                                                  {"z0", finite()},
                                                  {"x1", finite()},
                                                  {"y1", finite()},
                                                  {"z1", finite()}}};

TableField::Rows rows_of(const std::vector<Eigen::AlignedBox3d>& boxes) {
  TableField::Rows rows;
  for (const Eigen::AlignedBox3d& box : boxes) {
    const Vector3d &low = box.min(), &high = box.max();
    rows.push_back({low.x(), low.y(), low.z(), high.x(), high.y(), high.z()});
  }
  return rows;
}

std::vector<Eigen::AlignedBox3d> boxes_of(const TableField::Rows& rows) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const std::vector<double>& row : rows)
    boxes.emplace_back(Vector3d(row[0], row[1], row[2]), Vector3d(row[3], row[4], row[5]));
  return boxes;
}

void check_mask(const RangeMap& map, const PixelMask& mask) {
  if (mask.size() > 0 && (mask.rows() != map.z.rows() || mask.cols() != map.z.cols())) {
    throw InvalidInput(
        fmt::format("select_depths(): the mask has {} x {} px, but the range map {} x {} px; they "
                    "must be equal",
                    mask.cols(), mask.rows(), map.z.cols(), map.z.rows()));
  }
}

/// Leaves out the known depths for which `is_out(pixel)`, and counts them.
template <typename IsOut>
long leave_out(ImageF& z, const IsOut& is_out) {
  long count = 0;
  for (Eigen::Index pixel = 0; pixel < z.size(); ++pixel) {
    float& depth = z.data()[pixel];
    if (std::isnan(depth) || !is_out(pixel)) continue;
    depth = kUnknown;
    ++count;
  }
  return count;
}

/// At most `most` of the known points: one of each `step` that follow each other, row by row. Its
/// place among them varies, because equal steps may meet only a few columns of the image. Multiples
/// of the golden ratio, modulo one, are evenly spread.
Eigen::Matrix3Xd some_points(const ImageF& z, const Eigen::Matrix3Xd& points, Eigen::Index most) {
  const Eigen::Index known = (z == z).count();
  const Eigen::Index step = known / most + 1;
  Eigen::Matrix3Xd some(3, known / step + 1);
  Eigen::Index seen = 0, taken = 0;
  const auto next = [&] {
    const double turns = static_cast<double>(taken) * std::numbers::phi;
    const double place = (turns - std::floor(turns)) * static_cast<double>(step);
    return taken * step + static_cast<Eigen::Index>(place);
  };
  for (Eigen::Index pixel = 0; pixel < z.size(); ++pixel) {
    if (std::isnan(z.data()[pixel]) || seen++ != next()) continue;
    some.col(taken++) = points.col(pixel);
  }
  some.conservativeResize(3, taken);
  return some;
}

void remove_plane(RangeMapSelection& selection, const Eigen::Matrix3Xd& points, double tolerance) {
  constexpr Eigen::Index kLooks = 20'000;
  selection.plane = find_plane(some_points(selection.z, points, kLooks),
                               {.tolerance = tolerance, .min_share = kLeastPlane});
  if (!selection.plane) return;
  CloudPlane& plane = *selection.plane;
  plane.inliers.clear();
  if (plane.normal.dot(plane.point) > 0) plane.normal = -plane.normal;
  selection.on_plane = leave_out(selection.z, [&](Eigen::Index pixel) {
    return plane.normal.dot(points.col(pixel) - plane.point) <= tolerance;
  });
}

}  // namespace

void visit(RangeMapSelectionOptions& options, FieldVisitor& visitor) {
  visitor.begin("RangeMapSelectionOptions");
  visitor.real({"near", "Leave out depths that are nearer to the camera", "mm"}, options.near,
               above(0).finite());
  visitor.real({"far", "Leave out depths that are farther from the camera", "mm"}, options.far,
               above(0).finite());
  visitor.table({.name = "crop",
                 .description = "Leave out points outside this box in the frame of the camera, X "
                                "right, Y down, Z forward; of several boxes, outside all",
                 .unit = "mm"},
                {rows_of(options.crop), kBox,
                 [&options](const TableField::Rows& rows) { options.crop = boxes_of(rows); }});
  visitor.real({"remove_plane",
                "Leave out the largest plane, such as a table: points up to this far in front of "
                "it, and all behind it; about three standard deviations of the noise",
                "mm"},
               options.remove_plane, above(0).finite());
}

void check_selection(const RangeMapSelectionOptions& options) {
  RangeMapSelectionOptions checked = in_range(options);
  if (checked.near && checked.far && !(*checked.near < *checked.far)) {
    throw InvalidInput({{"RangeMapSelectionOptions::near", true},
                        {fmt::format(" is {:g} mm; it must be less than ", *checked.near)},
                        {"RangeMapSelectionOptions::far", true},
                        {fmt::format(", which is {:g} mm", *checked.far)}});
  }
  for (const Eigen::AlignedBox3d& box : checked.crop) {
    if ((box.min().array() < box.max().array()).all()) continue;
    throw InvalidInput(
        {{"RangeMapSelectionOptions::crop", true},
         {fmt::format(" is {}; it must be x0, y0, z0, x1, y1, z1 with x0 < x1, y0 < y1 and z0 < z1",
                      fmt::join(rows_of({box}).front(), ", "))}});
  }
}

bool selects(const RangeMapSelectionOptions& options) {
  return options.near || options.far || !options.crop.empty() || options.remove_plane;
}

RangeMapSelection select_depths(const RangeMap& map, const RangeMapSelectionOptions& options,
                                const PixelMask& mask) {
  check_selection(options);
  check_mask(map, mask);
  RangeMapSelection selection{.z = map.z};
  ImageF& z = selection.z;
  // Depths that are infinite or not positive are unknown, as they are to meshes.
  leave_out(z, [&](Eigen::Index pixel) {
    return !(z.data()[pixel] > 0) || !std::isfinite(z.data()[pixel]);
  });
  selection.nearest = selection.farthest = std::numeric_limits<double>::quiet_NaN();
  for (const float depth : z.reshaped()) {
    if (std::isnan(depth)) continue;
    ++selection.known;
    selection.nearest = std::fmin(selection.nearest, static_cast<double>(depth));
    selection.farthest = std::fmax(selection.farthest, static_cast<double>(depth));
  }
  const auto depth = [&](Eigen::Index pixel) { return static_cast<double>(z.data()[pixel]); };
  if (options.near)
    selection.too_near = leave_out(z, [&](auto pixel) { return depth(pixel) < *options.near; });
  if (options.far)
    selection.too_far = leave_out(z, [&](auto pixel) { return depth(pixel) > *options.far; });
  Eigen::Matrix3Xd points;
  if (!options.crop.empty() || options.remove_plane)
    points = back_project({.z = z, .camera = map.camera});
  if (!options.crop.empty()) {
    selection.outside_crop = leave_out(z, [&](Eigen::Index pixel) {
      return std::ranges::none_of(options.crop,
                                  [&](const auto& box) { return box.contains(points.col(pixel)); });
    });
  }
  if (mask.size() > 0)
    selection.masked = leave_out(z, [&](auto pixel) { return !mask.data()[pixel]; });
  if (options.remove_plane) {
    // They are in no plane, and have no point for it.
    selection.without_ray =
        leave_out(z, [&](Eigen::Index pixel) { return !points.col(pixel).allFinite(); });
    remove_plane(selection, points, *options.remove_plane);
  }
  selection.kept = (z == z).count();
  return selection;
}

}  // namespace palpate::geometry
