// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/fit_shapes.h"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/edge_splitting.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/fit_surface_response.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

// Each shape is read for the fit and for its error.
constexpr std::size_t kReadings = 2;

struct ShapeFile {
  fs::path mesh;
  std::size_t contact;
  Eigen::Vector3d displacement;
};

std::vector<ShapeFile> shape_files(const haptics::Model& model,
                                   const probing::CheckedAcquisition& acquisition,
                                   const fs::path& meshes) {
  std::map<long long, std::size_t> index;
  for (std::size_t i = 0; i < model.contacts.size(); ++i) index[model.contacts[i].id] = i;
  std::vector<ShapeFile> files;
  std::size_t named = 0;
  fs::path missing;
  for (const probing::Sample& sample : acquisition.samples()) {
    const auto contact = index.find(sample.contact);
    if (sample.slipped || !sample.range_map || contact == index.end()) continue;
    ++named;
    const fs::path mesh = meshes / fs::path(*sample.range_map).filename().replace_extension(".ply");
    std::error_code error;
    if (!fs::exists(mesh, error)) {
      missing = mesh;
      continue;
    }
    const Eigen::Vector3d& from =
        acquisition.contacts()[*acquisition.find(sample.contact)].position;
    files.push_back(
        {mesh, contact->second, model.T_surface_acquisition.linear() * (sample.b - from)});
  }
  if (named == 0) {
    throw InvalidInput(
        "--shapes: no sample that held names a range map (range_map of the samples); each must say "
        "which one was recorded while the tool held it");
  }
  if (files.empty()) {
    throw InvalidInput(fmt::format(
        "--shapes: {} samples name a range map, and none has a mesh: there is no {}; expected the "
        "folder that 'palpate track --reference SURFACE' wrote",
        named, missing.string()));
  }
  return files;
}

haptics::RecordedShape read_shape(const ShapeFile& file, const geometry::TriangleMesh& surface,
                                  const Eigen::Matrix2Xi& ends) {
  const geometry::TriangleMesh mesh = geometry::read_mesh(file.mesh);
  if (mesh.vertices.cols() != surface.vertices.cols() || mesh.triangles != surface.triangles) {
    throw FileError(fmt::format(
        "{}: has other triangles than SURFACE ({} vertices, {} there); track the range maps with "
        "--reference SURFACE",
        file.mesh.string(), mesh.vertices.cols(), surface.vertices.cols()));
  }
  return {file.contact, file.displacement, geometry::with_middles(mesh.vertices, ends)};
}

}  // namespace

haptics::SurfaceResponse fit_shapes(const haptics::BuildResult& built,
                                    const geometry::TriangleMesh& surface,
                                    const probing::CheckedAcquisition& acquisition,
                                    const fs::path& meshes) {
  const std::vector<ShapeFile> files = shape_files(built.model, acquisition, meshes);
  Progress bar("reading shapes");
  std::size_t read = 0;
  return haptics::fit_surface_response(built.model, files.size(), [&](std::size_t k) {
    haptics::RecordedShape shape = read_shape(files[k], surface, built.surface_ends);
    bar.show(static_cast<int>(++read), static_cast<int>(kReadings * files.size()));
    return shape;
  });
}

std::string shapes_in_words(const std::optional<haptics::SurfaceResponse>& response) {
  if (!response) return {};
  return fmt::format(
      "The surface follows the tool as in {} recorded shapes, {:.2f} mm RMS from them, {:.1f} mm "
      "at most. ",
      response->shape_contacts.size(), response->rms, response->largest);
}

}  // namespace palpate::apps
