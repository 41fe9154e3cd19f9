// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/merge_scans.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "mesh/compact_mesh.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/mesh_topology.h"
#include "query/surface_tree.h"
#include "scans/distance_volume.h"
#include "scans/registered_scans.h"
#include "scans/scan_conflicts.h"
#include "scans/scan_distance.h"
#include "scans/volume_surface.h"

namespace palpate::geometry {
namespace {

/// Extension of scans beyond their border: the cells there need all their corners. [spacings]
constexpr double kOverhang = 2;
/// The surface is cut where it is farther than this beyond all scans. [spacings]
constexpr double kLargestBeyond = 0.5;
/// Parts up to this size are left out if a larger one is as near. [reaches]
constexpr double kScraps = 2;
/// Scans whose distances are computed at the same time.
constexpr int kScansAtOnce = 4;
constexpr double kGigabyte = 1e9;
/// Bytes for each grid point of a scan, while its distances are computed and until they are
/// combined: blocks of samples, triangles and distances, of which two fifths are in use.
constexpr double kBytesAPoint = 100;
/// The grid points near a surface, relative to its area times the thickness of the layer: the
/// ends of the layer at the border and at small features are beyond.
constexpr double kLayerMargin = 1.3;

void check_sigma(const Scan& scan, const std::string& name) {
  if (scan.sigma.size() == 0) return;
  if (scan.sigma.size() != scan.mesh.vertices.cols()) {
    throw InvalidInput(name + " has " + std::to_string(scan.mesh.vertices.cols()) +
                       " vertices and " + std::to_string(scan.sigma.size()) +
                       " standard deviations; it needs one for each, or none");
  }
  for (Eigen::Index v = 0; v < scan.sigma.size(); ++v) {
    require([&] { return name + ": sigma of vertex " + std::to_string(v); }, scan.sigma[v],
            above(0).finite(), "mm");
  }
}

/// A grid around the scans.
Grid grid_around(const std::vector<TriangleMesh>& meshes, double spacing, double reach) {
  Eigen::AlignedBox3d box;
  for (const TriangleMesh& mesh : meshes) box.extend(bounding_box(mesh));
  const double size = box.diagonal().norm();
  if (!(spacing <= size)) {
    throw InvalidInput(std::vector<MessagePart>{
        {"MergeScansOptions::spacing", true},
        {fmt::format(" is {:g} mm; it must be at most the size of the scans, {:.4g} mm", spacing,
                     size)}});
  }
  const double margin = (reach + 2) * spacing;
  const double extent = box.sizes().maxCoeff() + 2 * margin;
  // A cube of 2^n points must fit into the grid.
  const double finest = 2 * extent / static_cast<double>(kGridPoints);
  if (!(spacing >= finest)) {
    throw InvalidInput(
        fmt::format("merge_scans: a grid of {:g} mm over {:g} mm has too many points; the spacing "
                    "must be at least {:g} mm",
                    spacing, extent, finest));
  }
  return {.origin = box.min().array() - margin, .spacing = spacing};
}

/// Refuses a scan whose grid points need too much memory in addition to that in use.
/// \return [bytes] needed with it.
double check_memory(const TriangleMesh& mesh, double in_use, const Grid& grid,
                    const MergeScansOptions& options, const std::string& name) {
  const double layer = 2 * options.reach + 1;
  const double area = surface_area(mesh) / (grid.spacing * grid.spacing);
  const double bytes = in_use + kBytesAPoint * kLayerMargin * layer * (area + layer * layer);
  const double needed = bytes / kGigabyte;
  if (needed <= options.max_memory) return bytes;
  // The number of grid points in a layer falls with the square of the spacing.
  const double enough = grid.spacing * std::sqrt(needed / options.max_memory);
  throw InvalidInput(std::vector<MessagePart>{
      {fmt::format("{} needs {:g} GB for a grid of {:g} mm; ", name, needed, grid.spacing)},
      {"MergeScansOptions::max_memory", true},
      {fmt::format(" is {:g} GB. A spacing of {:g} mm fits into it", options.max_memory, enough)}});
}

/// The triangles of which no corner is beyond the border of all scans.
Eigen::Matrix3Xi measured_triangles(const VolumeSurface& surface, double largest_beyond) {
  Eigen::Matrix3Xi triangles(3, surface.mesh.triangles.cols());
  Eigen::Index count = 0;
  for (const auto& t : surface.mesh.triangles.colwise()) {
    if (surface.beyond(t).maxCoeff() <= largest_beyond) triangles.col(count++) = t;
  }
  triangles.conservativeResize(3, count);
  return triangles;
}

/// The triangles without those of small parts near a larger one.
/// \param size [mm] largest diagonal of a small part, and how near it lies.
Eigen::Matrix3Xi without_scraps(const TriangleMesh& mesh, double size) {
  const ConnectedComponents parts = connected_components(mesh);
  std::vector<Eigen::AlignedBox3d> boxes(static_cast<std::size_t>(parts.count));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (const int v : mesh.triangles.col(t))
      boxes[static_cast<std::size_t>(parts.component[t])].extend(mesh.vertices.col(v));
  }
  const auto split = [&](const auto& belongs) {
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      if (belongs(static_cast<std::size_t>(parts.component[t]))) chosen.push_back(t);
    }
    return Eigen::Matrix3Xi(mesh.triangles(Eigen::all, chosen));
  };
  const auto is_large = [&](std::size_t part) { return boxes[part].diagonal().norm() > size; };
  const TriangleMesh large{.vertices = mesh.vertices, .triangles = split(is_large)};
  if (large.triangles.cols() == mesh.triangles.cols() || large.triangles.cols() == 0)
    return mesh.triangles;
  const SurfaceTree tree(large, TreeBuild::quick);
  const auto is_near = [&](const Eigen::Vector3d& place) {
    return tree.nearest(tree.to_local(place), size * tree.scale()).triangle >= 0;
  };
  std::vector<bool> kept(boxes.size());
  for (std::size_t part = 0; part < boxes.size(); ++part)
    kept[part] = is_large(part) || !is_near(boxes[part].center());
  return split([&](std::size_t part) { return kept[part]; });
}

}  // namespace

void visit(MergeScansOptions& options, FieldVisitor& visitor) {
  visitor.begin("MergeScansOptions");
  visitor.real({"spacing",
                "Spacing of the grid, and about the edge length of the merged surface; at most the "
                "size of the scans. Without it: the median edge length of the scans",
                "mm"},
               options.spacing, above(0).finite());
  visitor.real({"reach", "Average scans that are within this many spacings of each other"},
               options.reach, at_least(2).finite());
  visitor.real({"max_memory", "Refuse a grid that needs more memory than this", "GB"},
               options.max_memory, above(0));
}

MergedScans merge_scans(std::span<const Scan> scans, const MergeScansOptions& given) {
  const MergeScansOptions options = in_range(given);
  std::vector<TriangleMesh> meshes = in_frame_of_object(scans, "merge_scans");
  require_manifold(scans, "merge_scans");
  bool know_sigma = true;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    check_sigma(scans[i], scan_name(scans, i, "merge_scans"));
    know_sigma = know_sigma && scans[i].sigma.size() > 0;
  }
  MergedScans merged;
  merged.spacing = options.spacing ? *options.spacing : median_edge_length(meshes, "merge_scans");
  const Grid grid = grid_around(meshes, merged.spacing, options.reach);
  const double reach = options.reach * grid.spacing;
  ConflictSearch conflicts(scans, meshes, grid, reach);
  const auto count = static_cast<int>(scans.size());
  const auto report = [&](int done) {
    if (options.progress) options.progress(done, count);
  };
  DistanceVolume volume;
  std::vector<DistanceVolume> batch;
  for (int first = 0; first < count; first += static_cast<int>(batch.size())) {
    batch.assign(static_cast<std::size_t>(std::min(kScansAtOnce, count - first)), {});
    report(first);
    auto bytes = static_cast<double>(volume.bytes());
    for (std::size_t k = 0; k < batch.size(); ++k) {
      const std::size_t i = static_cast<std::size_t>(first) + k;
      bytes = check_memory(meshes[i], bytes, grid, options, scan_name(scans, i, "merge_scans"));
    }
    parallel_for(batch.size(), [&](std::size_t k) {
      const std::size_t i = static_cast<std::size_t>(first) + k;
      const ScanDistance scan(std::move(meshes[i]), know_sigma ? scans[i].sigma : Eigen::VectorXd(),
                              kOverhang * grid.spacing);
      batch[k] = distances_around(scan, grid, reach);
    });
    for (std::size_t k = 0; k < batch.size(); ++k) {
      const int i = first + static_cast<int>(k);
      report(i);
      conflicts.add(i, batch[k]);
      volume.add(batch[k]);
      batch[k] = {};
      report(i + 1);
    }
  }
  merged.conflicts = conflicts.found();
  const std::vector<GridDistance> points = volume.near_surface();
  volume = {};
  VolumeSurface surface = zero_surface(grid, points);
  surface.mesh.triangles = measured_triangles(surface, kLargestBeyond * grid.spacing);
  if (surface.mesh.triangles.cols() == 0) {
    throw SolverError(
        fmt::format("merge_scans: a grid of {:g} mm finds no surface: it is too coarse for these "
                    "scans",
                    grid.spacing));
  }
  // Cells with two pieces can pinch the surface, and vertices without triangles are left over.
  RepairedMesh repaired = repair_mesh(surface.mesh);
  repaired.mesh.triangles = without_scraps(repaired.mesh, kScraps * reach);
  CompactMesh kept = compact(repaired.mesh);
  merged.mesh = std::move(kept.mesh);
  if (know_sigma) {
    merged.sigma.resize(merged.mesh.vertices.cols());
    for (Eigen::Index v = 0; v < merged.sigma.size(); ++v) {
      const int source = kept.source[static_cast<std::size_t>(v)];
      merged.sigma[v] =
          1 / std::sqrt(surface.precision[repaired.source[static_cast<std::size_t>(source)]]);
    }
  }
  return merged;
}

}  // namespace palpate::geometry
