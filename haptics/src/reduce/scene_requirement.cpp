// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_requirement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/documents/document.h"
#include "palpate/documents/document_fields.h"
#include "palpate/documents/document_node.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/trajectory_file.h"
#include "scene/scene_members.h"

namespace palpate::haptics {
namespace {

namespace fs = std::filesystem;
using documents::DocumentNode;
using Eigen::Vector3d;

// About what people just notice, relative to the force: see docs/reduce.md.
constexpr double kNoticed = 0.07;

const std::vector<std::string> kRequire{"force_error",   "surface_error", "picture_size", "size",
                                        "largest_force", "largest_depth", "slip",         "shapes",
                                        "region",        "arm_time",      "tool_radius"};
const std::vector<std::string> kBudget{"arm_time"};
const std::vector<std::string> kRegion{"box", "side", "camera", "path", "margin"};

struct Unit {
  std::string_view name;
  double value;
};
constexpr std::array<Unit, 4> kLengths{{{"mm", 1}, {"um", 1e-3}, {"cm", 10}, {"m", 1e3}}};
constexpr std::array<Unit, 3> kForces{{{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}}};
constexpr std::array<Unit, 4> kSizes{{{"kB", 1e3}, {"B", 1}, {"MB", 1e6}, {"GB", 1e9}}};
constexpr std::array<Unit, 3> kTimes{{{"h", 3600}, {"min", 60}, {"s", 1}}};
constexpr std::array<Unit, 1> kPixels{{{"px", 1}}};
constexpr std::array<Unit, 1> kShares{{{"%", 1e-2}}};

// "0.2 N" in the first of the units; nothing if it is not that.
std::optional<double> quantity(const std::string& text, std::span<const Unit> units) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
  for (const Unit& each : units)
    if (unit == each.name) return number * each.value;
  return std::nullopt;
}

double quantity_above_zero(const DocumentNode& node, std::span<const Unit> units) {
  std::string names;
  for (const Unit& unit : units) names.append(names.empty() ? "" : ", ").append(unit.name);
  const std::string right =
      fmt::format("a number > 0 with its unit ({}), such as \"0.5 {}\"", names, units.front().name);
  const std::optional<double> value = quantity(node.text(right), units);
  if (!value || !(*value > 0)) node.refuse(right);
  return *value;
}

void read_force_error(const DocumentNode& node, ReduceOptions& options) {
  constexpr const char* kRight =
      "a force > 0, such as \"0.2 N\", a share of it, such as \"5 %\", or \"jnd\"";
  const std::string& text = node.text(kRight);
  if (text == "jnd") {
    options.max_relative_error = kNoticed;
  } else if (const auto force = quantity(text, kForces); force && *force > 0) {
    options.max_error = force;
  } else if (const auto share = quantity(text, kShares); share && *share > 0 && *share <= 1) {
    options.max_relative_error = share;
  } else {
    node.refuse(kRight);
  }
}

SceneRegion region_of(const DocumentNode& node, const fs::path& folder) {
  node.expect_only(kRegion);
  SceneRegion region;
  if (const auto box = node.find("box")) {
    std::array<double, 6> corners{};
    box->read(corners, "the six numbers x, y, z of the lower and of the upper corner [mm]");
    const Vector3d low(corners[0], corners[1], corners[2]),
        high(corners[3], corners[4], corners[5]);
    if (!(low.array() < high.array()).all())
      box->refuse("a lower corner that is below the upper one in x, y and z");
    region.box.emplace(low, high);
  }
  if (const auto side = node.find("side")) {
    std::array<double, 6> plane{};
    side->read(plane,
               "six numbers: a point of the plane [mm], and a direction to the side that counts");
    const Vector3d point(plane[0], plane[1], plane[2]), towards(plane[3], plane[4], plane[5]);
    if (!(towards.norm() > 0)) side->refuse("a direction that is not zero");
    region.side.emplace(-towards.normalized(), point);
  }
  if (const auto camera = node.find("camera")) {
    std::array<double, 3> at{};
    camera->read(at, "the three numbers x, y, z of its position [mm]");
    region.camera.emplace(at[0], at[1], at[2]);
  }
  const auto path = node.find("path"), margin = node.find("margin");
  if (path && !margin) path->refuse("'margin' beside it: how far the tool may stray from the path");
  if (margin && !path) margin->refuse("'path' beside it, a trajectory");
  if (path) {
    region.margin = quantity_above_zero(*margin, kLengths);
    for (const TrajectoryPoint& point : read_trajectory_file(folder / path->text()))
      region.path.push_back(point.tool);
  }
  if (!region.box && !region.side && !region.camera && !path)
    node.refuse("'box', 'side', 'camera' or 'path'");
  return region;
}

SceneRequirement requirement_of(const DocumentNode& object, const fs::path& folder) {
  SceneRequirement result{.object = object.at("name").text(),
                          .model = folder / object.at("model").text(),
                          .options = {},
                          .region = {},
                          .arm_time = {},
                          .tool_radius = {},
                          .playback = {}};
  if (const auto playback = object.find("playback"))
    documents::read_fields(*playback, fields_of(result.playback));
  const std::optional<DocumentNode> require = object.find("require");
  require->expect_only(kRequire);
  ReduceOptions& options = result.options;
  if (const auto error = require->find("force_error")) read_force_error(*error, options);
  const auto read = [&](const char* name, std::span<const Unit> units, std::optional<double>& to) {
    if (const auto value = require->find(name)) to = quantity_above_zero(*value, units);
  };
  read("surface_error", kLengths, options.max_surface_error);
  read("size", kSizes, options.max_size);
  read("tool_radius", kLengths, result.tool_radius);
  if (const auto size = require->find("picture_size")) {
    options.picture_size = quantity_above_zero(*size, kPixels);
    if (*options.picture_size < 1) size->refuse("at least \"1 px\"");
  }
  read("largest_force", kForces, options.largest_force);
  read("largest_depth", kLengths, options.largest_depth);
  read("arm_time", kTimes, result.arm_time);
  if (const auto slip = require->find("slip")) options.slip = slip->truth();
  if (const auto shapes = require->find("shapes")) options.keep_shapes = shapes->truth();
  if (const auto region = require->find("region")) result.region = region_of(*region, folder);
  return result;
}

std::vector<DocumentNode> objects_with_requirements(const DocumentNode& root) {
  root.expect_only(kSceneMembers);
  std::vector<DocumentNode> objects = root.at("objects").items();
  for (const DocumentNode& object : objects) object.expect_only(kObjectMembers);
  std::erase_if(objects, [](const DocumentNode& object) { return !object.find("require"); });
  if (objects.empty()) {
    root.at("objects").refuse(
        "an object with 'require', for example require: {force_error: 0.2 N}");
  }
  return objects;
}

SceneRequirements requirements_of(const DocumentNode& root, const fs::path& folder) {
  SceneRequirements result;
  for (const DocumentNode& object : objects_with_requirements(root))
    result.objects.push_back(requirement_of(object, folder));
  if (const auto budget = root.find("budget")) {
    budget->expect_only(kBudget);
    if (const auto time = budget->find("arm_time"))
      result.arm_time = quantity_above_zero(*time, kTimes);
  }
  return result;
}

// Returns true if an object is meant by its name, or else by its model.
bool is_meant(const DocumentNode& object, const fs::path& folder, const fs::path& model,
              const std::optional<std::string>& name) {
  if (name) return object.at("name").text() == *name;
  std::error_code ignored;
  return model.empty() || fs::equivalent(folder / object.at("model").text(), model, ignored);
}

SceneRequirement requirement_of_one(const DocumentNode& root, const fs::path& folder,
                                    const fs::path& model, const std::optional<std::string>& name) {
  std::vector<DocumentNode> found = objects_with_requirements(root);
  std::string objects;
  for (const DocumentNode& each : found) {
    objects += fmt::format("{}{} ({})", objects.empty() ? "" : ", ", each.at("name").text(),
                           each.at("model").text());
  }
  std::erase_if(found,
                [&](const DocumentNode& each) { return !is_meant(each, folder, model, name); });
  if (found.size() == 1) return requirement_of(found.front(), folder);
  std::string what = name ? "the name " + *name : "the model " + model.string();
  if (!name && model.empty()) what = "a member 'require'";
  throw InvalidInput(fmt::format(
      "{} {}; objects with 'require' are: {}",
      found.empty() ? "no object with 'require' has" : "several objects have", what, objects));
}

// Reads a scene file. Errors get its name.
template <typename Result>
Result read_scene_document(const fs::path& path,
                           const std::function<Result(const DocumentNode& root)>& read) {
  const documents::Document document = documents::read_document(path);
  return documents::in_file(path.string(), [&] { return read(DocumentNode(document)); });
}

// Distance of successive places, relative to the margin, which is widened by it.
constexpr double kApart = 0.01;

// Closest points of a tool that touches; those that follow much closer than the margin are one.
std::vector<Vector3d> touched(const geometry::TriangleMesh& surface, const SceneRegion& region) {
  const geometry::SurfaceQuery query(surface);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(surface);
  std::vector<Vector3d> places;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector3d& tool : region.path) {
    const geometry::ClosestPoint closest = query.closest_point(tool);
    if (!(closest.distance <= region.margin) &&
        !((tool - closest.position).dot(normals.col(closest.at.triangle)) < 0)) {
      nearest = std::min(nearest, closest.distance);
      continue;
    }
    if (places.empty() || (closest.position - places.back()).norm() > kApart * region.margin)
      places.push_back(closest.position);
  }
  if (places.empty()) {
    throw InvalidInput(fmt::format(
        "the path of the region never touches the surface of the model; it is {:.3g} mm away. It "
        "must be in mm, in the frame of the model",
        nearest));
  }
  return places;
}

// A segment to a vertex ends at its own triangles, within this relative to its length.
constexpr double kOwnTriangles = 1e-6;

std::vector<bool> seen_vertices(const geometry::TriangleMesh& surface, const Vector3d& camera) {
  const geometry::SurfaceQuery query(surface);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(surface);
  std::vector<bool> seen(static_cast<std::size_t>(surface.vertices.cols()));
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (const int v : surface.triangles.col(t))
      if (normals.col(t).dot(camera - surface.vertices.col(v)) > 0)
        seen[static_cast<std::size_t>(v)] = true;
  }
  for (std::size_t v = 0; v < seen.size(); ++v) {
    if (!seen[v]) continue;
    const auto hit = query.first_hit(camera, surface.vertices.col(static_cast<Eigen::Index>(v)));
    seen[v] = !hit || hit->fraction >= 1 - kOwnTriangles;
  }
  return seen;
}

}  // namespace

std::vector<bool> reachable_vertices(const geometry::TriangleMesh& surface,
                                     const SceneRegion& region) {
  geometry::check_mesh(surface, "reachable_vertices(): surface");
  const std::vector<Vector3d> places =
      region.path.empty() ? std::vector<Vector3d>{} : touched(surface, region);
  const std::vector<bool> seen =
      region.camera ? seen_vertices(surface, *region.camera) : std::vector<bool>{};
  std::vector<bool> result(static_cast<std::size_t>(surface.vertices.cols()));
  for (std::size_t v = 0; v < result.size(); ++v) {
    const Vector3d vertex = surface.vertices.col(static_cast<Eigen::Index>(v));
    result[v] = (!region.box || region.box->contains(vertex)) &&
                (!region.side || region.side->signedDistance(vertex) <= 0) &&
                (seen.empty() || seen[v]) &&
                (places.empty() || std::ranges::any_of(places, [&](const Vector3d& place) {
                   return (place - vertex).norm() <= (1 + kApart) * region.margin;
                 }));
  }
  const bool has_triangle = std::ranges::any_of(surface.triangles.colwise(), [&](const auto& t) {
    return std::ranges::all_of(t, [&](int v) { return result[static_cast<std::size_t>(v)]; });
  });
  if (!has_triangle) {
    const Eigen::AlignedBox3d box = geometry::bounding_box(surface);
    throw InvalidInput(fmt::format(
        "the region contains no whole triangle of the model; its surface extends from ({:.4g}, "
        "{:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) mm",
        box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()));
  }
  return result;
}

SceneRequirements read_scene_requirements(const fs::path& path) {
  return read_scene_document<SceneRequirements>(
      path, [&](const DocumentNode& root) { return requirements_of(root, path.parent_path()); });
}

SceneRequirement read_scene_requirement(const fs::path& path, const fs::path& model,
                                        const std::optional<std::string>& object) {
  return read_scene_document<SceneRequirement>(path, [&](const DocumentNode& root) {
    return requirement_of_one(root, path.parent_path(), model, object);
  });
}

}  // namespace palpate::haptics
