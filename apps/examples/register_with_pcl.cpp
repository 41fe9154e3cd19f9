// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// For users of PCL: a cloud gets normals, is registered to a mesh, and is moved by PCL only if the
// verdict accepts the pose. Needs a mesh: register_with_pcl hand.ply. The cloud is made of the
// vertices of the mesh, shifted and thinned by PCL.
#include <palpate/core/error.h>
#include <palpate/geometry/cloud_normals.h>
#include <palpate/geometry/mesh_io.h>
#include <palpate/geometry/pcl_cloud.h>
#include <palpate/geometry/registration.h>
#include <pcl/common/transforms.h>
#include <pcl/filters/voxel_grid.h>

#include <cstdio>

namespace geometry = palpate::geometry;

int main(int count, char** arguments) try {
  if (count != 2) throw palpate::InvalidInput("usage: register_with_pcl MESH");
  const geometry::TriangleMesh mesh = geometry::read_mesh(arguments[1]);
  const auto scan = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>(
      geometry::to_point_cloud(mesh.vertices.colwise() + Eigen::Vector3d(4, -3, 5)));
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(scan);
  grid.setLeafSize(4, 4, 4);
  pcl::PointCloud<pcl::PointXYZ> thinned;
  grid.filter(thinned);

  geometry::PointCloud cloud = geometry::from_point_cloud_of(thinned);
  set_normals(cloud.attributes, geometry::cloud_normals(cloud.points).normals);
  const auto with_normals = geometry::to_point_cloud_of<pcl::PointNormal>(cloud);

  const geometry::Registration found = geometry::register_points(cloud.points, mesh);
  std::printf("%s: %s\n", geometry::to_string(found.verdict), found.reason.c_str());
  if (found.verdict != geometry::RegistrationVerdict::accepted) return 1;
  pcl::PointCloud<pcl::PointNormal> moved;
  pcl::transformPointCloudWithNormals(with_normals, moved,
                                      Eigen::Affine3f(found.T_target_source.cast<float>()));
  std::printf("%zu of %zu points moved by %.2f mm\n", moved.size(), scan->size(),
              found.T_target_source.translation().norm());
  return 0;
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
