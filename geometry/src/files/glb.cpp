// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <assimp/scene.h>
#include <assimp/Exporter.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <utility>

#include "files/file_formats.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr float kMillimetre = 1e-3F;  // [m] glTF is in metres

aiVector3D vector_of(const Eigen::Vector3d& from) {
  return {static_cast<float>(from.x()), static_cast<float>(from.y()), static_cast<float>(from.z())};
}

// The destructors of assimp's classes free what their members point to.
std::unique_ptr<aiMesh> mesh_of(const MeshFile& file) {
  auto part = std::make_unique<aiMesh>();
  part->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  const Eigen::Matrix3Xd& vertices = file.mesh.vertices;
  part->mNumVertices = static_cast<unsigned>(vertices.cols());
  part->mVertices = new aiVector3D[part->mNumVertices];
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    part->mVertices[v] = vector_of(vertices.col(v)) * kMillimetre;
  if (const auto normal = normals(file.vertex_attributes)) {
    part->mNormals = new aiVector3D[part->mNumVertices];
    for (Eigen::Index v = 0; v < vertices.cols(); ++v)
      part->mNormals[v] = vector_of(normal->col(v).normalized());
  }
  if (const auto color = colors(file.vertex_attributes)) {
    part->mColors[0] = new aiColor4D[part->mNumVertices];
    for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
      const Eigen::Vector4f rgba = color->col(v).cast<float>();
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

}  // namespace

void write_glb(std::ostream& stream, const MeshFile& file, const char* what) {
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

}  // namespace palpate::geometry
