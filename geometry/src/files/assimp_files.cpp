// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The checks before assimp reads a file, and the conversion of its result.
#include "files/assimp_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "files/file_formats.h"
#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/core/module.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

constexpr double kMetre = 1000;  // [mm]

/// Endings of formats that assimp 5 reads as meshes and this library by itself does not. They are
/// listed here, not asked of assimp, so that a build without it refuses the same files. Assimp also
/// claims .step and .stp, of which it reads buildings (IFC) alone.
constexpr auto kAssimpEndings = std::to_array<std::string_view>(
    {".3d",  ".3ds",   ".3mf",  ".ac",   ".ac3d", ".acc",     ".amf",       ".ase",     ".ask",
     ".b3d", ".blend", ".bsp",  ".bvh",  ".cob",  ".csm",     ".dae",       ".dxf",     ".enff",
     ".fbx", ".glb",   ".gltf", ".hmp",  ".ifc",  ".ifczip",  ".iqm",       ".irr",     ".irrmesh",
     ".lwo", ".lws",   ".lxo",  ".md2",  ".md3",  ".md5anim", ".md5camera", ".md5mesh", ".mdc",
     ".mdl", ".mesh",  ".mot",  ".ms3d", ".ndo",  ".nff",     ".ogex",      ".pk3",     ".pmx",
     ".prj", ".q3o",   ".q3s",  ".raw",  ".scn",  ".sib",     ".smd",       ".ter",     ".uc",
     ".vta", ".x",     ".x3d",  ".x3db", ".xgl",  ".xml",     ".zae",       ".zgl"});

/// Endings of files of solids with curved faces.
constexpr auto kSolidEndings =
    std::to_array<std::string_view>({".step", ".stp", ".iges", ".igs", ".brep"});

/// \throws FileError unless assimp reads files of this ending.
void check_ending(const fs::path& path, std::string_view ending) {
  if (std::ranges::find(kAssimpEndings, ending) != kAssimpEndings.end()) return;
  const std::string found =
      path.string() + ": the ending \"" + path.extension().string() + "\" is not that of a mesh; ";
  if (std::ranges::find(kSolidEndings, ending) != kSolidEndings.end())
    throw FileError(found +
                    "such files hold solids with curved faces. Write triangles in the "
                    "program that made the file: .stl, .obj or .ply");
  throw FileError(found +
                  ".ply, .obj, .stl and .off are, .pcd is that of a point cloud, and with "
                  "Assimp .glb, .gltf, .3mf, .dae, .fbx and others are those of meshes");
}

/// \throws Unavailable naming `file` and the package.
const AssimpFiles& assimp_files(const std::string& file) {
  try {
    static const void* const files = module_symbol("assimp");
    return *static_cast<const AssimpFiles*>(files);
  } catch (const Unavailable& error) {
    throw Unavailable(file +
                      ": this format needs Assimp (package libassimp5, to build: libassimp-dev); "
                      ".ply, .obj and .stl do not. " +
                      error.what());
  }
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

/// Returns the JSON of a binary glTF file. Assimp trusts the lengths in it, and takes up to 4 GB
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
  check_ending(path, ending);
  if (ending == ".glb" || ending == ".gltf") {
    const std::string file = path.string();
    check_sparse_accessors(ending == ".glb" ? checked_glb_json(content, file) : content,
                           content.size(), file);
  }
  PolygonMesh mesh = assimp_files(path.string()).read(path, content, ending);
  if (ending == ".gltf" || ending == ".glb") mesh.unit = kMetre;
  join_corners(mesh);
  return mesh;
}

void write_glb(std::ostream& stream, const MeshFile& file, const char* what) {
  assimp_files(what).write_glb(stream,
                               {.mesh = file.mesh,
                                .normals = normals(file.vertex_attributes),
                                .colors = colors(file.vertex_attributes)},
                               what);
}

}  // namespace palpate::geometry
