// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "contacts/contact_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/geodesic_distance.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

using test::check_manifold;
using test::Circle;
using test::circumcircle;
using test::Counts;
using test::jittered_grid;
using test::nearest_other;
using test::nearest_places;
using test::sorted_corners;

ContactTriangulation voronoi_dual(const TriangleMesh& surface,
                                  std::span<const SurfacePoint> contacts) {
  return triangulate_contacts(surface, contacts,
                              {.method = ContactTriangulationMethod::voronoi_dual});
}

TEST(VoronoiDual, OnAFlatSheetIsThePlanarDelaunayTriangulation) {
  constexpr double kSpacing = 0.5;
  constexpr double kWidth = 140 * kSpacing;
  constexpr double kHeight = 100 * kSpacing;
  const TriangleMesh sheet = test::flat_sheet(140, 100, kSpacing);
  const ContactTriangulation result =
      voronoi_dual(sheet, nearest_places(sheet, jittered_grid(8, 6, 7.3, 0.4)));
  const Eigen::Matrix3Xd& places = result.mesh.vertices;
  EXPECT_TRUE(result.isolated.empty());

  // The cells are known at the vertices of the sheet only.
  constexpr double kResolution = 2 * kSpacing;
  std::set<std::array<int, 3>> found;
  for (const Eigen::Vector3i t : result.mesh.triangles.colwise()) {
    const std::array<int, 3> corners = sorted_corners(t);
    found.insert(corners);
    const Circle circle = circumcircle(places.col(t[0]).head<2>(), places.col(t[1]).head<2>(),
                                       places.col(t[2]).head<2>());
    EXPECT_GT(nearest_other(places, corners, circle.centre), circle.radius - kResolution);
    EXPECT_GT((places.col(t[1]) - places.col(t[0])).cross(places.col(t[2]) - places.col(t[0])).z(),
              0);
  }
  int expected = 0;
  const int count = static_cast<int>(places.cols());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      for (int c = b + 1; c < count; ++c) {
        const Circle circle =
            circumcircle(places.col(a).head<2>(), places.col(b).head<2>(), places.col(c).head<2>());
        const bool on_sheet = circle.centre.x() > kResolution && circle.centre.y() > kResolution &&
                              circle.centre.x() < kWidth - kResolution &&
                              circle.centre.y() < kHeight - kResolution;
        const std::array<int, 3> corners = {a, b, c};
        if (!on_sheet ||
            nearest_other(places, corners, circle.centre) < circle.radius + kResolution) {
          continue;
        }
        ++expected;
        EXPECT_TRUE(found.contains(corners)) << a << " " << b << " " << c;
      }
    }
  }
  EXPECT_GT(expected, 30);
}

TEST(VoronoiDual, OfARegularGridIsADiskWithoutGaps) {
  // Every four neighbours are on one circle: rounding decides which diagonal is taken, but there
  // must be one.
  const TriangleMesh sheet = test::flat_sheet(80, 60, 1.1);
  for (const double jitter : {0.0, 1e-12, 1e-3, 0.2}) {
    const ContactTriangulation result =
        voronoi_dual(sheet, nearest_places(sheet, jittered_grid(7, 5, 11, jitter)));
    const Counts counts = check_manifold(result.mesh);
    EXPECT_EQ(counts.vertices, 35);
    EXPECT_EQ(counts.euler(), 1);
    EXPECT_GE(counts.faces, 48);
    EXPECT_TRUE(result.isolated.empty());
  }
}

TEST(VoronoiDual, OnASphereIsClosed) {
  const TriangleMesh sphere = test::icosphere(4, 30);
  const ContactTriangulation result = voronoi_dual(sphere, nearest_places(sphere, [] {
                                                     const TriangleMesh coarse =
                                                         test::icosphere(1, 30);
                                                     std::vector<Vector3d> points;
                                                     for (const auto& v : coarse.vertices.colwise())
                                                       points.push_back(v);
                                                     return points;
                                                   }()));
  const Counts counts = check_manifold(result.mesh);
  EXPECT_EQ(counts.vertices, 42);
  EXPECT_EQ(counts.faces, 80);
  EXPECT_EQ(counts.euler(), 2);
  const Eigen::Matrix3Xd normals = triangle_normals(result.mesh);
  for (Eigen::Index t = 0; t < normals.cols(); ++t) {
    EXPECT_GT(normals.col(t).dot(result.mesh.vertices.col(result.mesh.triangles(0, t))), 0);
  }
}

TEST(VoronoiDual, OnASphereIsClosedForContactsAtRandomToo) {
  const TriangleMesh sphere = test::icosphere(4, 30);
  std::mt19937 random(29);
  std::uniform_int_distribution<int> any(0, static_cast<int>(sphere.triangles.cols()) - 1);
  for (int trial = 0; trial < 20; ++trial) {
    // Apart by several edges of the surface, which are about 2 mm long.
    std::vector<SurfacePoint> contacts;
    while (contacts.size() < 40) {
      const SurfacePoint candidate{.triangle = any(random), .barycentric = {0.2, 0.3, 0.5}};
      const bool apart = std::ranges::all_of(contacts, [&](const SurfacePoint& other) {
        return (position(sphere, other) - position(sphere, candidate)).norm() > 6;
      });
      if (apart) contacts.push_back(candidate);
    }
    const ContactTriangulation result = voronoi_dual(sphere, contacts);
    const Counts counts = check_manifold(result.mesh);
    EXPECT_EQ(counts.vertices, 40);
    EXPECT_EQ(counts.euler(), 2);
  }
}

TEST(VoronoiDual, OfOneSideOfAClosedSurfaceIsOpen) {
  // Behind the sphere the cells meet again; the triangles there would be a lid through its inside.
  const TriangleMesh sphere = test::icosphere(4, 30);
  std::vector<Vector3d> cap;
  for (const Vector3d& p : jittered_grid(4, 4, 7, 0.2))
    cap.emplace_back(p.x() - 17, p.y() - 17, 25);
  const ContactTriangulation result = voronoi_dual(sphere, nearest_places(sphere, cap));
  const Counts counts = check_manifold(result.mesh);
  EXPECT_EQ(counts.vertices, 16);
  EXPECT_EQ(counts.euler(), 1);
  // A lid would point down; slivers at the border may be steep.
  EXPECT_GT(triangle_normals(result.mesh).row(2).minCoeff(), -0.5);
  const ContactTriangulation three =
      voronoi_dual(sphere, nearest_places(sphere, {{10, 0.3, 25}, {-9, 9, 25}, {-8, -9, 25}}));
  EXPECT_EQ(three.mesh.triangles, Eigen::Vector3i(0, 1, 2));
}

TEST(VoronoiDual, LabelsAreTheCellsOfTheContacts) {
  const TriangleMesh sheet = test::flat_sheet(40, 30, 1);
  const std::vector<SurfacePoint> contacts = nearest_places(sheet, jittered_grid(4, 3, 8, 0.3));
  const ContactTriangulation result = voronoi_dual(sheet, contacts);
  EXPECT_EQ(result.surface_labels, geodesic_distance(sheet, contacts).label);
}

/// A closed tube about the z axis: a glove's finger without its tip.
TriangleMesh finger(int around, int along, double radius, double spacing) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, around * (along + 1));
  for (int r = 0; r <= along; ++r) {
    for (int c = 0; c < around; ++c) {
      const double angle = 2 * std::numbers::pi * c / around;
      mesh.vertices.col(r * around + c) << radius * std::cos(angle), radius * std::sin(angle),
          r * spacing;
    }
  }
  mesh.triangles.resize(3, 2 * around * along);
  for (int r = 0; r < along; ++r) {
    for (int c = 0; c < around; ++c) {
      const int a = r * around + c;
      const int b = r * around + (c + 1) % around;
      mesh.triangles.col(2 * a) << a, b, b + around;
      mesh.triangles.col(2 * a + 1) << a, b + around, a + around;
    }
  }
  return mesh;
}

TEST(VoronoiDual, IsAManifoldHoweverFewContactsThereAre) {
  std::vector<TriangleMesh> surfaces = {test::icosphere(3, 20), finger(40, 60, 8, 1.3),
                                        test::height_field(60, 50, 1, [](double x, double y) {
                                          return 12 * std::sin(x / 4) * std::cos(y / 5) +
                                                 3 * std::sin(x * y);
                                        })};
  std::mt19937 random(23);
  int triangulated = 0;
  for (const TriangleMesh& surface : surfaces) {
    std::uniform_int_distribution<int> any(0, static_cast<int>(surface.triangles.cols()) - 1);
    for (const int count : {3, 4, 5, 6, 8, 12, 20, 50, 150}) {
      for (int trial = 0; trial < 3; ++trial) {
        std::set<int> triangles;
        while (static_cast<int>(triangles.size()) < count) triangles.insert(any(random));
        std::vector<SurfacePoint> contacts;
        for (const int t : triangles) {
          contacts.push_back({.triangle = t, .barycentric = {0.2, 0.3, 0.5}});
        }
        try {
          const ContactTriangulation result = voronoi_dual(surface, contacts);
          const Counts counts = check_manifold(result.mesh);
          EXPECT_EQ(counts.vertices + static_cast<int>(result.isolated.size()), count);
          ++triangulated;
        } catch (const InvalidInput& error) {
          EXPECT_NE(std::string(error.what()).find("nowhere on the surface"), std::string::npos);
          EXPECT_LT(count, 12);
        }
      }
    }
  }
  EXPECT_GT(triangulated, 55);
}

TEST(VoronoiDual, ListsContactsInNoTriangle) {
  TriangleMesh two = test::flat_sheet(20, 20, 1);
  const Eigen::Index vertices = two.vertices.cols();
  const Eigen::Index triangles = two.triangles.cols();
  two.vertices.conservativeResize(3, 2 * vertices);
  two.vertices.rightCols(vertices) = two.vertices.leftCols(vertices).colwise() + Vector3d(0, 0, 5);
  two.triangles.conservativeResize(3, 2 * triangles);
  two.triangles.rightCols(triangles) =
      two.triangles.leftCols(triangles).array() + static_cast<int>(vertices);
  const ContactTriangulation result =
      voronoi_dual(two, nearest_places(two, {{5, 5, 0}, {9, 9, 5}, {15, 5.5, 0}, {9.3, 15, 0}}));
  EXPECT_EQ(result.isolated, std::vector<int>{1});
  EXPECT_EQ(result.mesh.triangles.cols(), 1);
  EXPECT_EQ(result.mesh.triangles.col(0), Eigen::Vector3i(0, 2, 3));
}

TEST(VoronoiDual, DoesNotDependOnTheUnitOfLength) {
  const TriangleMesh sheet = test::height_field(
      50, 40, 1, [](double x, double y) { return 4 * std::sin(x / 6) * std::sin(y / 7); });
  const std::vector<SurfacePoint> contacts = nearest_places(sheet, jittered_grid(6, 5, 7, 0.3));
  const ContactTriangulation expected = voronoi_dual(sheet, contacts);
  for (const double factor : {0x1p-20, 0x1p20}) {
    const ContactTriangulation scaled = voronoi_dual(test::scaled(sheet, factor), contacts);
    EXPECT_EQ(scaled.mesh.triangles, expected.mesh.triangles);
    EXPECT_EQ(scaled.surface_labels, expected.surface_labels);
  }
}

TEST(VoronoiDual, RefusesBadInputAndNamesIt) {
  const auto refused = [](const TriangleMesh& surface, const std::vector<SurfacePoint>& contacts) {
    return refusal([&] { return voronoi_dual(surface, contacts); });
  };
  const TriangleMesh sheet = test::flat_sheet(20, 20, 1);
  std::vector<SurfacePoint> contacts =
      nearest_places(sheet, {{5, 5, 0}, {15, 5, 0}, {10, 15, 0}, {5, 15, 0}});
  EXPECT_NO_THROW((void)voronoi_dual(sheet, contacts));
  EXPECT_NE(refused({}, contacts).find("no triangles"), std::string::npos);
  EXPECT_NE(refused(sheet, {contacts[0], contacts[1]}).find("got 2 contacts"), std::string::npos);
  contacts[3] = contacts[1];
  EXPECT_NE(refused(sheet, contacts).find("contacts 1 and 3 are at the same place"),
            std::string::npos);
  contacts[3].triangle = 800;
  EXPECT_NE(refused(sheet, contacts).find("contact 3"), std::string::npos);
  const std::vector<SurfacePoint> in_line =
      nearest_places(sheet, {{3, 10, 0}, {8, 10, 0}, {12, 10, 0}, {17, 10, 0}});
  EXPECT_NE(refused(sheet, in_line).find("nowhere on the surface"), std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
