// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_io.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <array>
#include <assimp/Importer.hpp>
#include <cstddef>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "input_file.h"
#include "obj.h"
#include "palpate/error.h"
#include "palpate/output_file.h"
#include "pcd.h"
#include "ply.h"
#include "polygon_mesh.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

void append_part(const aiMesh& part, const aiMatrix4x4& transform, PolygonMesh& mesh) {
  const auto first = static_cast<std::int64_t>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D vertex = transform * part.mVertices[i];
    mesh.vertices.emplace_back(vertex.x, vertex.y, vertex.z);
  }
  const bool mirrored = transform.Determinant() < 0;
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices < 3) continue;  // points and lines
    for (unsigned corner = 0; corner < face.mNumIndices; ++corner)
      mesh.corners.push_back(
          first + std::int64_t{face.mIndices[mirrored ? face.mNumIndices - 1 - corner : corner]});
    mesh.sizes.push_back(static_cast<int>(face.mNumIndices));
  }
}

void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent,
                 PolygonMesh& mesh) {
  const aiMatrix4x4 transform = parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    append_part(*scene.mMeshes[node.mMeshes[i]], transform, mesh);
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    append_node(scene, *node.mChildren[i], transform, mesh);
}

/// A format that lists the corners of every face anew loses which faces are neighbours. Exactly
/// equal places tell it again; near ones are left alone, as only the user can say what near is.
void join_corners(PolygonMesh& mesh) {
  if (mesh.vertices.size() != mesh.corners.size()) return;
  std::map<std::array<double, 3>, std::int64_t> index_of;
  std::vector<Eigen::Vector3d> vertices;
  for (std::int64_t& corner : mesh.corners) {
    const Eigen::Vector3d& vertex = mesh.vertices[static_cast<std::size_t>(corner)];
    if (!vertex.allFinite()) return;  // NaN has no order; the check that follows names the vertex
    const auto [place, is_new] = index_of.try_emplace({vertex.x(), vertex.y(), vertex.z()},
                                                      static_cast<std::int64_t>(vertices.size()));
    if (is_new) vertices.push_back(vertex);
    corner = place->second;
  }
  mesh.vertices = std::move(vertices);
}

PolygonMesh read_with_assimp(const fs::path& path) {
  static_cast<void>(read_input_file(path));  // for its clear messages
  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(path.extension().string()))
    throw FileError(path.string() + ": the ending \"" + path.extension().string() +
                    "\" is not that of a mesh; .ply, .obj, .stl, .off or .glb is");
  // Validation first: assimp's other steps trust the indices in the file.
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_ValidateDataStructure);
  if (scene == nullptr)
    throw FileError(path.string() + ": is damaged or truncated: " + importer.GetErrorString());
  PolygonMesh mesh;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
  join_corners(mesh);
  return mesh;
}

PolygonMesh read_polygons(const fs::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".ply") return read_ply(path);
  if (extension == ".obj") return read_obj(path);
  return read_with_assimp(path);
}

}  // namespace

TriangleMesh read_mesh(const fs::path& path) {
  if (lower_extension(path) == ".pcd")
    throw FileError(path.string() + ": holds points without a surface; a mesh is needed");
  return triangulate(read_polygons(path), path.string());
}

Eigen::Matrix3Xd read_points(const fs::path& path) {
  if (lower_extension(path) == ".pcd") return read_pcd(path);
  const PolygonMesh mesh = read_polygons(path);
  if (mesh.vertices.empty()) throw FileError(path.string() + ": holds no points");
  return vertex_matrix(mesh);
}

void write_mesh(const fs::path& path, const TriangleMesh& mesh) {
  const std::string extension = lower_extension(path);
  if (extension != ".ply" && extension != ".obj")
    throw InvalidInput(path.string() + ": a mesh is written as .ply or .obj, not as \"" +
                       path.extension().string() + "\"");
  check_mesh(mesh, path.string().c_str());
  write_file(path, [&](std::ostream& stream) {
    if (extension == ".ply")
      write_ply(stream, mesh);
    else
      write_obj(stream, mesh);
  });
}

}  // namespace palpate::geometry
