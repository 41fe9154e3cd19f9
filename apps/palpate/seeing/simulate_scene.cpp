// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/simulate_scene.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/sensing/frame.h"
#include "shared/command_line.h"

namespace palpate::apps {
namespace {

/// Share of the camera's view that a mesh fills if no distance is given.
constexpr double kFill = 0.8;
/// Half the size of the wall, in sizes of the camera's view: enough for views with lens distortion.
constexpr double kWallReach = 1.5;
constexpr double kWallReflectance = 0.8;

Eigen::Vector3d central_ray(const geometry::Camera& camera) {
  const Eigen::Vector2d middle((camera.width - 1) / 2.0, (camera.height - 1) / 2.0);
  return geometry::undistort(camera, middle).homogeneous();
}

bool all_in_view(const Eigen::Matrix3Xd& points, const geometry::Camera& camera) {
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (!(points(2, i) > 0)) return false;
    const Eigen::Vector2d pixel = geometry::distort(camera, points.col(i).hnormalized());
    if (!(pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= camera.width - 0.5 &&
          pixel.y() <= camera.height - 0.5)) {
      return false;
    }
  }
  return true;
}

/// [mm] Distance at which a ball fills the image.
double filling_distance(double radius, const geometry::Camera& camera) {
  const double half_view = std::min(camera.width / camera.fx, camera.height / camera.fy) / 2;
  return radius / (kFill * half_view);
}

Eigen::Matrix3d turned(const std::vector<double>& degrees) {
  if (degrees.empty()) return Eigen::Matrix3d::Identity();
  return (Eigen::AngleAxisd(degrees[2] * kDegree, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(degrees[1] * kDegree, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(degrees[0] * kDegree, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Finds texture coordinates under the names that programs use in PLY files.
Eigen::Matrix2Xd texture_coordinates(const geometry::MeshFile& file, const fs::path& path) {
  const std::pair<const char*, const char*> names[] = {
      {"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
  for (const auto& [first, second] : names) {
    const auto u = geometry::scalars(file.vertex_attributes, first);
    const auto v = geometry::scalars(file.vertex_attributes, second);
    if (!u || !v) continue;
    Eigen::Matrix2Xd coordinates(2, u->size());
    coordinates << u->transpose(), v->transpose();
    return coordinates;
  }
  throw InvalidInput(path.string() +
                     ": --texture: the mesh has no texture coordinates; in PLY files they are "
                     "vertex properties s and t, u and v, or texture_u and texture_v");
}

sensing::Body wall_at(double z, const geometry::Camera& camera) {
  const double x = kWallReach * z * camera.width / camera.fx;
  const double y = kWallReach * z * camera.height / camera.fy;
  sensing::Body wall;
  wall.reflectance.setConstant(kWallReflectance);
  wall.mesh.vertices.resize(3, 4);
  wall.mesh.vertices << -x, x, x, -x, -y, -y, y, y, z, z, z, z;
  wall.mesh.triangles.resize(3, 2);
  wall.mesh.triangles << 0, 0, 2, 3, 1, 2;
  return wall;
}

/// Positions of the vertices when the shutter closes, on their way to the next mesh.
Eigen::Matrix3Xd closing_vertices(const SceneCall& call, const Placement& placement,
                                  std::size_t number, const geometry::TriangleMesh& mesh) {
  const fs::path& path = call.meshes[number + 1];
  const geometry::TriangleMesh next = geometry::read_mesh(path, call.read);
  if (next.triangles != mesh.triangles &&
      (next.triangles.cols() != mesh.triangles.cols() ||
       next.vertices.cols() != mesh.vertices.cols() ||
       (next.triangles.array() != mesh.triangles.array()).any())) {
    throw InvalidInput(path.string() + ": --shutter: its triangles differ from those of " +
                       call.meshes[number].string() +
                       "; motion is known only between meshes that differ only in the positions of "
                       "their vertices");
  }
  return (1 - call.shutter) * mesh.vertices +
         call.shutter * (placement.T_camera_mesh * next.vertices);
}

}  // namespace

cv::Mat read_panel(const fs::path& image, const fs::path& pattern,
                   const geometry::Camera& projector, const fs::path& rig) {
  std::error_code cannot_look;
  if (!fs::exists(image, cannot_look)) {
    throw FileError(image.string() + ": is missing; " + pattern.string() +
                    " needs this image for the projector, as palpate pattern draws it");
  }
  cv::Mat panel = sensing::read_frame(image);
  if (panel.cols != projector.width || panel.rows != projector.height) {
    throw InvalidInput(fmt::format("{}: has {} x {} px, but the projector of {} has {} x {}",
                                   image.string(), panel.cols, panel.rows, rig.string(),
                                   projector.width, projector.height));
  }
  return panel;
}

Placement place_mesh(const SceneCall& call, const sensing::Rig& rig,
                     std::optional<double> distance) {
  const geometry::TriangleMesh mesh = geometry::read_mesh(call.meshes.front(), call.read);
  const Eigen::AlignedBox3d box = geometry::bounding_box(mesh);
  const Eigen::Vector3d center = box.center();
  Placement placement;
  placement.T_camera_mesh.linear() = turned(call.turn);
  const Eigen::Matrix3d& R = placement.T_camera_mesh.linear();
  placement.T_camera_mesh.translation() = center - R * center;
  if (!distance) {
    const Eigen::Matrix3Xd corners = mesh.vertices(Eigen::all, mesh.triangles.reshaped());
    if (all_in_view(placement.T_camera_mesh * corners, rig.camera)) return placement;
    placement.chosen = true;
    distance = filling_distance(box.diagonal().norm() / 2, rig.camera);
  }
  placement.T_camera_mesh.translation() = *distance * central_ray(rig.camera) - R * center;
  return placement;
}

std::vector<sensing::Body> load_bodies(const SceneCall& call, const sensing::Rig& rig,
                                       const Placement& placement, std::size_t number) {
  const fs::path& path = call.meshes[number];
  geometry::MeshFile file = geometry::read_mesh_file(path, call.read);
  sensing::Body body;
  body.mesh = std::move(file.mesh);
  body.mesh.vertices = placement.T_camera_mesh * body.mesh.vertices;
  if (call.reflectance.size() == 1) body.reflectance.setConstant(call.reflectance[0]);
  if (call.reflectance.size() == 3) {
    body.reflectance = Eigen::Vector3d(call.reflectance.data());
  }
  body.specular = call.specular;
  body.shininess = call.shininess;
  if (const auto colors = geometry::colors(file.vertex_attributes)) {
    body.vertex_colors = colors->topRows<3>();
  }
  if (!call.texture.empty()) {
    body.texture = sensing::read_frame(call.texture);
    body.texture_coordinates = texture_coordinates(file, path);
  }
  if (call.shutter > 0 && number + 1 < call.meshes.size()) {
    body.end_vertices = closing_vertices(call, placement, number, body.mesh);
  }
  std::vector<sensing::Body> bodies = {std::move(body)};
  if (call.wall) bodies.push_back(wall_at(*call.wall, rig.camera));
  return bodies;
}

}  // namespace palpate::apps
