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

/// [mm] Length of a unit given by name: um, mm, cm, m or in.
/// \throws InvalidInput for any other word.
[[nodiscard]] double unit_length(std::string_view name);

struct ReadOptions {
  /// [mm] length of one unit of the file's coordinates; > 0 and finite. Default: the unit that the
  /// file declares, which is metres for glTF and otherwise a comment such as "unit mm" or
  /// "units: in"; 1 if it declares none.
  std::optional<double> unit;
  /// For meshes: also read a mesh that `check_mesh` rejects, for `find_defects` and `repair_mesh`.
  /// Corners keep the indices of the file even if there is no such vertex (-1 beyond the range of
  /// int); a face of one or two corners becomes a triangle that repeats its last corner.
  bool keep_defects = false;
};

/// Source of the unit of a file: ReadOptions, the file, or neither (assumed mm).
enum class UnitSource { stated, declared, assumed };

struct FileUnit {
  double length = 1;  ///< [mm] length of one unit of the file's coordinates
  UnitSource source = UnitSource::assumed;
};

/// Content of a mesh file.
struct MeshFile {
  TriangleMesh mesh;                  ///< [mm]
  Attributes vertex_attributes;       ///< lengths in attributes keep the unit of the file
  Attributes triangle_attributes;     ///< a polygon passes them on to each of its triangles
  std::vector<std::string> comments;  ///< one per line, without those that declare a unit
  FileUnit unit;                      ///< unit of the file that was read; files are written in mm
  std::vector<std::string> material_files = {};  ///< OBJ: of `mtllib`, relative to the file
  std::vector<std::string> materials = {};       ///< OBJ: of `usemtl`, see `CornerTexture::number`
};

/// Content of a point file. Clouds of a depth camera are organised: the point of column u and row v
/// has the index v * width + u, as in `back_project`.
struct PointCloud {
  Eigen::Matrix3Xd points;  ///< [mm] 3 x N; NaN where unknown
  Eigen::Index width = 0;   ///< width * height = N
  Eigen::Index height = 1;  ///< 1 if the points are not organised
  Attributes attributes;
  std::vector<std::string> comments;  ///< as in MeshFile
  FileUnit unit;                      ///< as in MeshFile
};

/// `binary` is little-endian.
enum class Encoding { binary, binary_big_endian, text };

struct WriteOptions {
  Encoding encoding = Encoding::binary;  ///< OBJ is always text
  /// PLY, PCD: write coordinates and attributes of type double as float, as many programs expect
  /// (programs built on PCL read no other coordinates). This rounds, and halves the file size.
  bool single_precision = false;
};

/// Reads a mesh; the extension of `path` determines the format. If there is none, as for /dev/stdin
/// and other pipes, the content does (PLY, OBJ, STL, OFF or binary glTF). Polygons are
/// triangulated, and triangles that use a vertex twice are left out. Coordinates are read to the
/// last digit; vertices keep their order.
///
/// Other content, by format:
/// - PLY: all properties of vertices and faces, and comments; elements other than vertex, face and
///   tristrips are skipped. A list `texcoord` of a polygon is divided among its triangles.
/// - OBJ: normals and colours, if every vertex has exactly one; texture coordinates of corners (see
///   `corner_texture`) and the names of materials; comments.
/// - OFF: normals and colours of vertices; comments.
/// - STL: has no shared vertices, so exactly equal corners are joined. Attribute bytes are skipped.
/// - glTF and other formats of assimp: read in float. The parts of a scene are combined at their
///   positions, with normals and colours if all parts have them. If no two triangles share a
///   vertex, exactly equal corners are joined and lose normals and colours. Assimp may repair some
///   damage without a message. Colours of glTF are linear in the light; they become those of sRGB,
///   as other formats have them, and linear again when written.
/// All formats but glTF and others of assimp take at most 64 times the size of the file as memory.
/// Sizes that glTF declares are checked against the limit of `memory_limit.h`. Other formats of
/// assimp have no limit: only assimp learns how much a compressed file (FBX, 3MF, X, BLEND, ZGL)
/// holds, and it offers no check.
/// \throws FileError if the file is missing, truncated, empty or not a mesh, or has a bad index or
/// a vertex that is not finite.
/// \throws InvalidInput if an option is not valid.
[[nodiscard]] MeshFile read_mesh_file(const std::filesystem::path& path,
                                      const ReadOptions& options = {});

/// The same, without attributes, comments and unit.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path,
                                     const ReadOptions& options = {});

/// Reads points: PCD (text, binary or compressed; all fields, but not the viewpoint) or the
/// vertices of any mesh file, also through pipes. PLY, OBJ and OFF need not have faces. Unknown
/// points (NaN) are kept. Compressed PCD takes at most 64 times the size of the file and 512 MB.
/// \throws FileError as `read_mesh_file`, or if there are no points.
/// \throws InvalidInput if an option is not valid.
[[nodiscard]] PointCloud read_point_cloud(const std::filesystem::path& path,
                                          const ReadOptions& options = {});

/// The same, only the points, 3 x N [mm].
[[nodiscard]] Eigen::Matrix3Xd read_points(const std::filesystem::path& path,
                                           const ReadOptions& options = {});

/// Writes a mesh in the format of the extension of `path`, and declares mm in a comment. Reading
/// the file gives the same bits, except for what the format cannot store. .ply has everything, with
/// coordinates as float64; `text` and both byte orders. .obj has text: vertices, triangles,
/// normals, colours from 0 to 1, comments. .stl has only triangles; `binary` (coordinates rounded
/// to float) or `text` (not rounded). .glb is in metres and rounded to float: triangles, normals,
/// colours. .vtk is binary: everything but comments and lists.
/// \throws InvalidInput for another extension or encoding, if the mesh, an attribute or a comment
/// is not valid, or if a number that must be written as float is out of its range.
/// \throws OutputError if the file cannot be written.
void write_mesh_file(const std::filesystem::path& path, const MeshFile& file,
                     const WriteOptions& options = {});

/// The same for a mesh alone.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                const WriteOptions& options = {});

/// Writes points with all attributes: .pcd (`binary` or `text`; normals and byte colours get PCL's
/// names and packing) or .ply (a mesh without faces, not organised). PCD supports lists only if all
/// have the same size; PLY has no 64-bit integers.
/// \throws InvalidInput for another extension or encoding, if the size, an attribute or a comment
/// is not valid, or if a number that must be written as float is out of its range.
/// \throws OutputError if the file cannot be written.
void write_point_cloud(const std::filesystem::path& path, const PointCloud& cloud,
                       const WriteOptions& options = {});

}  // namespace palpate::geometry
