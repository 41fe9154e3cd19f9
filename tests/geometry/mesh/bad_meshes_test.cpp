// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Calls every function that takes a mesh with every kind of bad mesh: it throws one of Palpate's
// errors, or returns finite numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "broken_meshes.h"
#include "palpate/core/error.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/deformation_graph.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/registration.h"
#include "palpate/geometry/smoothing.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/zipper_scans.h"

namespace palpate::geometry {
namespace {

/// A function of the library on a mesh; returns true if its result is finite where it has to be.
struct Function {
  std::string name;
  std::function<bool(const TriangleMesh&)> is_finite;
};

/// Three places in three triangles that are sound in all broken meshes.
std::vector<SurfacePoint> places() {
  const Eigen::Vector3d middle = Eigen::Vector3d::Constant(1.0 / 3);
  return {{2, middle}, {11, middle}, {19, middle}};
}

std::vector<Function> functions() {
  const auto all_finite = [](const TriangleMesh& mesh) { return mesh.vertices.allFinite(); };
  const auto distances = [](GeodesicMethod method) {
    return [method](const TriangleMesh& mesh) {
      const GeodesicDistance found = geodesic_distance(mesh, places(), {.method = method});
      // Infinity is documented: not reached.
      return !found.distance.hasNaN() && found.distance.minCoeff() >= 0;
    };
  };
  const auto contacts = [](ContactTriangulationMethod method) {
    return [method](const TriangleMesh& mesh) {
      const ContactTriangulation found = triangulate_contacts(mesh, places(), {.method = method});
      return found.mesh.vertices.allFinite() && found.weights.weights.allFinite();
    };
  };
  return {
      {"surface_area", [](const auto& m) { return std::isfinite(surface_area(m)); }},
      {"enclosed_volume", [](const auto& m) { return std::isfinite(enclosed_volume(m)); }},
      {"boundary_loops", [](const auto& m) { return boundary_loops(m).size() < 1000; }},
      {"connected_components", [](const auto& m) { return connected_components(m).count > 0; }},
      {"smooth", [&](const auto& m) { return all_finite(smooth(m)); }},
      {"fast marching", distances(GeodesicMethod::fast_marching)},
      {"exact geodesics", distances(GeodesicMethod::exact)},
      {"geodesic Delaunay", contacts(ContactTriangulationMethod::delaunay)},
      {"voronoi dual", contacts(ContactTriangulationMethod::voronoi_dual)},
      {"closest point",
       [](const auto& m) {
         return SurfaceQuery(m).closest_point({1, 2, 3}).position.allFinite();
       }},
      {"register_points",
       [](const auto& m) {
         return register_points(test::icosphere(1, 10).vertices, m)
             .T_target_source.matrix()
             .allFinite();
       }},
      {"hausdorff_distance",
       [](const auto& m) {
         return std::isfinite(hausdorff_distance(m, test::icosphere(1, 10)).upper);
       }},
      {"surface_distances",
       [](const auto& m) {
         return std::isfinite(surface_distances(m, test::icosphere(1, 10)).rms);
       }},
      {"decimate", [&](const auto& m) { return all_finite(decimate(m, {.tolerance = 0.1}).mesh); }},
      {"fill_holes",
       [&](const auto& m) { return all_finite(fill_holes(m, {.max_diameter = 5}).mesh); }},
      {"zipper_scans",
       [&](const auto& m) {
         const std::vector<Scan> scans = {{.mesh = m}, {.mesh = m}};
         return all_finite(zipper_scans(scans).mesh);
       }},
      {"DeformationGraph",
       [&](const auto& m) {
         return DeformationGraph(m, {.nodes = 20}).mesh().vertices.allFinite();
       }},
  };
}

TEST(BadMeshes, AreRefusedOrAnsweredInFiniteNumbersByEveryFunction) {
  for (const test::BrokenMesh& broken : test::broken_meshes()) {
    for (const Function& function : functions()) {
      try {
        EXPECT_TRUE(function.is_finite(broken.mesh)) << function.name << ", " << broken.name;
      } catch (const Error& refused) {
        EXPECT_GT(std::string(refused.what()).size(), 20U) << function.name << ", " << broken.name;
      }
    }
  }
}

TEST(BadMeshes, WhatNoFunctionCanUseIsRefusedByAllWithItsIndex) {
  for (const test::BrokenMesh& broken : test::broken_meshes()) {
    if (broken.kind > DefectKind::corner_repeated) continue;
    for (const Function& function : functions()) {
      try {
        (void)function.is_finite(broken.mesh);
        ADD_FAILURE() << function.name << " accepts: " << broken.name;
      } catch (const Unavailable&) {  // a build without CGAL
      } catch (const InvalidInput& refused) {
        EXPECT_NE(std::string(refused.what()).find(" " + std::to_string(broken.elements[0]) + " "),
                  std::string::npos)
            << function.name << ", " << broken.name << ": " << refused.what();
      }
    }
  }
}

TEST(BadMeshes, MendedOnesAreAcceptedByEveryFunctionThatTakesOpenSurfaces) {
  for (const test::BrokenMesh& broken : test::broken_meshes()) {
    const TriangleMesh mended = repair_mesh(broken.mesh).mesh;
    EXPECT_NO_THROW((void)opposite_half_edges(mended)) << broken.name;
    EXPECT_NO_THROW((void)smooth(mended)) << broken.name;
    EXPECT_NO_THROW((void)triangulate_contacts(mended, places())) << broken.name;
    EXPECT_NO_THROW((void)decimate(mended, {.tolerance = 0.1})) << broken.name;
  }
}

}  // namespace
}  // namespace palpate::geometry
