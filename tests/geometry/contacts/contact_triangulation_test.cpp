// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/contact_triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "contacts/contact_testing.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_repair.h"
#include "refusal.h"
#include "repository.h"
#include "test_surfaces.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using test::check_manifold;
using test::Counts;
using test::euler_characteristic_of_fans;
using test::jittered_grid;
using test::kWeightRounding;
using test::nearest_places;
using test::random_contacts;

/// The parts of the surface that have a contact, according to the weights.
TriangleMesh parts_with_contacts(const TriangleMesh& surface, const SurfaceWeights& weights) {
  TriangleMesh parts = surface;
  Eigen::Index kept = 0;
  for (const Eigen::Vector3i t : surface.triangles.colwise()) {
    const bool has_contact =
        std::ranges::all_of(t, [&](int corner) { return weights.contacts(0, corner) >= 0; });
    if (has_contact) parts.triangles.col(kept++) = t;
  }
  parts.triangles.conservativeResize(3, kept);
  return parts;
}

double angle_opposite(const IntrinsicDelaunay& intrinsic, int h) {
  const double a = intrinsic.lengths((h + 1) % 3, h / 3);
  const double b = intrinsic.lengths((h + 2) % 3, h / 3);
  const double c = intrinsic.lengths(h % 3, h / 3);
  return std::acos(std::clamp((a * a + b * b - c * c) / (2 * a * b), -1.0, 1.0));
}

/// Gluing, the same length on both sides, corners that agree, and the Delaunay property.
void check_intrinsic(const IntrinsicDelaunay& intrinsic) {
  // The arc cosine of angles near pi loses half of the digits.
  constexpr double kAngleRounding = 1e-6;
  const auto corner = [&](int h) { return intrinsic.triangles(h % 3, h / 3); };
  const auto next = [](int h) { return h % 3 == 2 ? h - 2 : h + 1; };
  for (int h = 0; h < static_cast<int>(intrinsic.triangles.size()); ++h) {
    const int o = intrinsic.opposite(h % 3, h / 3);
    ASSERT_GT(intrinsic.lengths(h % 3, h / 3), 0);
    if (o < 0) continue;
    ASSERT_EQ(intrinsic.opposite(o % 3, o / 3), h);
    ASSERT_EQ(corner(o), corner(next(h)));
    ASSERT_EQ(intrinsic.lengths(o % 3, o / 3), intrinsic.lengths(h % 3, h / 3));
    EXPECT_LE(angle_opposite(intrinsic, h) + angle_opposite(intrinsic, o),
              std::numbers::pi + kAngleRounding);
  }
}

void check_weights(const TriangleMesh& surface, const SurfaceWeights& weights) {
  ASSERT_EQ(weights.contacts.cols(), surface.vertices.cols());
  for (Eigen::Index v = 0; v < weights.contacts.cols(); ++v) {
    EXPECT_GE(weights.weights.col(v).minCoeff(), 0);
    EXPECT_NEAR(weights.weights.col(v).sum(), weights.contacts(0, v) < 0 ? 0 : 1, kWeightRounding);
  }
}

struct Corpus {
  const char* name;
  TriangleMesh mesh;
};

std::vector<Corpus> corpus() {
  return {{"range map with noise and holes", test::bumpy(9000, 0.25)},
          {"glove", test::glove(4.3)},
          {"thin closed sheet", test::closed_sheet(45, 30)},
          {"thin torus", test::torus(120, 20, 50, 2)},
          {"torus of triangular section", test::torus(800, 3, 50, 1)},
          {"sphere", test::icosphere(4, 30)},
          {"hand", read_mesh(repository("meshes/hand.ply"))}};
}

TEST(TriangulateContacts, IsADelaunayTriangulationOfTheSurfaceWhateverItsShape) {
  for (const Corpus& surface : corpus()) {
    for (const int count : {3, 4, 10, 50, 200, 1000}) {
      SCOPED_TRACE(std::string(surface.name) + ", " + std::to_string(count) + " contacts");
      const std::vector<SurfacePoint> contacts = random_contacts(surface.mesh, count, 3);
      const ContactTriangulation result = triangulate_contacts(surface.mesh, contacts);
      check_intrinsic(result.intrinsic);
      check_weights(surface.mesh, result.weights);
      check_manifold(result.mesh);
      // By corners alone it is a triangulation too, of the same kind of surface.
      const Counts counts =
          check_manifold({.vertices = {}, .triangles = result.intrinsic.triangles});
      EXPECT_EQ(counts.vertices, count + static_cast<int>(result.intrinsic.helpers.cols()));
      EXPECT_EQ(counts.euler(),
                euler_characteristic_of_fans(parts_with_contacts(surface.mesh, result.weights)));
      for (size_t i = 0; i < contacts.size(); ++i) {
        int corner = 0;
        if (contacts[i].barycentric.maxCoeff(&corner) < 1) continue;
        const int v = surface.mesh.triangles(corner, contacts[i].triangle);
        EXPECT_EQ(result.weights.contacts(0, v), static_cast<int>(i));
        EXPECT_NEAR(result.weights.weights(0, v), 1, kWeightRounding);
      }
    }
  }
}

TEST(TriangulateContacts, OfManyContactsOnClosedSurfacesIsClosedToo) {
  const std::vector<Corpus> closed = {{"glove", test::glove(4.3)},
                                      {"thin torus", test::torus(240, 20, 50, 2)},
                                      {"sphere", test::icosphere(4, 30)}};
  for (const Corpus& surface : closed) {
    SCOPED_TRACE(surface.name);
    const ContactTriangulation result =
        triangulate_contacts(surface.mesh, random_contacts(surface.mesh, 800, 5));
    EXPECT_TRUE(result.isolated.empty());
    const Counts counts = check_manifold(result.mesh);
    EXPECT_EQ(counts.vertices, 800);
    if (result.intrinsic.helpers.cols() == 0) {
      EXPECT_EQ(counts.euler(), euler_characteristic_of_fans(surface.mesh));
    }
  }
}

TEST(TriangulateContacts, LeavesNoContactOutWhereTheVoronoiDualDoes) {
  const TriangleMesh glove = test::glove(4.3);
  size_t isolated = 0;
  size_t isolated_by_dual = 0;
  for (const unsigned seed : {1, 2, 3}) {
    const std::vector<SurfacePoint> contacts = random_contacts(glove, 100, seed);
    isolated += triangulate_contacts(glove, contacts).isolated.size();
    isolated_by_dual +=
        triangulate_contacts(glove, contacts, {.method = ContactTriangulationMethod::voronoi_dual})
            .isolated.size();
  }
  EXPECT_EQ(isolated, 0);
  EXPECT_GT(isolated_by_dual, 0);
}

class OnAFlatSheet : public ::testing::Test {
 protected:
  static constexpr double kWidth = 70;
  static constexpr double kHeight = 50;
  TriangleMesh sheet = test::flat_sheet(140, 100, 0.5);
  ContactTriangulation contacts =
      triangulate_contacts(sheet, nearest_places(sheet, jittered_grid(8, 6, 7.3, 0.4)));
};

TEST_F(OnAFlatSheet, IsThePlanarDelaunayTriangulation) {
  const Eigen::Matrix3Xd& places = contacts.mesh.vertices;
  EXPECT_TRUE(contacts.isolated.empty());
  std::set<std::array<int, 3>> found;
  for (const Eigen::Vector3i t : contacts.mesh.triangles.colwise()) {
    found.insert(test::sorted_corners(t));
  }
  int expected = 0;
  const int count = static_cast<int>(places.cols());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      for (int c = b + 1; c < count; ++c) {
        const test::Circle circle = test::circumcircle(
            places.col(a).head<2>(), places.col(b).head<2>(), places.col(c).head<2>());
        const double x = circle.centre.x();
        const double y = circle.centre.y();
        // Helpers on the border are sites too.
        if (std::min({x, y, kWidth - x, kHeight - y}) < circle.radius) continue;
        const std::array<int, 3> corners = {a, b, c};
        const bool is_delaunay =
            test::nearest_other(places, corners, circle.centre) > circle.radius;
        expected += is_delaunay ? 1 : 0;
        EXPECT_EQ(found.contains(corners), is_delaunay) << a << " " << b << " " << c;
      }
    }
  }
  EXPECT_GT(expected, 50);
}

TEST_F(OnAFlatSheet, WeightsReproduceLinearFunctionsBetweenContacts) {
  int inside = 0;
  for (Eigen::Index v = 0; v < sheet.vertices.cols(); ++v) {
    const Vector3d p = sheet.vertices.col(v);
    // Within the outermost contacts, wherever those were moved to.
    constexpr double kOutermost = 1.4 * 7.3;
    const double border = std::min({p.x(), p.y(), 9 * 7.3 - p.x(), 7 * 7.3 - p.y()});
    if (border < kOutermost) continue;
    ++inside;
    Vector3d reproduced = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      if (contacts.weights.contacts(k, v) < 0) continue;
      reproduced += contacts.weights.weights(k, v) *
                    contacts.mesh.vertices.col(contacts.weights.contacts(k, v));
    }
    EXPECT_LT((reproduced - p).norm(), kWidth * kWeightRounding);
  }
  EXPECT_GT(inside, 5000);
}

/// The largest difference of any contact's weight between two neighbouring vertices.
double largest_jump(const TriangleMesh& surface, const SurfaceWeights& weights) {
  double largest = 0;
  const auto weight = [&](int v, int contact) {
    for (int k = 0; k < 3; ++k) {
      if (weights.contacts(k, v) == contact) return weights.weights(k, v);
    }
    return 0.0;
  };
  for (const Eigen::Vector3i t : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        const int contact = weights.contacts(j, t[k]);
        largest =
            std::max(largest, std::abs(weights.weights(j, t[k]) - weight(t[(k + 1) % 3], contact)));
      }
    }
  }
  return largest;
}

TEST(TriangulateContacts, WeightsJumpLessTheFinerTheSurfaceIs) {
  const TriangleMesh corners = test::icosphere(1, 30);
  std::vector<Vector3d> points;
  for (const auto& v : corners.vertices.colwise()) points.emplace_back(v + Vector3d(0.7, 0.3, 0.2));
  double coarser = 1;
  for (const int levels : {4, 5, 6}) {
    const TriangleMesh sphere = test::icosphere(levels, 30);
    const double jump =
        largest_jump(sphere, triangulate_contacts(sphere, nearest_places(sphere, points)).weights);
    EXPECT_LT(jump, 0.65 * coarser) << levels;
    coarser = jump;
  }
  // An open surface, on which helpers at the border have a part in the result.
  coarser = 1;
  for (const int cells : {40, 80, 160}) {
    const TriangleMesh sheet = test::height_field(
        cells, cells, 80.0 / cells,
        [](double x, double y) { return 6 * std::sin(x / 11) * std::sin(y / 13); });
    const double jump = largest_jump(
        sheet,
        triangulate_contacts(sheet, nearest_places(sheet, jittered_grid(4, 4, 16, 0.2))).weights);
    EXPECT_LT(jump, 0.7 * coarser) << cells;
    coarser = jump;
  }
}

TEST(TriangulateContacts, DoesNotDependOnTheUnitOfLength) {
  const TriangleMesh surface = test::bumpy(2000, 0.25);
  const std::vector<SurfacePoint> contacts = random_contacts(surface, 40, 7);
  const ContactTriangulation expected = triangulate_contacts(surface, contacts);
  for (const double factor : {0x1p-20, 0x1p20}) {
    const ContactTriangulation scaled =
        triangulate_contacts(test::scaled(surface, factor), contacts);
    EXPECT_EQ(scaled.mesh.triangles, expected.mesh.triangles);
    EXPECT_EQ(scaled.weights.contacts, expected.weights.contacts);
    EXPECT_EQ(scaled.weights.weights, expected.weights.weights);
    EXPECT_EQ(scaled.intrinsic.lengths, factor * expected.intrinsic.lengths);
  }
}

/// Two meshes side by side.
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both;
  both.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  both.vertices << a.vertices, b.vertices;
  both.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  both.triangles << a.triangles, b.triangles.array() + static_cast<int>(a.vertices.cols());
  return both;
}

TEST(TriangulateContacts, KeepsPartsApart) {
  TriangleMesh second = test::flat_sheet(20, 20, 1);
  TriangleMesh third = second;
  second.vertices.row(2).array() += 5;
  third.vertices.row(2).array() += 10;
  const TriangleMesh first = test::flat_sheet(20, 20, 1);
  const TriangleMesh three = joined(joined(first, second), third);
  const ContactTriangulation result = triangulate_contacts(
      three, nearest_places(three, {{5, 5, 0}, {9, 9, 5}, {15, 5.5, 0}, {9.3, 15, 0}}));
  EXPECT_EQ(result.isolated, std::vector<int>{1});
  EXPECT_EQ(result.mesh.triangles, Eigen::Vector3i(0, 2, 3));
  for (Eigen::Index v = 0; v < three.vertices.cols(); ++v) {
    const double z = three.vertices(2, v);
    if (z == 5) {  // its only contact
      EXPECT_EQ(result.weights.contacts.col(v), Eigen::Vector3i(1, -1, -1));
      EXPECT_EQ(result.weights.weights(0, v), 1);
    } else {
      EXPECT_EQ(result.weights.contacts(0, v) < 0, z == 10);
      EXPECT_FALSE((result.weights.contacts.col(v).array() == 1).any());
    }
    EXPECT_EQ(result.surface_labels[v], result.weights.contacts(0, v));
  }
}

TEST(TriangulateContacts, CopesWithSheetsThatTouchInAVertex) {
  const TriangleMesh first = test::flat_sheet(12, 12, 1);
  TriangleMesh second = first;
  second.vertices.topRows(2).array() += 12;
  TriangleMesh both = joined(first, second);
  // The last vertex of the first is the first of the second.
  const int shared = static_cast<int>(first.vertices.cols()) - 1;
  both.triangles = (both.triangles.array() == shared + 1).select(shared, both.triangles);
  const ContactTriangulation result = triangulate_contacts(
      both, nearest_places(
                both, {{3, 3, 0}, {9, 4, 0}, {5, 9, 0}, {15, 16, 0}, {20, 15, 0}, {17, 21, 0}}));
  EXPECT_TRUE(result.isolated.empty());
  check_intrinsic(result.intrinsic);
  EXPECT_EQ(result.mesh.triangles.cols(), 2);
  EXPECT_GT(result.weights.contacts(2, shared), -1);
  EXPECT_NEAR(result.weights.weights.col(shared).sum(), 1, kWeightRounding);
}

/// Moves the first corner of every n-th triangle onto its second one; none twice, and no
/// neighbours.
TriangleMesh with_edges_of_no_length(TriangleMesh mesh, Eigen::Index n) {
  std::set<int> touched;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); t += n) {
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    if (std::ranges::any_of(corners, [&](int v) { return touched.contains(v); })) continue;
    mesh.vertices.col(corners[0]) = mesh.vertices.col(corners[1]);
    touched.insert(corners.begin(), corners.end());
  }
  return mesh;
}

TEST(TriangulateContacts, OnAClosedSurfaceLeavesNoContactOutBesideEdgesOfNoLength) {
  const TriangleMesh whole = test::icosphere(3, 40);
  const TriangleMesh sphere = with_edges_of_no_length(whole, 7);
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::vector<Vector3d> points;
    for (const SurfacePoint& at : random_contacts(whole, 24, seed)) {
      points.push_back(position(whole, at));
    }
    const ContactTriangulation result =
        triangulate_contacts(sphere, nearest_places(sphere, points));
    EXPECT_TRUE(result.isolated.empty()) << seed;
  }
}

TEST(TriangulateContacts, BesideEdgesOfNoLengthIsThatOfTheRepairedSurface) {
  const TriangleMesh sheet = with_edges_of_no_length(test::flat_sheet(30, 20, 1), 16);
  const TriangleMesh clean = repair_mesh(sheet).mesh;
  ASSERT_LT(clean.vertices.cols(), sheet.vertices.cols());
  const std::vector<Vector3d> points = jittered_grid(6, 4, 4, 0.3);
  const ContactTriangulation result = triangulate_contacts(sheet, nearest_places(sheet, points));
  const ContactTriangulation same = triangulate_contacts(clean, nearest_places(clean, points));
  check_intrinsic(result.intrinsic);
  check_weights(sheet, result.weights);
  EXPECT_EQ(result.isolated, same.isolated);
  EXPECT_EQ(result.mesh.triangles, same.mesh.triangles);
}

TEST(TriangulateContacts, TakesManyContactsInOneTriangleAndAlongEdges) {
  const TriangleMesh sheet = test::flat_sheet(2, 2, 50);
  const ContactTriangulation result =
      triangulate_contacts(sheet, nearest_places(sheet, jittered_grid(9, 9, 10, 0)));
  EXPECT_TRUE(result.isolated.empty());
  EXPECT_EQ(check_manifold(result.mesh).euler(), 1);
  EXPECT_EQ(result.mesh.triangles.cols(), 128);
}

TEST(TriangulateContacts, GivesAHelperAmongThousandsOfContactsAContact) {
  // A fan of half a disc: its hub is pinned on the border, where each weight is below 0.001.
  constexpr int kRim = 2000;
  TriangleMesh fan{.vertices = Eigen::Matrix3Xd::Zero(3, kRim + 1),
                   .triangles = Eigen::Matrix3Xi(3, kRim - 1)};
  std::vector<SurfacePoint> contacts;
  for (int i = 0; i < kRim; ++i) {
    const double angle = std::numbers::pi * i / (kRim - 1);
    fan.vertices.col(i + 1) << 50 * std::cos(angle), 50 * std::sin(angle), 0;
    if (i + 1 < kRim) fan.triangles.col(i) << 0, i + 1, i + 2;
    contacts.push_back(
        {std::min(i, kRim - 2), i + 1 < kRim ? Vector3d(0, 1, 0) : Vector3d(0, 0, 1)});
  }
  const ContactTriangulation result = triangulate_contacts(fan, contacts);
  check_weights(fan, result.weights);
  EXPECT_GE(result.weights.contacts(0, 0), 0);
}

TEST(TriangulateContacts, AcceptsContactsOnOneLine) {
  const TriangleMesh sheet = test::flat_sheet(20, 20, 1);
  const ContactTriangulation result = triangulate_contacts(
      sheet, nearest_places(sheet, {{3, 10, 0}, {8, 10, 0}, {12, 10, 0}, {17, 10, 0}}));
  check_weights(sheet, result.weights);
  EXPECT_GE(result.weights.contacts.row(0).minCoeff(), 0);
}

TEST(TriangulateContacts, TellsItsProgress) {
  const TriangleMesh sheet = test::flat_sheet(60, 60, 1);
  const std::vector<SurfacePoint> contacts = nearest_places(sheet, jittered_grid(6, 6, 10, 0.3));
  const auto work = [&](ContactTriangulationMethod method) {
    return [&, method](const auto& progress) {
      (void)triangulate_contacts(sheet, contacts, {.method = method, .progress = progress});
    };
  };
  check_progress(work(ContactTriangulationMethod::delaunay), 10);
  check_progress(work(ContactTriangulationMethod::voronoi_dual), 1);
}

TEST(TriangulateContacts, RefusesBadInputAndNamesIt) {
  const auto refused = [](const TriangleMesh& surface, const std::vector<SurfacePoint>& contacts) {
    return refusal([&] { return triangulate_contacts(surface, contacts); });
  };
  TriangleMesh sheet = test::flat_sheet(20, 20, 1);
  std::vector<SurfacePoint> contacts =
      nearest_places(sheet, {{5, 5, 0}, {15, 5, 0}, {10, 15, 0}, {5, 15, 0}});
  EXPECT_NO_THROW((void)triangulate_contacts(sheet, contacts));
  EXPECT_NE(refused({}, contacts).find("no triangles"), std::string::npos);
  EXPECT_NE(refused(sheet, {contacts[0], contacts[1]}).find("got 2 contacts"), std::string::npos);
  std::vector<SurfacePoint> twice = contacts;
  twice[3] = twice[1];
  EXPECT_NE(refused(sheet, twice).find("contacts 1 and 3 are at the same place"),
            std::string::npos);
  twice[3].triangle = 800;
  EXPECT_NE(refused(sheet, twice).find("contact 3"), std::string::npos);
  sheet.triangles.col(7).reverseInPlace();
  EXPECT_NE(refused(sheet, contacts).find("both run along the edge"), std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
