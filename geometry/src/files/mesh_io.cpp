// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include "files/ending.h"
#include "files/file_formats.h"
#include "files/file_unit.h"
#include "files/polygon_mesh.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/input_file.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/point_file.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

struct InputFile {
  std::string name;
  std::string content;
  std::string ending;  ///< of the format, in lower case
};

/// Pipes such as /dev/stdin have no ending.
InputFile read_input(const fs::path& path) {
  InputFile input{
      .name = path.string(), .content = read_input_file(path), .ending = lower_extension(path)};
  if (input.ending.empty()) input.ending = ending_by_content(input.content);
  return input;
}

PolygonMesh read_polygons(const fs::path& path, const InputFile& input) {
  if (input.ending == ".ply") return read_ply(input.content, input.name);
  if (input.ending == ".obj") return read_obj(input.content, input.name);
  if (input.ending == ".off") return read_off(input.content, input.name);
  if (input.ending == ".stl") return read_stl(input.content, input.name);
  return read_assimp_scene(path, input.content, input.ending);
}

/// Multiplying by 1 keeps every bit. A product beyond the range of double is refused.
void convert_to_mm(Eigen::Matrix3Xd& points, const FileUnit& unit, const std::string& file) {
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const bool was_finite = points.col(i).allFinite();
    points.col(i) *= unit.length;
    if (was_finite && !points.col(i).allFinite())
      throw FileError(file + ": vertex " + std::to_string(i) + " times " +
                      std::to_string(unit.length) + " mm is beyond the range of numbers");
  }
}

MeshFile mesh_of(PolygonMesh polygons, const std::string& name, const ReadOptions& options) {
  std::vector<std::string> comments = std::move(polygons.comments);
  const FileUnit unit = take_unit(options, polygons.unit, comments);
  MeshFile file = triangulate(std::move(polygons), name, options.keep_defects);
  file.comments = std::move(comments);
  file.unit = unit;
  convert_to_mm(file.mesh.vertices, unit, name);
  return file;
}

/// \param declared [mm] unit of the file.
PointCloud cloud_in_mm(PointCloud cloud, const std::optional<double>& declared,
                       const std::string& name, const ReadOptions& options) {
  cloud.unit = take_unit(options, declared, cloud.comments);
  convert_to_mm(cloud.points, cloud.unit, name);
  return cloud;
}

PointCloud cloud_of(PolygonMesh polygons, const std::string& name, const ReadOptions& options) {
  if (polygons.vertices.empty()) throw FileError(name + ": holds no points");
  PointCloud cloud;
  cloud.points = vertex_matrix(polygons);
  cloud.width = cloud.points.cols();
  cloud.attributes = std::move(polygons.vertex_attributes);
  cloud.comments = std::move(polygons.comments);
  return cloud_in_mm(std::move(cloud), polygons.unit, name, options);
}

[[noreturn]] void refuse_ending(const fs::path& path, const char* what, const char* endings) {
  throw InvalidInput(path.string() + ": " + what + " is written as " + endings + ", not as \"" +
                     path.extension().string() + "\"");
}

void check_encoding(const fs::path& path, const WriteOptions& options) {
  const std::string extension = lower_extension(path);
  if (options.encoding == Encoding::binary_big_endian && extension != ".ply" && extension != ".obj")
    throw InvalidInput(path.string() + ": only PLY supports big-endian binary");
  if (options.encoding == Encoding::text && (extension == ".glb" || extension == ".vtk"))
    throw InvalidInput(path.string() + ": is always binary");
}

/// NaN and infinity are in the range of float too.
bool fits_float(double number) {
  return !(std::isfinite(number) && std::abs(number) > double{std::numeric_limits<float>::max()});
}

void check_float_range(const Eigen::Matrix3Xd& points, const std::string& file) {
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (!points.col(i).unaryExpr(&fits_float).all())
      throw InvalidInput(file + ": vertex " + std::to_string(i) +
                         " is beyond the range of float; write float64, or STL as text");
}

void round_to_float(Attributes& attributes, const std::string& file) {
  for (Attribute& attribute : attributes) {
    const auto* numbers = std::get_if<std::vector<double>>(&attribute.values);
    if (numbers == nullptr) continue;
    if (!std::all_of(numbers->begin(), numbers->end(), fits_float))
      throw InvalidInput(file + ": attribute \"" + attribute.name +
                         "\" holds a number beyond the range of float; write float64");
    attribute.values = std::vector<float>(numbers->begin(), numbers->end());
  }
}

void write_checked(const fs::path& path, const MeshFile& file, const WriteOptions& options) {
  const std::string extension = lower_extension(path);
  const std::string name = path.string();
  write_file(path, [&](std::ostream& stream) {
    if (extension == ".ply")
      write_ply(stream, file, options, name.c_str());
    else if (extension == ".obj")
      write_obj(stream, file);
    else if (extension == ".glb")
      write_glb(stream, file, name.c_str());
    else if (extension == ".vtk")
      write_vtk(stream, file);
    else
      write_stl(stream, file.mesh, options.encoding);
  });
}

}  // namespace

MeshFile read_mesh_file(const fs::path& path, const ReadOptions& options) {
  check_options(options);
  const InputFile input = read_input(path);
  if (input.ending == ".pcd")
    throw FileError(path.string() + ": holds points without a surface; a mesh is needed");
  return mesh_of(read_polygons(path, input), input.name, options);
}

TriangleMesh read_mesh(const fs::path& path, const ReadOptions& options) {
  return read_mesh_file(path, options).mesh;
}

PointCloud read_point_cloud(const fs::path& path, const ReadOptions& options) {
  check_options(options);
  const InputFile input = read_input(path);
  if (input.ending == ".pcd")
    return cloud_in_mm(read_pcd(input.content, input.name), std::nullopt, input.name, options);
  return cloud_of(read_polygons(path, input), input.name, options);
}

std::variant<MeshFile, PointCloud> read_mesh_or_points(const fs::path& path,
                                                       const ReadOptions& options) {
  check_options(options);
  const InputFile input = read_input(path);
  if (input.ending == ".pcd")
    return cloud_in_mm(read_pcd(input.content, input.name), std::nullopt, input.name, options);
  PolygonMesh polygons = read_polygons(path, input);
  if (polygons.sizes.empty() && !polygons.vertices.empty())
    return cloud_of(std::move(polygons), input.name, options);
  return mesh_of(std::move(polygons), input.name, options);
}

Eigen::Matrix3Xd read_points(const fs::path& path, const ReadOptions& options) {
  return read_point_cloud(path, options).points;
}

void write_mesh_file(const fs::path& path, const MeshFile& file, const WriteOptions& options) {
  const std::string extension = lower_extension(path);
  constexpr std::array kEndings{".ply", ".obj", ".stl", ".glb", ".vtk"};
  if (std::ranges::find(kEndings, extension) == kEndings.end())
    refuse_ending(path, "a mesh", ".ply, .obj, .stl, .glb or .vtk");
  check_encoding(path, options);
  const std::string name = path.string();
  check_mesh(file.mesh, name.c_str());
  check_attributes(file.vertex_attributes, file.mesh.vertices.cols(), name.c_str());
  check_attributes(file.triangle_attributes, file.mesh.triangles.cols(), name.c_str());
  check_comments(file.comments, name.c_str());
  const bool as_float = extension == ".ply" && options.single_precision;
  if (as_float || extension == ".glb" ||
      (extension == ".stl" && options.encoding == Encoding::binary))
    check_float_range(file.mesh.vertices, name);
  if (!as_float) return write_checked(path, file, options);
  MeshFile rounded = file;
  round_to_float(rounded.vertex_attributes, name);
  round_to_float(rounded.triangle_attributes, name);
  write_checked(path, rounded, options);
}

void write_mesh(const fs::path& path, const TriangleMesh& mesh, const WriteOptions& options) {
  MeshFile file;
  file.mesh = mesh;
  write_mesh_file(path, file, options);
}

void write_point_cloud(const fs::path& path, const PointCloud& cloud, const WriteOptions& options) {
  const std::string extension = lower_extension(path);
  if (extension != ".ply" && extension != ".pcd")
    refuse_ending(path, "a point cloud", ".pcd or .ply");
  check_encoding(path, options);
  const std::string name = path.string();
  const Eigen::Index count = cloud.points.cols();
  if (count == 0) throw InvalidInput(name + ": the cloud has no points; at least one is needed");
  if (cloud.width < 1 || cloud.height < 1 || count % cloud.height != 0 ||
      count / cloud.height != cloud.width)
    throw InvalidInput(name + ": the cloud has " + std::to_string(count) +
                       " points; width x height is " + std::to_string(cloud.width) + " x " +
                       std::to_string(cloud.height));
  check_attributes(cloud.attributes, count, name.c_str());
  check_comments(cloud.comments, name.c_str());
  PointCloud rounded = cloud;
  if (options.single_precision) {
    check_float_range(cloud.points, name);
    round_to_float(rounded.attributes, name);
  }
  if (extension == ".ply") {
    MeshFile file;
    file.mesh.vertices = std::move(rounded.points);
    file.vertex_attributes = std::move(rounded.attributes);
    file.comments = std::move(rounded.comments);
    return write_checked(path, file, options);
  }
  write_file(path,
             [&](std::ostream& stream) { write_pcd(stream, rounded, options, name.c_str()); });
}

}  // namespace palpate::geometry
