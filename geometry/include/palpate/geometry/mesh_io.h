// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/geometry/attribute.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// [mm] Length of a unit by its name or sign: um, mm, cm, m or in.
/// \throws InvalidInput for another word.
[[nodiscard]] double unit_length(std::string_view name);

struct ReadOptions {
  /// [mm] what one unit of the file's coordinates is; > 0 and finite. Not given: what the file
  /// declares, which is metres in glTF, and elsewhere a comment such as "unit mm" or "units: in";
  /// and 1 where it declares nothing.
  std::optional<double> unit;
  /// Meshes: also read one that `check_mesh` refuses, for `find_defects` and `repair_mesh`. Corners
  /// that name no vertex are then as in the file (-1 beyond the range of int); a face of one or two
  /// corners is a triangle that repeats its last one.
  bool keep_defects = false;
};

/// How the unit of a file was found: from ReadOptions, from the file, or not at all (mm).
enum class UnitSource { stated, declared, assumed };

struct FileUnit {
  double length = 1;  ///< [mm] what one unit of the file's coordinates is
  UnitSource source = UnitSource::assumed;
};

/// What a mesh file holds.
struct MeshFile {
  TriangleMesh mesh;                  ///< [mm]
  Attributes vertex_attributes;       ///< lengths among them are as in the file
  Attributes triangle_attributes;     ///< of a polygon: each of its triangles has them
  std::vector<std::string> comments;  ///< one a line, without one that declares a unit
  FileUnit unit;                      ///< of the file that was read; files are written in mm
};

/// What a file of points holds. Points of a depth camera are organised: the point of column u and
/// row v is number v * width + u, as `back_project` gives them.
struct PointCloud {
  Eigen::Matrix3Xd points;  ///< [mm] 3 x N; NaN where unknown
  Eigen::Index width = 0;   ///< width * height = N
  Eigen::Index height = 1;  ///< 1 if the points are not organised
  Attributes attributes;
  std::vector<std::string> comments;  ///< as in MeshFile
  FileUnit unit;                      ///< as in MeshFile
};

/// `binary` has its least significant byte first.
enum class Encoding { binary, binary_big_endian, text };

struct WriteOptions {
  Encoding encoding = Encoding::binary;  ///< OBJ is text whatever this says
  /// PLY, PCD: write coordinates and attributes of type double as float, as many programs expect
  /// (those built on PCL read no other coordinates). Rounds, and halves the file.
  bool single_precision = false;
};

/// Reads a surface; the ending of `path` says which format it is. Polygons are cut into triangles;
/// a triangle that uses a vertex twice is left out.
///
/// Coordinates are read to the last digit, and vertices and their order are those of the file.
/// What else is kept: PLY: all properties of vertices and faces, and comments; elements other than
/// vertex, face and tristrips are skipped. OBJ: normals and colours, if every vertex has exactly
/// one; comments. OFF: normals and colours of vertices; comments.
///
/// STL shares no vertices: corners at exactly the same place become one. Its attribute bytes are
/// skipped. glTF and whatever else assimp knows are read in float; the parts of a scene are put
/// together as it places them, with normals and colours if all parts have them. Where no two
/// triangles share a vertex, equal corners become one there too, and lose normals and colours. Some
/// damage assimp may mend without a word.
/// \throws FileError if the file is missing, truncated, empty, not a mesh, or holds a bad index or
/// a vertex that is not finite; InvalidInput for a bad option.
[[nodiscard]] MeshFile read_mesh_file(const std::filesystem::path& path,
                                      const ReadOptions& options = {});

/// The same, the surface alone.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path,
                                     const ReadOptions& options = {});

/// Reads points: PCD (text, binary or compressed; all fields, but not the viewpoint) or the
/// vertices of any mesh file. PLY, OBJ and OFF need no faces. Unknown points (NaN) are kept.
/// \throws FileError as `read_mesh_file`, or if there is no point; InvalidInput for a bad option.
[[nodiscard]] PointCloud read_point_cloud(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// The same, the points alone, 3 x N [mm].
[[nodiscard]] Eigen::Matrix3Xd read_points(const std::filesystem::path& path,
                                           const ReadOptions& options = {});

/// Writes by the ending of `path`, and declares mm in a comment. What is read back has the same
/// bits, unless the format has no place for it:
/// .ply: everything, coordinates as float64; `text` and both byte orders.
/// .obj: text; vertices, triangles, normals, colours from 0 to 1, comments.
/// .stl: triangles alone; `binary` (coordinates are rounded to float) or `text` (not rounded).
/// \throws InvalidInput for another ending or encoding, a bad mesh, attribute or comment, or
/// numbers beyond the range of float where they have to fit it; OutputError.
void write_mesh_file(const std::filesystem::path& path, const MeshFile& file,
                     const WriteOptions& options = {});

/// The same, the surface alone.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                const WriteOptions& options = {});

/// Writes .pcd (`binary` or `text`; normals and colours, where these are bytes, as PCL calls and
/// packs them) or .ply (as a mesh without faces, which is not organised), with all attributes. PCD
/// holds lists only if all have one size, PLY no integers of 64 bits.
/// \throws InvalidInput for another ending or encoding, a bad size, attribute or comment, or
/// numbers beyond the range of float where they have to fit it; OutputError.
void write_point_cloud(const std::filesystem::path& path, const PointCloud& cloud,
                       const WriteOptions& options = {});

}  // namespace palpate::geometry
