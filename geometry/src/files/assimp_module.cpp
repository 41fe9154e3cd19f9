// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `assimp`.
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/assimp_files.h"
#include "files/gltf_colors.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// Accumulates the parts of a scene.
struct Scene {
  PolygonMesh mesh;
  std::array<std::vector<float>, 3> normals;
  std::array<std::vector<float>, 4> colors;
};

void append_vertices(const aiMesh& part, const aiMatrix4x4& transform, Scene& scene) {
  // Normals are transformed by the inverse transpose, so that they stay perpendicular to a surface
  // that is stretched.
  aiMatrix3x3 of_normals(transform);
  of_normals.Inverse().Transpose();
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D vertex = transform * part.mVertices[i];
    scene.mesh.vertices.emplace_back(vertex.x, vertex.y, vertex.z);
    if (part.HasNormals()) {
      aiVector3D normal = of_normals * part.mNormals[i];
      normal.NormalizeSafe();
      for (unsigned axis = 0; axis < 3; ++axis) scene.normals[axis].push_back(normal[axis]);
    }
    if (part.HasVertexColors(0))
      for (unsigned channel = 0; channel < 4; ++channel)
        scene.colors[channel].push_back(part.mColors[0][i][channel]);
  }
}

void append_part(const aiMesh& part, const aiMatrix4x4& transform, Scene& scene) {
  PolygonMesh& mesh = scene.mesh;
  const auto first = static_cast<std::int64_t>(mesh.vertices.size());
  append_vertices(part, transform, scene);
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

void append_node(const aiScene& whole, const aiNode& node, const aiMatrix4x4& parent,
                 Scene& scene) {
  const aiMatrix4x4 transform = parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    append_part(*whole.mMeshes[node.mMeshes[i]], transform, scene);
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    append_node(whole, *node.mChildren[i], transform, scene);
}

/// Keeps columns that have a value for every vertex.
template <std::size_t N>
void take_columns(const std::array<const char*, N>& names,
                  std::array<std::vector<float>, N>& columns, PolygonMesh& mesh) {
  for (std::size_t i = 0; i < N; ++i)
    if (!columns[i].empty() && columns[i].size() == mesh.vertices.size())
      mesh.vertex_attributes.push_back({names[i], std::move(columns[i]), {}});
}

PolygonMesh read(const fs::path& path, std::string_view content, const std::string& ending) {
  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(ending))
    throw Unavailable(path.string() + ": this build of Assimp does not read " + ending);
  // Validate first, because assimp's other steps trust the indices in the file.
  constexpr unsigned kSteps = aiProcess_ValidateDataStructure;
  std::error_code ignored;
  const aiScene* whole =
      fs::is_regular_file(path, ignored) && !path.extension().empty()
          ? importer.ReadFile(path.string(), kSteps)
          : importer.ReadFileFromMemory(content.data(), content.size(), kSteps, ending.c_str() + 1);
  if (whole == nullptr)
    throw FileError(path.string() + ": is damaged or truncated: " + importer.GetErrorString());
  Scene scene;
  append_node(*whole, *whole->mRootNode, aiMatrix4x4(), scene);
  if (ending == ".glb" || ending == ".gltf") {
    for (std::vector<float>& channel : std::span(scene.colors).first<3>())
      for (float& value : channel) value = static_cast<float>(srgb_value(value));
  }
  take_columns<3>({"nx", "ny", "nz"}, scene.normals, scene.mesh);
  take_columns<4>({"red", "green", "blue", "alpha"}, scene.colors, scene.mesh);
  return std::move(scene.mesh);
}

constexpr float kMillimetre = 1e-3F;  // [m] glTF is in metres

aiVector3D vector_of(const Eigen::Vector3d& from) {
  return {static_cast<float>(from.x()), static_cast<float>(from.y()), static_cast<float>(from.z())};
}

// The destructors of assimp's classes free what their members point to.
std::unique_ptr<aiMesh> mesh_of(const GlbMesh& file) {
  auto part = std::make_unique<aiMesh>();
  part->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  const Eigen::Matrix3Xd& vertices = file.mesh.vertices;
  part->mNumVertices = static_cast<unsigned>(vertices.cols());
  part->mVertices = new aiVector3D[part->mNumVertices];
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    part->mVertices[v] = vector_of(vertices.col(v)) * kMillimetre;
  if (const auto& normal = file.normals) {
    part->mNormals = new aiVector3D[part->mNumVertices];
    for (Eigen::Index v = 0; v < vertices.cols(); ++v)
      part->mNormals[v] = vector_of(normal->col(v).normalized());
  }
  if (const auto& color = file.colors) {
    part->mColors[0] = new aiColor4D[part->mNumVertices];
    for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
      Eigen::Vector4f rgba = color->col(v).cast<float>();
      rgba.head<3>() = color->col(v).head<3>().unaryExpr(&linear_intensity).cast<float>();
      part->mColors[0][v] = {rgba[0], rgba[1], rgba[2], rgba[3]};
    }
  }
  part->mNumFaces = static_cast<unsigned>(file.mesh.triangles.cols());
  part->mFaces = new aiFace[part->mNumFaces];
  for (unsigned t = 0; t < part->mNumFaces; ++t) {
    aiFace& face = part->mFaces[t];
    face.mNumIndices = 3;
    face.mIndices = new unsigned[3];
    for (unsigned k = 0; k < 3; ++k)
      face.mIndices[k] = static_cast<unsigned>(
          file.mesh.triangles(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)));
  }
  return part;
}

template <typename T>
T** array_of(std::unique_ptr<T> only) {
  auto** array = new T*[1];
  array[0] = only.release();
  return array;
}

void write_glb(std::ostream& stream, const GlbMesh& file, const char* what) {
  aiScene scene;
  scene.mMaterials = array_of(std::make_unique<aiMaterial>());
  scene.mNumMaterials = 1;
  scene.mMeshes = array_of(mesh_of(file));
  scene.mNumMeshes = 1;
  auto root = std::make_unique<aiNode>();
  root->mMeshes = new unsigned[1]{0};
  root->mNumMeshes = 1;
  scene.mRootNode = root.release();
  Assimp::Exporter exporter;
  const aiExportDataBlob* const blob = exporter.ExportToBlob(&scene, "glb2", 0U);
  if (blob == nullptr)
    throw OutputError(std::string(what) + ": cannot be written: " + exporter.GetErrorString());
  stream.write(static_cast<const char*>(blob->data), static_cast<std::streamsize>(blob->size));
}

}  // namespace
}  // namespace palpate::geometry

const palpate::geometry::AssimpFiles palpate_assimp{
    .read = &palpate::geometry::read,
    .write_glb = &palpate::geometry::write_glb,
};
