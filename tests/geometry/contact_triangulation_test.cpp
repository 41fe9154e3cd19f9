// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/contact_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "palpate/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Weights: some tens of operations on values of the order of one, in triangles that may be
/// slivers.
constexpr double kRounding = 1e-10;

std::array<int, 3> sorted_corners(const Eigen::Vector3i& triangle) {
  std::array<int, 3> corners = {triangle[0], triangle[1], triangle[2]};
  std::ranges::sort(corners);
  return corners;
}

std::vector<SurfacePoint> nearest_places(const TriangleMesh& surface,
                                         const std::vector<Vector3d>& points) {
  const SurfaceQuery query(surface);
  std::vector<SurfacePoint> places;
  for (const Vector3d& point : points) places.push_back(query.closest_point(point).at);
  return places;
}

/// Points of a grid, each moved at random by up to `jitter` of the spacing.
std::vector<Vector3d> jittered_grid(int cols, int rows, double spacing, double jitter) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> shift(-jitter * spacing, jitter * spacing);
  std::vector<Vector3d> points;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      points.emplace_back((c + 1) * spacing + shift(random), (r + 1) * spacing + shift(random), 0);
    }
  }
  return points;
}

struct Counts {
  int vertices = 0;
  int edges = 0;
  int faces = 0;
  [[nodiscard]] int euler() const { return vertices - edges + faces; }
};

/// Counts what is in use, after checking that the mesh is an oriented manifold with border: no
/// triangle twice, no side of an edge twice, and the edges opposite to a vertex form one chain.
Counts check_manifold(const TriangleMesh& mesh) {
  std::set<std::pair<int, int>> sides;
  std::set<std::pair<int, int>> edges;
  std::set<std::array<int, 3>> faces;
  std::map<int, std::vector<std::pair<int, int>>> links;
  for (const Eigen::Vector3i t : mesh.triangles.colwise()) {
    EXPECT_TRUE(faces.insert(sorted_corners(t)).second) << "a triangle twice";
    for (int k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      EXPECT_TRUE(sides.emplace(a, b).second) << "edge " << a << " " << b;
      edges.insert(std::minmax(a, b));
      links[t[(k + 2) % 3]].emplace_back(a, b);
    }
  }
  for (auto& [vertex, link] : links) {
    std::set<int> reached = {link.front().first};
    for (size_t pass = 0; pass < link.size(); ++pass) {
      for (const auto& [a, b] : link) {
        if (reached.contains(a) || reached.contains(b)) reached.insert({a, b});
      }
    }
    for (const auto& [a, b] : link) EXPECT_TRUE(reached.contains(a)) << "two fans at " << vertex;
  }
  return {.vertices = static_cast<int>(links.size()),
          .edges = static_cast<int>(edges.size()),
          .faces = static_cast<int>(faces.size())};
}

struct Circle {
  Vector2d centre;
  double radius;
};
Circle circumcircle(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  Eigen::Matrix2d sides;
  sides << (b - a).transpose(), (c - a).transpose();
  const Vector2d centre =
      a + sides.fullPivLu().solve(Vector2d((b - a).squaredNorm(), (c - a).squaredNorm()) / 2);
  return {.centre = centre, .radius = (centre - a).norm()};
}

double nearest_other(const Eigen::Matrix3Xd& places, const std::array<int, 3>& corners,
                     const Vector2d& centre) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < places.cols(); ++i) {
    if (std::ranges::find(corners, i) != corners.end()) continue;
    nearest = std::min(nearest, (places.col(i).head<2>() - centre).norm());
  }
  return nearest;
}

TEST(TriangulateContacts, OnAFlatSheetIsThePlanarDelaunayTriangulation) {
  constexpr double kSpacing = 0.5;
  constexpr double kWidth = 140 * kSpacing;
  constexpr double kHeight = 100 * kSpacing;
  const TriangleMesh sheet = test::flat_sheet(140, 100, kSpacing);
  const ContactTriangulation result =
      triangulate_contacts(sheet, nearest_places(sheet, jittered_grid(8, 6, 7.3, 0.4)));
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

TEST(TriangulateContacts, OfARegularGridIsADiskWithoutGaps) {
  // Every four neighbours are on one circle: which diagonal is taken is rounding, that there is one
  // is not.
  const TriangleMesh sheet = test::flat_sheet(80, 60, 1.1);
  for (const double jitter : {0.0, 1e-12, 1e-3, 0.2}) {
    const ContactTriangulation result =
        triangulate_contacts(sheet, nearest_places(sheet, jittered_grid(7, 5, 11, jitter)));
    const Counts counts = check_manifold(result.mesh);
    EXPECT_EQ(counts.vertices, 35);
    EXPECT_EQ(counts.euler(), 1);
    EXPECT_GE(counts.faces, 48);
    EXPECT_TRUE(result.isolated.empty());
  }
}

TEST(TriangulateContacts, OnASphereIsClosed) {
  const TriangleMesh sphere = test::icosphere(4, 30);
  const ContactTriangulation result =
      triangulate_contacts(sphere, nearest_places(sphere, [] {
                             const TriangleMesh coarse = test::icosphere(1, 30);
                             std::vector<Vector3d> points;
                             for (const auto& v : coarse.vertices.colwise()) points.push_back(v);
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

TEST(TriangulateContacts, OnASphereIsClosedForContactsAtRandomToo) {
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
    const ContactTriangulation result = triangulate_contacts(sphere, contacts);
    const Counts counts = check_manifold(result.mesh);
    EXPECT_EQ(counts.vertices, 40);
    EXPECT_EQ(counts.euler(), 2);
  }
}

TEST(TriangulateContacts, OfOneSideOfAClosedSurfaceIsOpen) {
  // Behind the sphere the cells meet again; the triangles there would be a lid through its inside.
  const TriangleMesh sphere = test::icosphere(4, 30);
  std::vector<Vector3d> cap;
  for (const Vector3d& p : jittered_grid(4, 4, 7, 0.2))
    cap.emplace_back(p.x() - 17, p.y() - 17, 25);
  const ContactTriangulation result = triangulate_contacts(sphere, nearest_places(sphere, cap));
  const Counts counts = check_manifold(result.mesh);
  EXPECT_EQ(counts.vertices, 16);
  EXPECT_EQ(counts.euler(), 1);
  // A lid would point down; slivers at the border may be steep.
  EXPECT_GT(triangle_normals(result.mesh).row(2).minCoeff(), -0.5);
  const ContactTriangulation three = triangulate_contacts(
      sphere, nearest_places(sphere, {{10, 0.3, 25}, {-9, 9, 25}, {-8, -9, 25}}));
  EXPECT_EQ(three.mesh.triangles, Eigen::Vector3i(0, 1, 2));
}

TEST(TriangulateContacts, LabelsAreTheCellsOfTheContacts) {
  const TriangleMesh sheet = test::flat_sheet(40, 30, 1);
  const std::vector<SurfacePoint> contacts = nearest_places(sheet, jittered_grid(4, 3, 8, 0.3));
  const ContactTriangulation result = triangulate_contacts(sheet, contacts);
  EXPECT_EQ(result.surface_labels, geodesic_distance(sheet, contacts).label);
}

/// A closed tube about the z axis: a glove's finger without its tip.
TriangleMesh tube(int around, int along, double radius, double spacing) {
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

TEST(TriangulateContacts, IsAManifoldHoweverFewContactsThereAre) {
  std::vector<TriangleMesh> surfaces = {test::icosphere(3, 20), tube(40, 60, 8, 1.3),
                                        test::height_field(60, 50, 1, [](double x, double y) {
                                          return 12 * std::sin(x / 4) * std::cos(y / 5) +
                                                 3 * std::sin(x * y);
                                        })};
  std::mt19937 random(23);
  int triangulated = 0;
  for (const TriangleMesh& surface : surfaces) {
    std::uniform_int_distribution<int> any(0, static_cast<int>(surface.triangles.cols()) - 1);
    for (const int count : {3, 4, 5, 6, 8, 12, 20, 50, 150}) {
      for (int trial = 0; trial < 8; ++trial) {
        std::set<int> triangles;
        while (static_cast<int>(triangles.size()) < count) triangles.insert(any(random));
        std::vector<SurfacePoint> contacts;
        for (const int t : triangles) {
          contacts.push_back({.triangle = t, .barycentric = {0.2, 0.3, 0.5}});
        }
        try {
          const ContactTriangulation result = triangulate_contacts(surface, contacts);
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
  EXPECT_GT(triangulated, 150);
}

TEST(TriangulateContacts, ListsContactsInNoTriangle) {
  TriangleMesh two = test::flat_sheet(20, 20, 1);
  const Eigen::Index vertices = two.vertices.cols();
  const Eigen::Index triangles = two.triangles.cols();
  two.vertices.conservativeResize(3, 2 * vertices);
  two.vertices.rightCols(vertices) = two.vertices.leftCols(vertices).colwise() + Vector3d(0, 0, 5);
  two.triangles.conservativeResize(3, 2 * triangles);
  two.triangles.rightCols(triangles) =
      two.triangles.leftCols(triangles).array() + static_cast<int>(vertices);
  const ContactTriangulation result = triangulate_contacts(
      two, nearest_places(two, {{5, 5, 0}, {9, 9, 5}, {15, 5.5, 0}, {9.3, 15, 0}}));
  EXPECT_EQ(result.isolated, std::vector<int>{1});
  EXPECT_EQ(result.mesh.triangles.cols(), 1);
  EXPECT_EQ(result.mesh.triangles.col(0), Eigen::Vector3i(0, 2, 3));
}

TEST(TriangulateContacts, DoesNotDependOnTheUnitOfLength) {
  const TriangleMesh sheet = test::height_field(
      50, 40, 1, [](double x, double y) { return 4 * std::sin(x / 6) * std::sin(y / 7); });
  const std::vector<SurfacePoint> contacts = nearest_places(sheet, jittered_grid(6, 5, 7, 0.3));
  const ContactTriangulation expected = triangulate_contacts(sheet, contacts);
  for (const double factor : {0x1p-20, 0x1p20}) {
    const ContactTriangulation scaled = triangulate_contacts(test::scaled(sheet, factor), contacts);
    EXPECT_EQ(scaled.mesh.triangles, expected.mesh.triangles);
    EXPECT_EQ(scaled.surface_labels, expected.surface_labels);
  }
}

std::string refusal(const TriangleMesh& surface, const std::vector<SurfacePoint>& contacts) {
  try {
    (void)triangulate_contacts(surface, contacts);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TriangulateContacts, RefusesBadInputAndNamesIt) {
  const TriangleMesh sheet = test::flat_sheet(20, 20, 1);
  std::vector<SurfacePoint> contacts =
      nearest_places(sheet, {{5, 5, 0}, {15, 5, 0}, {10, 15, 0}, {5, 15, 0}});
  EXPECT_EQ(refusal(sheet, contacts), "accepted");
  EXPECT_NE(refusal({}, contacts).find("no triangles"), std::string::npos);
  EXPECT_NE(refusal(sheet, {contacts[0], contacts[1]}).find("got 2 contacts"), std::string::npos);
  contacts[3] = contacts[1];
  EXPECT_NE(refusal(sheet, contacts).find("contacts 1 and 3 are at the same place"),
            std::string::npos);
  contacts[3].triangle = 800;
  EXPECT_NE(refusal(sheet, contacts).find("contact 3"), std::string::npos);
  const std::vector<SurfacePoint> in_line =
      nearest_places(sheet, {{3, 10, 0}, {8, 10, 0}, {12, 10, 0}, {17, 10, 0}});
  EXPECT_NE(refusal(sheet, in_line).find("nowhere on the surface"), std::string::npos);
}

class OnASheet : public ::testing::Test {
 protected:
  TriangleMesh sheet = test::flat_sheet(80, 60, 1);
  ContactTriangulation contacts =
      triangulate_contacts(sheet, nearest_places(sheet, jittered_grid(7, 5, 9.7, 0.3)));
  ContactLocator locator{contacts.mesh};

  [[nodiscard]] Eigen::VectorXd all_weights(const Vector3d& point) const {
    const ContactWeights found = locator.locate(point);
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(contacts.mesh.vertices.cols());
    for (int k = 0; k < 3; ++k) weights[found.contacts[k]] += found.weights[k];
    return weights;
  }
};

using ContactLocatorTest = OnASheet;

TEST_F(ContactLocatorTest, WeightsReproduceLinearFunctionsAndSumToOne) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(16, 60);
  std::uniform_real_distribution<double> y(16, 42);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p(x(random), y(random), 0);
    const Eigen::VectorXd weights = all_weights(p);
    EXPECT_GE(weights.minCoeff(), 0);
    EXPECT_NEAR(weights.sum(), 1, kRounding);
    EXPECT_LT((contacts.mesh.vertices * weights - p).norm(), 60 * kRounding);
  }
}

TEST_F(ContactLocatorTest, TheWeightOfAContactAtItsOwnPlaceIsOne) {
  for (Eigen::Index i = 0; i < contacts.mesh.vertices.cols(); ++i) {
    EXPECT_NEAR(all_weights(contacts.mesh.vertices.col(i))[i], 1, kRounding);
  }
}

TEST_F(ContactLocatorTest, WeightsDoNotJumpBetweenTriangles) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> x(16, 60);
  std::uniform_real_distribution<double> y(16, 42);
  constexpr double kStep = 1e-6;
  // The steepest weight rises from 0 to 1 over the lowest height of a triangle; none is below this.
  constexpr double kLowestHeight = 0.5;
  for (int i = 0; i < 100; ++i) {
    const Vector3d a(x(random), y(random), 0.3);
    const Vector3d b(x(random), y(random), -0.2);
    for (int k = 0; k < 100; ++k) {
      const Vector3d p = a + k / 100.0 * (b - a);
      const Eigen::VectorXd change =
          all_weights(p + kStep * Vector3d(0.6, 0.8, 0)) - all_weights(p);
      EXPECT_LT(change.cwiseAbs().maxCoeff(), kStep / kLowestHeight);
    }
  }
  // Right across every edge.
  for (const Eigen::Vector3i t : contacts.mesh.triangles.colwise()) {
    const Vector3d middle =
        0.3 * contacts.mesh.vertices.col(t[0]) + 0.7 * contacts.mesh.vertices.col(t[1]);
    const Vector3d across = (contacts.mesh.vertices.col(t[2]) - middle).normalized();
    const Eigen::VectorXd change =
        all_weights(middle + kStep * across) - all_weights(middle - kStep * across);
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 2 * kStep / kLowestHeight);
  }
}

TEST_F(ContactLocatorTest, WeightsAreHeldBeyondTheBorder) {
  const Eigen::VectorXd at_corner = all_weights({-5, -7, 0});
  EXPECT_NEAR(at_corner[0], 1, kRounding);
  EXPECT_EQ(all_weights({-500, -700, 3}), at_corner);
}

TEST_F(ContactLocatorTest, SaysSoWhenThePlaceIsNotFinite) {
  const ContactWeights found = locator.locate({0, std::numeric_limits<double>::quiet_NaN(), 0});
  EXPECT_EQ(found.contacts, Eigen::Vector3i(-1, -1, -1));
  EXPECT_EQ(found.weights, Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace palpate::geometry
