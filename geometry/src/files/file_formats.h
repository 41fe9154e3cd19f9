// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>

#include "files/polygon_mesh.h"
#include "palpate/geometry/mesh_io.h"

// Readers and writers of the file formats, each in the source file of its name. `mesh_io` chooses
// one by the extension. Readers leave coordinates in the unit of the file.
namespace palpate::geometry {

/// Reads PLY: text or binary in either byte order, with coordinates and indices of any type. All
/// properties of vertices and faces are kept; elements other than vertex, face and tristrips are
/// skipped, and so are face attributes if there are tristrips. Assimp is not used because it stores
/// coordinates in float.
/// \throws FileError if the file is missing, not valid, or truncated (saying how much is there).
[[nodiscard]] PolygonMesh read_ply(const std::filesystem::path& path);

/// Writes coordinates and attributes in their types; no faces if there are no triangles.
/// \throws InvalidInput naming `what` if an attribute has a name that PLY reserves, or a type that
/// PLY does not have.
void write_ply(std::ostream& stream, const MeshFile& file, const WriteOptions& options,
               const char* what);

/// Reads the vertices and faces of a Wavefront OBJ file, its comments, and colours and normals if
/// every vertex has exactly one. Other content (textures, groups, materials) is skipped. Assimp is
/// not used because it stores coordinates in float and gives every corner of every face its own
/// vertex.
/// \throws FileError naming the line if a vertex or a face is wrong.
[[nodiscard]] PolygonMesh read_obj(const std::filesystem::path& path);

/// Writes text with enough digits to read back the same numbers: vertices with their colours,
/// normals, triangles.
void write_obj(std::ostream& stream, const MeshFile& file);

/// Reads binary or text STL; corners at exactly the same place become one vertex. Normals and
/// attribute bytes are skipped. Assimp is not used because it rounds the numbers of text files.
/// \throws FileError naming the triangle or line that is not valid, or if the file is truncated.
[[nodiscard]] PolygonMesh read_stl(const std::filesystem::path& path);

/// Writes binary (float) or text (enough digits to read back the same numbers), with the normals of
/// the triangles (zero for zero area). Precondition: binary coordinates are in the range of float.
void write_stl(std::ostream& stream, const TriangleMesh& mesh, Encoding encoding);

/// Writes binary glTF: one part, in metres and float, with normals and colours if there are any.
/// \throws OutputError naming `what` if assimp cannot.
void write_glb(std::ostream& stream, const MeshFile& file, const char* what);

/// Writes a binary VTK file (legacy, version 3): POLYDATA in double, with attributes as fields;
/// lists and comments are left out. VTK's own writer is not used because geometry does not depend
/// on VTK.
void write_vtk(std::ostream& stream, const MeshFile& file);

/// Reads text OFF with its comments. Colours and normals are read if the first word announces them
/// (COFF, NOFF, CNOFF, with or without ST) and every vertex has them; data after a face is skipped.
/// Assimp is not used because it silently replaces an invalid index by a valid one.
/// \throws FileError naming the line if a vertex or a face is wrong, or if the file is truncated.
[[nodiscard]] PolygonMesh read_off(const std::filesystem::path& path);

/// Reads glTF (in metres) and all other formats of assimp, in float. The parts of a scene are
/// combined at their positions, with normals and colours if all parts have them.
/// \throws FileError if the file is missing, empty, damaged, or has an unknown extension.
[[nodiscard]] PolygonMesh read_assimp_scene(const std::filesystem::path& path);

/// Reads all fields of a PCD file (text, binary or compressed) except padding; unknown points stay
/// NaN. Coordinates are in the unit of the file, and all comments are kept. PCL's reader is not
/// used because its library depends on VTK.
/// \throws FileError if the file is missing, not valid, or truncated (saying how much is there).
[[nodiscard]] PointCloud read_pcd(const std::filesystem::path& path);

/// Writes text or little-endian binary.
/// \throws InvalidInput naming `what` if an attribute has the name of a coordinate, or consists of
/// lists of different lengths.
void write_pcd(std::ostream& stream, const PointCloud& cloud, const WriteOptions& options,
               const char* what);

}  // namespace palpate::geometry
