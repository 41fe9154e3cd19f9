// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/cross_section.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/geometry/register_scans.h"
#include "palpate/geometry/registration.h"
#include "palpate/pictures/draw_differences.h"
#include "palpate/pictures/draw_distances.h"
#include "palpate/pictures/draw_section.h"
#include "shared/aliases.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/depth_score.h"
#include "shared/field_options.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// Distances [mm] of a surface A from B, over the part that both have.
struct InBoth {
  geometry::ErrorStatistics error;
  double share = 0;                            ///< of A's points or area in this part
  std::optional<double> camera_distance = {};  ///< [mm] mean depth of the points of a range map
};

/// Computes the distances over the points of a range map: the accuracy of a sensor relative to a
/// reference (thesis 3.5.1). \param depths of the range map, whose points may have been moved.
/// \param within points that are farther from B are not in both.
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

/// Computes them over the area of a mesh, whose vertices alone do not describe the surface.
/// \param a its distances from B.
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

/// One line.
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

/// [mm] Range of the position of a cross-section: 1000 km either way.
constexpr Interval kPlaces = at_least(-1e9).at_most(1e9);

struct CompareCall {
  fs::path a, b, rig, mask, section, picture, aligned;
  bool align = false;
  geometry::RegistrationOptions registration;
  double section_y = 0;
  double within = std::numeric_limits<double>::infinity();
  geometry::ReadOptions meshes;
};

void check_is_surface(const fs::path& path) {
  if (!is_folder(path)) return;
  if (is_there(path / "field.json") || is_there(path / "field.cbor")) {
    throw InvalidInput(path.string() +
                       ": is a model folder; compare measures the distance of surfaces. Give its "
                       "surface, " +
                       (path / "surface.ply").string() +
                       ". To compare the forces of a model with known ones, use palpate evaluate.");
  }
  throw InvalidInput(path.string() + ": is a folder; give one range map or mesh in it.");
}

geometry::TriangleMesh load_surface(const fs::path& path, const CompareCall& call) {
  geometry::TriangleMesh mesh =
      is_range_map(path) ? geometry::mesh_range_map(load_range_map(path, {.rig = call.rig})).mesh
                         : geometry::read_mesh(path, call.meshes);
  if (mesh.triangles.cols() == 0) {
    throw InvalidInput(
        path.string() +
        (is_range_map(path) ? ": no two neighbouring pixels have a depth" : ": has no triangles") +
        "; there is no surface to compare");
  }
  if (!(geometry::surface_area(mesh) > 0))
    throw InvalidInput(path.string() + ": its triangles have no area; there is nothing to compare");
  return mesh;
}

/// A cross-section as one series of a chart: depth over X, a gap between its lines.
pictures::SectionSeries section_series(const std::string& name, const geometry::TriangleMesh& mesh,
                                       double y) {
  const std::vector<geometry::Polyline> lines = geometry::cross_section(mesh, y);
  if (lines.empty()) {
    throw InvalidInput(fmt::format("{}: the plane Y = {} mm does not meet this surface.", name, y));
  }
  std::vector<double> x, z;
  for (const geometry::Polyline& line : lines) {
    x.insert(x.end(), line.row(0).begin(), line.row(0).end());
    z.insert(z.end(), line.row(2).begin(), line.row(2).end());
    x.push_back(std::numeric_limits<double>::quiet_NaN());
    z.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  const auto size = static_cast<Eigen::Index>(x.size());
  return {.name = name,
          .x = Eigen::Map<const Eigen::VectorXd>(x.data(), size),
          .y = Eigen::Map<const Eigen::VectorXd>(z.data(), size)};
}

/// Compares two range maps of one camera pixel by pixel; B is the truth.
void compare_pixels(const Settings& settings, const CompareCall& call) {
  check_is_depths(call.a);
  check_is_depths(call.b);
  const geometry::ImageF a = geometry::read_depth_tiff(call.a);
  const geometry::ImageF b = geometry::read_depth_tiff(call.b);
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    throw InvalidInput(fmt::format(
        "{} has {} x {} px and {} has {} x {} px: comparing depths needs two range maps of one "
        "camera",
        call.a.string(), a.cols(), a.rows(), call.b.string(), b.cols(), b.rows()));
  }
  const geometry::RangeMapScore score =
      call.mask.empty() ? geometry::score_range_map(a, b)
                        : geometry::score_range_map(a, b, read_mask(call.mask, b));
  if (!(a.isFinite() && b.isFinite()).any()) {
    throw InvalidInput(call.a.string() + " and " + call.b.string() +
                       ": no pixel is known in both; there is nothing to compare.");
  }
  if (score.measurable == 0) {
    throw InvalidInput(call.mask.string() + ": none of its non-zero pixels has a depth in " +
                       call.b.string() + ".");
  }
  if (!call.picture.empty()) {
    pictures::draw_differences(call.picture, score,
                               call.a.filename().string() + " minus " + call.b.filename().string());
  }
  print(settings, score_figures(score),
        fmt::format("Depth of A minus depth of B, pixel by pixel, at a distance of {:.0f} mm.\n",
                    score.distance) +
            score_prose(score,
                        call.mask.empty() ? "with a depth in B" : "of the mask with a depth in B"));
}

Json to_json(const geometry::LargestDistance& distance) {
  return {{"lower", distance.lower}, {"upper", distance.upper}, {"at", numbers_in(distance.at)}};
}

/// Moves the smaller surface onto the larger, because a reference of only the object lies on the
/// surface that a sensor saw of it and its surroundings, but not vice versa.
geometry::Registration register_smaller(const CompareCall& call, const geometry::TriangleMesh& a,
                                        const geometry::TriangleMesh& b) {
  geometry::RegistrationOptions options = call.registration;
  options.progress = shown_as("aligning");
  if (geometry::surface_area(a) <= geometry::surface_area(b))
    return geometry::register_points(geometry::registration_points(a), b, options);
  geometry::Registration found =
      geometry::register_points(geometry::registration_points(b), a, options);
  found.T_target_source = found.T_target_source.inverse();
  return found;
}

/// Moves A onto B and adds the pose to the figures. A pose that is not accepted is an error,
/// because there is nothing to compare.
/// \return a description of the pose in words.
std::string align(const CompareCall& call, geometry::TriangleMesh& a,
                  const geometry::TriangleMesh& b, Json& figures) {
  const geometry::Registration found = register_smaller(call, a, b);
  if (found.verdict != geometry::RegistrationVerdict::accepted) {
    const bool slides = found.verdict == geometry::RegistrationVerdict::slides;
    throw SolverError(fmt::format(
        "{} could not be aligned with {}: {}: {}. {}", call.a.string(), call.b.string(),
        geometry::to_string(found.verdict), found.reason,
        slides ? "The smaller surface needs relief in all directions: remove large planes from "
                 "it, and include more of the object."
               : "Bring the surfaces closer to each other, and limit the search with "
                 "--search-rotation and --search-translation."));
  }
  a.vertices = found.T_target_source * a.vertices;
  const Eigen::AngleAxisd turn(found.T_target_source.linear());
  figures["aligned"] = {
      {"rotation", turn.angle()},
      {"translation", found.T_target_source.translation().norm()},
      {"pose", rows_in(found.T_target_source.matrix())},  // as `palpate merge --pose` reads it
      {"verdict", geometry::to_string(found.verdict)},
      {"reason", found.reason},
      {"rms", found.rms},
      {"median", found.median},
      {"overlap", found.overlap},
      {"starts", found.starts}};
  return fmt::format("A was rotated by {:.4f} rad and moved by {:.3f} mm onto B; accepted: {}.\n",
                     turn.angle(), found.T_target_source.translation().norm(), found.reason);
}

/// Warns if the surfaces cannot be two of one object.
void doubt_places(const CompareCall& call, const geometry::TriangleMesh& a,
                  const geometry::TriangleMesh& b, const geometry::SurfaceDistances& spread) {
  constexpr double kOtherUnit = 100;  // ratio of sizes: m and cm; other wrong units differ by more
  constexpr double kApart = 0.1;      // of the smaller size: two of one object meet somewhere
  const double small = std::min(bounding_diagonal(a), bounding_diagonal(b));
  const double large = std::max(bounding_diagonal(a), bounding_diagonal(b));
  const double apart = spread.distance.cwiseAbs().minCoeff();
  if (large < kOtherUnit * small && apart <= kApart * small) return;
  spdlog::warn(
      "{} is {:.4g} mm large, {} {:.4g} mm, and they are {:.4g} mm apart or more: are they in the "
      "same unit (--unit) and frame? --align brings surfaces together that are only displaced",
      call.a.string(), bounding_diagonal(a), call.b.string(), bounding_diagonal(b), apart);
}

/// Other inputs: the distance of A's surface from B's, over its area, and the largest distance.
void compare_surfaces(const Settings& settings, const CompareCall& call) {
  geometry::TriangleMesh a = load_surface(call.a, call);
  const geometry::TriangleMesh b = load_surface(call.b, call);
  Json figures;
  std::string prose;
  const Eigen::ArrayXd depths = a.vertices.row(2);  // before A is moved out of its camera's frame
  if (call.align) prose = align(call, a, b, figures);
  if (!call.aligned.empty()) geometry::write_mesh(call.aligned, a);
  const geometry::SurfaceDistances spread = geometry::surface_distances(a, b);
  doubt_places(call, a, b, spread);
  const geometry::HausdorffDistance largest = geometry::hausdorff_distance(a, b);
  if (!call.section.empty()) {
    const std::vector<pictures::SectionSeries> series = {
        section_series(call.a.filename().string(), a, call.section_y),
        section_series(call.b.filename().string(), b, call.section_y)};
    pictures::draw_section(call.section, series,
                           fmt::format("Cross-section at Y = {} mm", call.section_y),
                           {.x = "X [mm]", .y = "Z [mm]"});
  }
  if (!call.picture.empty()) {
    pictures::draw_distances(
        call.picture, spread.cells, spread.distance,
        {.title = call.a.filename().string() + ": distance from " + call.b.filename().string(),
         .subtitle = fmt::format("root mean square {:.3f} mm, mean {:.3f} mm, 90 % of the area "
                                 "within {:.3f} mm, largest {:.3f} mm; red is outside",
                                 spread.rms, spread.mean, spread.p90, largest.a_to_b.upper),
         .limit = std::max(spread.p90, kLeastScale)});
  }
  figures.update({{"area", spread.area},
                  {"rms", spread.rms},
                  {"mean", spread.mean},
                  {"median", spread.median},
                  {"p90", spread.p90},
                  {"max", largest.a_to_b.upper},
                  {"hausdorff",
                   {{"lower", largest.lower},
                    {"upper", largest.upper},
                    {"a_to_b", to_json(largest.a_to_b)},
                    {"b_to_a", to_json(largest.b_to_a)}}}});
  const InBoth in_both = is_range_map(call.a) ? points_in_both(a.vertices, depths, b, call.within)
                                              : area_in_both(spread, b, call.within);
  figures["in_both"] = to_json(in_both);
  print(settings, figures,
        prose + fmt::format(
                    "Distance of A's surface from B's, over its area: RMS {:.3f} mm, signed mean "
                    "{:.3f} mm, median {:.3f} mm, 90 % within {:.3f} mm.\n"
                    "{}Hausdorff distance: A to B at most {:.3f} mm (at least {:.3f}), B to A at "
                    "most {:.3f} mm (at least {:.3f}).",
                    spread.rms, spread.mean, spread.median, spread.p90, in_words(in_both),
                    largest.a_to_b.upper, largest.a_to_b.lower, largest.b_to_a.upper,
                    largest.b_to_a.lower));
}

}  // namespace

void add_compare(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<CompareCall>();
  CLI::App* command = app.add_subcommand("compare", "Compare two range maps or surfaces");
  add_required(*command, "A", call->a, "Range map or mesh");
  add_required(*command, "B", call->b, "Range map or mesh to compare with");
  command->add_option("--rig", call->rig, "Rig of the range maps (default: rig.yaml beside them)");
  command->add_option("--mask", call->mask,
                      "Image of the pixels that can be measured (non-zero), for two range maps; "
                      "the coverage refers to them (default: all that have a depth in B)");
  add_unit_option(*command, call->meshes);
  CLI::Option* align = command->add_flag(
      "--align", call->align,
      "First register A rigidly to B; one may be a part of the other. Fails (exit status 1) if no "
      "pose is reliable");
  add_fields_of(*align, *command, fields_of(call->registration));
  command
      ->add_option("-o,--output", call->aligned,
                   "With --align: also write surface A at its new pose (.ply, .obj or .stl)")
      ->needs(align);
  add_number(*command, "--within", call->within, above(0),
             "Ignore points of A farther than this from B [mm], for example surroundings of the "
             "object that the sensor saw too");
  CLI::Option* section =
      command
          ->add_option("--section", call->section,
                       "Draw the cross-sections of both (PNG; default name: section.png)")
          ->expected(0, 1);
  add_number(*command, "--section-y", call->section_y, kPlaces,
             "Position of the cross-section: Y [mm]")
      ->capture_default_str()
      ->needs(section);
  command->add_option("--picture", call->picture,
                      "Draw the differences of two range maps, or surface A coloured by its signed "
                      "distance from B (PNG)");
  command->footer(
      "Two range maps of one camera are compared pixel by pixel, unless --align or --section is "
      "given; B is the truth. A\n"
      "depth is wrong if it is more than 1 % of the distance off, or where B has none; the errors "
      "are those of all others.\n"
      "Otherwise the command measures the distance of A's surface from B's over its area, and the\n"
      "Hausdorff distance in both directions, with verified bounds.\n"
      "Examples:\n  palpate compare range/000000.tiff truth.tiff --mask lit.png --picture "
      "differences.png\n"
      "  palpate compare range/000000.tiff reference.ply --align --within 5 --section "
      "section.png\n"
      "  palpate compare reference.ply range/000000.tiff --align -o aligned.ply\n"
      "  palpate compare small.ply surface.ply --picture distances.png");
  command->callback([call, section, &settings] {
    if (section->count() > 0 && call->section.empty()) call->section = "section.png";
    check_outputs({call->a, call->b, call->mask}, {call->section, call->picture, call->aligned});
    check_pictures({call->section, call->picture});
    check_is_surface(call->a);
    check_is_surface(call->b);
    const bool pixels =
        is_range_map(call->a) && is_range_map(call->b) && !call->align && call->section.empty();
    if (!pixels && !call->mask.empty()) {
      throw InvalidInput(
          "palpate compare: --mask is for two range maps that are compared pixel by pixel, without "
          "--align and --section.");
    }
    pixels ? compare_pixels(settings, *call) : compare_surfaces(settings, *call);
  });
}

}  // namespace palpate::apps
