// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A vertex that no triangle uses, far away, changes no result.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

#include "broken_meshes.h"
#include "mesh_corpus.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/register_scans.h"
#include "palpate/geometry/registration.h"
#include "palpate/geometry/remeshing.h"
#include "palpate/geometry/self_intersections.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/winding_number.h"
#include "palpate/geometry/zipper_scans.h"

namespace palpate::geometry {
namespace {

/// A function of the library on a mesh; its result as numbers.
struct Answer {
  std::string name;
  std::function<Eigen::VectorXd(const TriangleMesh&)> result;
};

Eigen::VectorXd corners_in_order(const TriangleMesh& mesh) {
  return mesh.vertices(Eigen::all, mesh.triangles.reshaped()).reshaped();
}

/// The mesh of `glove`, turned a little and in other triangles.
TriangleMesh other_glove() {
  return test::moved(test::glove(12), Eigen::Isometry3d(Eigen::AngleAxisd(
                                          0.1, Eigen::Vector3d(1, 2, 3).normalized())));
}

std::vector<SurfacePoint> quarters(const TriangleMesh& mesh) {
  const auto triangles = static_cast<int>(mesh.triangles.cols());
  return {corner_point(0, 0), corner_point(triangles / 4, 1), corner_point(triangles / 2, 2),
          corner_point(3 * triangles / 4, 0)};
}

std::vector<Answer> answers() {
  const auto distances = [](GeodesicMethod method) {
    return [method](const TriangleMesh& mesh) -> Eigen::VectorXd {
      return geodesic_distance(mesh, quarters(mesh), {.method = method})
          .distance(mesh.triangles.reshaped());
    };
  };
  return {
      {"bounding_box",
       [](const auto& m) -> Eigen::VectorXd {
         return (Eigen::VectorXd(7) << bounding_box(m).min(), bounding_box(m).max(),
                 bounding_diagonal(m))
             .finished();
       }},
      {"closest_point",
       [](const auto& m) -> Eigen::VectorXd {
         return closest_points(SurfaceQuery(m), other_glove().vertices).positions.reshaped();
       }},
      {"first_hits",
       [](const auto& m) -> Eigen::VectorXd {
         const Eigen::Matrix3Xd starts = 3 * other_glove().vertices;
         return first_hits(SurfaceQuery(m), starts, -starts).triangles.template cast<double>();
       }},
      {"winding_numbers",
       [](const auto& m) { return winding_numbers(WindingNumber(m), other_glove().vertices); }},
      {"intersecting_triangles",
       [](const auto& m) -> Eigen::VectorXd {
         const TriangleMesh other = other_glove();
         TriangleMesh both;
         both.vertices.resize(3, m.vertices.cols() + other.vertices.cols());
         both.vertices << m.vertices, other.vertices;
         both.triangles.resize(3, m.triangles.cols() + other.triangles.cols());
         both.triangles << m.triangles,
             other.triangles.array() + static_cast<int>(m.vertices.cols());
         const std::vector<int> found = intersecting_triangles(both);
         return Eigen::VectorXi::Map(found.data(), std::ssize(found)).template cast<double>();
       }},
      {"fast marching", distances(GeodesicMethod::fast_marching)},
      {"exact geodesics", distances(GeodesicMethod::exact)},
      {"triangulate_contacts",
       [](const auto& m) -> Eigen::VectorXd {
         return triangulate_contacts(m, quarters(m))
             .mesh.triangles.template cast<double>()
             .reshaped();
       }},
      {"hausdorff_distance",
       [](const auto& m) -> Eigen::VectorXd {
         const HausdorffDistance found = hausdorff_distance(m, other_glove());
         return Eigen::Vector4d(found.a_to_b.lower, found.a_to_b.upper, found.b_to_a.lower,
                                found.b_to_a.upper);
       }},
      {"surface_distances",
       [](const auto& m) -> Eigen::VectorXd {
         return surface_distances(other_glove(), m, {.cells = 3000}).distance;
       }},
      {"decimate",
       [](const auto& m) { return corners_in_order(decimate(m, {.tolerance = 1}).mesh); }},
      {"decimate to a count",
       [](const auto& m) { return corners_in_order(decimate(m, {.max_triangles = 300}).mesh); }},
      {"remesh",
       [](const auto& m) { return corners_in_order(remesh(m, {.edge_length = 8}).mesh); }},
      {"register_points",
       [](const auto& m) -> Eigen::VectorXd {
         const Registration found = register_points(other_glove().vertices, m);
         return (Eigen::VectorXd(18) << found.T_target_source.matrix().reshaped(), found.rms,
                 static_cast<double>(found.verdict))
             .finished();
       }},
      {"register_scans",
       [](const auto& m) -> Eigen::VectorXd {
         const std::vector<Scan> scans = {
             {.mesh = m},
             {.mesh = test::with_vertex(other_glove(), m.vertices.col(m.vertices.cols() - 1))}};
         return register_scans(scans).front().T_target_source.matrix().reshaped();
       }},
      {"merge_scans",
       [](const auto& m) {
         const std::vector<Scan> scans = {{.mesh = m}, {.mesh = m}};
         return corners_in_order(merge_scans(scans, {.spacing = 5}).mesh);
       }},
      {"zipper_scans",
       [](const auto& m) {
         const std::vector<Scan> scans = {{.mesh = m}, {.mesh = m}};
         return corners_in_order(zipper_scans(scans).mesh);
       }},
  };
}

TEST(UnusedVertices, ChangeNoResultHoweverFarAwayTheyAre) {
  const TriangleMesh mesh = test::glove(12);
  for (const Answer& answer : answers()) {
    const Eigen::VectorXd expected = answer.result(mesh);
    ASSERT_GT(expected.size(), 0) << answer.name;
    for (const double far : {1e9, 1e200}) {
      const TriangleMesh stray = test::with_vertex(mesh, {far, -far, far});
      EXPECT_EQ(answer.result(stray), expected) << answer.name << ", " << far << " mm";
    }
  }
}

}  // namespace
}  // namespace palpate::geometry
