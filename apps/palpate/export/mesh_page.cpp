// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/mesh_page.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "export/page_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/packed_image.h"
#include "shared/command_line.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// Coordinates are rounded to a step that is at most this fraction of the diagonal of the bounding
/// box: some 2 um for an object of 200 mm.
constexpr double kStepOfDiagonal = 1e-5;
/// Attributes are rounded to a step of at most this fraction of their range.
constexpr double kStepOfRange = 1e-4;
/// More are too many for the graphics of phones and of older computers.
constexpr Eigen::Index kMostTriangles = 3'000'000;
/// Attributes that are not drawn as per-vertex values.
constexpr std::array kNotShown{"nx", "ny", "nz", "red", "green", "blue", "alpha"};

/// A number of each vertex.
struct VertexQuantity {
  std::string name;
  ValueRange range;
  double step = 1;
};

/// Properties of all meshes that are needed before the first one is packed.
struct MeshSurvey {
  geometry::TriangleMesh first;
  Eigen::AlignedBox3d box;
  std::vector<VertexQuantity> quantities;  ///< that all meshes have
  bool colors = true;                      ///< true if all meshes have colours
  double step = 1;                         ///< [mm] of coordinates
};

std::vector<std::string> names_of_numbers(const geometry::MeshFile& file) {
  std::vector<std::string> names;
  for (const geometry::Attribute& attribute : file.vertex_attributes) {
    const bool shown = std::ranges::find(kNotShown, attribute.name) == kNotShown.end();
    if (shown && attribute.list_sizes.empty()) names.push_back(attribute.name);
  }
  return names;
}

void check_triangles(const fs::path& path, const geometry::TriangleMesh& mesh,
                     const fs::path& first_path, const geometry::TriangleMesh& first) {
  if (mesh.triangles.cols() == 0)
    throw InvalidInput(path.string() + ": has no triangles; there is no surface to show.");
  if (mesh.triangles.cols() > kMostTriangles || mesh.vertices.cols() > kMostTriangles) {
    throw InvalidInput(fmt::format(
        "{}: has {} vertices and {} triangles; a page shows at most {} of each. palpate mesh "
        "--tolerance simplifies it.",
        path.string(), mesh.vertices.cols(), mesh.triangles.cols(), kMostTriangles));
  }
  if (mesh.vertices.cols() == first.vertices.cols() &&
      mesh.triangles.cols() == first.triangles.cols() && mesh.triangles == first.triangles)
    return;
  throw InvalidInput(
      fmt::format("{}: has {} vertices and {} triangles, not the same as {} ({} and {}). A page "
                  "shows meshes of the same triangles, as palpate track writes them; export these "
                  "one by one.",
                  path.string(), mesh.vertices.cols(), mesh.triangles.cols(), first_path.string(),
                  first.vertices.cols(), first.triangles.cols()));
}

MeshSurvey survey_of(const std::vector<fs::path>& meshes, const geometry::ReadOptions& options) {
  MeshSurvey survey;
  Progress progress("reading");
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const geometry::MeshFile file = geometry::read_mesh_file(meshes[i], options);
    if (i == 0) {
      survey.first = file.mesh;
      for (const std::string& name : names_of_numbers(file))
        survey.quantities.push_back({.name = name, .range = {}});
    }
    check_triangles(meshes[i], file.mesh, meshes.front(), survey.first);
    survey.box.extend(geometry::bounding_box(file.mesh));
    survey.colors &= geometry::colors(file.vertex_attributes).has_value();
    std::erase_if(survey.quantities, [&](VertexQuantity& quantity) {
      const auto values = geometry::scalars(file.vertex_attributes, quantity.name);
      if (values) quantity.range.add({values->data(), static_cast<std::size_t>(values->size())});
      return !values;
    });
    progress.show(i + 1, meshes.size());
  }
  std::erase_if(survey.quantities, [](const VertexQuantity& one) { return one.range.is_empty(); });
  for (VertexQuantity& one : survey.quantities) {
    const double largest = std::max(std::abs(one.range.min()), std::abs(one.range.max()));
    // `round_step` may divide by up to 2.5; codes must have room for the largest number.
    const double most = std::max(kStepOfRange * (one.range.max() - one.range.min()),
                                 2.6 * largest / geometry::kCodeLimit);
    if (most > 0) one.step = geometry::round_step(most);
  }
  if (const double diagonal = survey.box.diagonal().norm(); diagonal > 0)
    survey.step = geometry::round_step(kStepOfDiagonal * diagonal);
  return survey;
}

using NumberRow = Eigen::Array<double, 1, Eigen::Dynamic, Eigen::RowMajor>;

void append(std::vector<std::byte>& bytes, const NumberRow& values, double step) {
  const std::vector<std::byte> more = geometry::pack(geometry::codes_of(values, step));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// The corners of all triangles: first corners, second corners, third corners.
std::vector<std::byte> pack_triangles(const geometry::TriangleMesh& mesh) {
  std::vector<std::byte> bytes;
  for (Eigen::Index corner = 0; corner < 3; ++corner)
    append(bytes, mesh.triangles.row(corner).cast<double>(), 1);
  return bytes;
}

/// x, y and z from the middle of the bounding box, the quantities, and red, green and blue.
std::vector<std::byte> pack_mesh(const geometry::MeshFile& file, const MeshSurvey& survey) {
  constexpr double kColorStep = 1.0 / 255;
  std::vector<std::byte> bytes;
  const Eigen::Vector3d middle = survey.box.center();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    // Vertices that no triangle uses are not drawn, and may be too far away for codes.
    const NumberRow inside = file.mesh.vertices.row(axis)
                                 .array()
                                 .max(survey.box.min()[axis])
                                 .min(survey.box.max()[axis]);
    append(bytes, inside - middle[axis], survey.step);
  }
  for (const VertexQuantity& one : survey.quantities) {
    const Eigen::VectorXd values = geometry::scalars(file.vertex_attributes, one.name).value();
    append(bytes, values.transpose().array(), one.step);
  }
  if (survey.colors) {
    const Eigen::Matrix4Xd colors = geometry::colors(file.vertex_attributes).value();
    for (Eigen::Index channel = 0; channel < 3; ++channel)
      append(bytes, colors.row(channel).array().max(0.0).min(1.0), kColorStep);
  }
  return bytes;
}

/// Returns area and open edges, if the mesh is a surface.
Json measures_of(const geometry::TriangleMesh& mesh) {
  try {
    std::size_t open = 0;
    for (const std::vector<int>& loop : geometry::boundary_loops(mesh)) open += loop.size();
    return {{"area", geometry::surface_area(mesh)}, {"open_edges", open}};
  } catch (const InvalidInput&) {  // edges of more than two triangles, or of turned triangles
    return {{"area", nullptr}, {"open_edges", nullptr}};
  }
}

Json facts_of(const MeshSurvey& survey, const std::vector<fs::path>& meshes) {
  const Eigen::Vector3d middle = survey.box.center(), size = survey.box.diagonal();
  Json facts = {{"vertices", survey.first.vertices.cols()},
                {"triangles", survey.first.triangles.cols()},
                {"step", survey.step},
                {"middle", numbers_in(middle)},
                {"size", numbers_in(size)},
                {"colors", survey.colors},
                {"quantities", Json::array()},
                {"frames", Json::array()}};
  facts.update(measures_of(survey.first));
  for (const VertexQuantity& one : survey.quantities) {
    facts["quantities"].push_back(
        {{"name", one.name}, {"step", one.step}, {"range", one.range.to_json()}});
  }
  for (const fs::path& mesh : meshes)
    facts["frames"].push_back({{"name", mesh.filename().string()}});
  return facts;
}

}  // namespace

std::string write_mesh_page(const fs::path& output, const std::vector<fs::path>& meshes,
                            const geometry::ReadOptions& options, const std::string& title) {
  const MeshSurvey survey = survey_of(meshes, options);
  const std::size_t bytes =
      write_page(output, {.kind = "mesh",
                          .title = title,
                          .facts = facts_of(survey, meshes),
                          .common = pack_triangles(survey.first),
                          .files = meshes,
                          .pack = [&](const fs::path& mesh) {
                            return pack_mesh(geometry::read_mesh_file(mesh, options), survey);
                          }});
  return fmt::format("{} of {} vertices and {} triangles, {}; coordinates are rounded to {:g} mm",
                     counted(meshes.size(), "mesh", "meshes"), survey.first.vertices.cols(),
                     survey.first.triangles.cols(), megabytes(bytes), survey.step);
}

}  // namespace palpate::apps
