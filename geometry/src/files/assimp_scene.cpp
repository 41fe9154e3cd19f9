// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_formats.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/input_file.h"
#include "palpate/error.h"
#include "palpate/file_names.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

constexpr double kMetre = 1000;  // [mm]

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

/// Assimp takes memory for all elements of a sparse accessor of glTF, though the file may have few.
/// \throws FileError if that is beyond the limit.
void check_sparse_accessors(std::string_view json, std::size_t file_size, const std::string& file) {
  if (json.find("\"sparse\"") == std::string_view::npos) return;
  constexpr std::string_view kCount = "\"count\"";
  constexpr double kElement = 64;  // [bytes] the largest, a matrix of 4 x 4 floats
  double needed = 0;
  for (std::size_t at = json.find(kCount); at != std::string_view::npos;
       at = json.find(kCount, at)) {
    at = std::min(json.find_first_not_of(": \t\r\n", at + kCount.size()), json.size());
    double count = 0;
    std::from_chars(json.data() + at, json.data() + json.size(), count);
    needed += kElement * count;
  }
  check_memory_to_read(needed, static_cast<double>(file_size), file);
}

/// Returns the JSON of a binary glTF file. Assimp believes the lengths in it, and takes up to 4 GB
/// for each.
/// \throws FileError if they are not those of the file.
std::string_view checked_glb_json(std::string_view bytes, const std::string& file) {
  constexpr std::size_t kChunkFrame = 8;                  // length, type
  constexpr std::size_t kFirstChunk = 12, kLengthAt = 8;  // after magic, version, length
  if (bytes.size() < kFirstChunk || !bytes.starts_with("glTF"))
    throw FileError(file +
                    ": does not begin with glTF and its length, as a binary glTF file does: it is "
                    "damaged or of another format");
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;)
      value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
    return std::size_t{value};
  };
  const auto check = [&](const char* what, std::size_t from, std::size_t length) {
    if (length <= bytes.size() - from) return;
    throw FileError(file + ": says that " + what + " has " + std::to_string(length) +
                    " bytes; the file has " + std::to_string(bytes.size() - from) +
                    " there: it is damaged or truncated");
  };
  check("the file", 0, word(kLengthAt));
  for (std::size_t at = kFirstChunk; bytes.size() - at >= kChunkFrame;) {
    const std::size_t length = word(at);
    at += kChunkFrame;
    check("a part of it", at, length);
    at += length;
  }
  if (bytes.size() - kFirstChunk < kChunkFrame) return {};
  return bytes.substr(kFirstChunk + kChunkFrame, word(kFirstChunk));
}

}  // namespace

PolygonMesh read_assimp_scene(const fs::path& path, std::string_view content,
                              const std::string& ending) {
  if (ending == ".glb" || ending == ".gltf") {
    const std::string file = path.string();
    check_sparse_accessors(ending == ".glb" ? checked_glb_json(content, file) : content,
                           content.size(), file);
  }
  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(ending))
    throw FileError(path.string() + ": the ending \"" + path.extension().string() +
                    "\" is not that of a mesh; .ply, .obj, .stl, .off or .glb is");
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
  take_columns<3>({"nx", "ny", "nz"}, scene.normals, scene.mesh);
  take_columns<4>({"red", "green", "blue", "alpha"}, scene.colors, scene.mesh);
  if (ending == ".gltf" || ending == ".glb") scene.mesh.unit = kMetre;
  join_corners(scene.mesh);
  return std::move(scene.mesh);
}

}  // namespace palpate::geometry
