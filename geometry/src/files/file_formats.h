// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>

#include "files/polygon_mesh.h"
#include "palpate/geometry/mesh_io.h"

// Readers and writers of the file formats, each in the source file of its name. `mesh_io` chooses
// one by the extension, or by the content of a pipe without one. Readers leave coordinates in the
// unit of the file.
namespace palpate::geometry {

/// Reads PLY: text or binary in either byte order, with coordinates and indices of any type. All
/// properties of vertices and faces are kept; elements other than vertex, face and tristrips are
/// skipped, and so are face attributes if there are tristrips. Assimp is not used because it stores
/// coordinates in float.
/// \throws FileError naming `file` if it is not valid, or truncated (saying how much is there).
[[nodiscard]] PolygonMesh read_ply(std::string_view content, const std::string& file);

/// Writes coordinates and attributes in their types; no faces if there are no triangles.
/// \throws InvalidInput naming `what` if an attribute has a name that PLY reserves, or a type that
/// PLY does not have.
void write_ply(std::ostream& stream, const MeshFile& file, const WriteOptions& options,
               const char* what);

/// Reads the vertices and faces of a Wavefront OBJ file, its comments, colours and normals if
/// every vertex has exactly one, texture coordinates and names of materials. Groups are skipped.
/// Assimp is not used because it stores coordinates in float and gives every corner of every face
/// its own vertex.
/// \throws FileError naming the line if a vertex or a face is wrong.
[[nodiscard]] PolygonMesh read_obj(std::string_view content, const std::string& file);

/// Writes text with enough digits to read back the same numbers: vertices with their colours,
/// normals, triangles, texture coordinates, names of materials.
void write_obj(std::ostream& stream, const MeshFile& file);

/// Reads binary or text STL; corners at exactly the same place become one vertex. Normals and
/// attribute bytes are skipped. Assimp is not used because it rounds the numbers of text files.
/// \throws FileError naming the triangle or line that is not valid, or if the file is truncated.
[[nodiscard]] PolygonMesh read_stl(std::string_view content, const std::string& file);

/// Returns true if the content has the size that a binary STL file declares. Many begin with
/// "solid" as texts do.
[[nodiscard]] bool is_binary_stl(std::string_view content);

/// Writes binary (float) or text (enough digits to read back the same numbers), with the normals of
/// the triangles (zero for zero area). Precondition: binary coordinates are in the range of float.
void write_stl(std::ostream& stream, const TriangleMesh& mesh, Encoding encoding);

/// Writes binary glTF: one part, in metres and float, with normals and colours (linear in the
/// light, as the format demands) if there are any.
/// \throws OutputError naming `what` if assimp cannot; Unavailable without assimp.
void write_glb(std::ostream& stream, const MeshFile& file, const char* what);

/// Writes a binary VTK file (legacy, version 3): POLYDATA in double, with attributes as fields;
/// lists and comments are left out. VTK's own writer is not used because geometry does not depend
/// on VTK.
void write_vtk(std::ostream& stream, const MeshFile& file);

/// Reads text OFF with its comments. Colours and normals are read if the first word declares them
/// (COFF, NOFF, CNOFF, with or without ST) and every vertex has them; data after a face is skipped.
/// Assimp is not used because it silently replaces an invalid index by a valid one.
/// \throws FileError naming the line if a vertex or a face is wrong, or if the file is truncated.
[[nodiscard]] PolygonMesh read_off(std::string_view content, const std::string& file);

/// Reads glTF (in metres) and all other formats of assimp, in float. The parts of a scene are
/// combined at their positions, with normals and colours if all parts have them.
/// \param content read from `path`. The file itself is read again, with those that it names, unless
/// it is a pipe.
/// \param ending of the format, such as ".glb".
/// \throws FileError if the file is damaged, or the ending not that of a mesh; Unavailable without
/// assimp.
[[nodiscard]] PolygonMesh read_assimp_scene(const std::filesystem::path& path,
                                            std::string_view content, const std::string& ending);

/// Reads all fields of a PCD file (text, binary or compressed) except padding; unknown points stay
/// NaN. Coordinates are in the unit of the file, and all comments are kept. PCL's reader is not
/// used because its library depends on VTK.
/// \throws FileError naming `file` if it is not valid, or truncated (saying how much is there).
[[nodiscard]] PointCloud read_pcd(std::string_view content, const std::string& file);

/// Writes text or little-endian binary.
/// \throws InvalidInput naming `what` if an attribute has the name of a coordinate, or consists of
/// lists of different lengths.
void write_pcd(std::ostream& stream, const PointCloud& cloud, const WriteOptions& options,
               const char* what);

}  // namespace palpate::geometry
