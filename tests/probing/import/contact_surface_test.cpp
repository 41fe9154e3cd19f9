// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_topology.h"
#include "refusal.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A grid of contacts 10 mm apart on the height field z(x, y), seen from +z.
std::vector<Contact> contacts_on(int columns, int rows,
                                 const std::function<double(double, double)>& z) {
  std::vector<Contact> contacts;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = 10 * column, y = 10 * row, step = 1e-4;
      const Eigen::Vector3d normal((z(x - step, y) - z(x + step, y)) / (2 * step),
                                   (z(x, y - step) - z(x, y + step)) / (2 * step), 1);
      contacts.push_back(
          {100 + static_cast<long long>(contacts.size()), {x, y, z(x, y)}, normal.normalized()});
    }
  }
  return contacts;
}

double area_of(const geometry::TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(t[0]);
    area += (mesh.vertices.col(t[1]) - a).cross(mesh.vertices.col(t[2]) - a).norm() / 2;
  }
  return area;
}

double flat(double /*x*/, double /*y*/) { return 700; }

TEST(ContactSurface, OfAGridCoversItInAnyFrame) {
  std::vector<Contact> contacts = contacts_on(6, 4, flat);
  for (const double angle : {0.0, 0.7, 2.9}) {
    const Eigen::Matrix3d turn(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, -2, 0.5).normalized()));
    std::vector<Contact> turned = contacts;
    for (Contact& contact : turned) {
      contact.position = turn * contact.position;
      contact.normal = turn * contact.normal;
    }
    const geometry::TriangleMesh mesh = contact_surface(turned).mesh;
    EXPECT_EQ(mesh.triangles.cols(), 2 * 5 * 3);
    EXPECT_NEAR(area_of(mesh), 50 * 30, 1e-9);
    EXPECT_TRUE(geometry::find_defects(mesh).empty());
    EXPECT_EQ(geometry::boundary_loops(mesh).size(), 1u);
    const Eigen::Matrix3Xd normals = geometry::triangle_normals(mesh);
    EXPECT_GT((turned[0].normal.transpose() * normals).minCoeff(), 0.999);
    for (std::size_t i = 0; i < turned.size(); ++i)
      EXPECT_EQ(mesh.vertices.col(static_cast<Eigen::Index>(i)), turned[i].position);
  }
}

TEST(ContactSurface, ApproachesACurvedSurfaceWithTheSquareOfTheSpacing) {
  const double radius = 60;
  const auto dome = [&](double x, double y) {
    return std::sqrt(radius * radius - std::pow(x - 25, 2) - std::pow(y - 25, 2));
  };
  const geometry::TriangleMesh mesh = contact_surface(contacts_on(6, 6, dome)).mesh;
  for (const auto& t : mesh.triangles.colwise()) {
    const Eigen::Vector3d middle =
        (mesh.vertices.col(t[0]) + mesh.vertices.col(t[1]) + mesh.vertices.col(t[2])) / 3;
    const double depth = radius - (middle - Eigen::Vector3d(25, 25, 0)).norm();
    EXPECT_GT(depth, 0);
    // The sagitta of the longest edge, which is up to sqrt(2) * 10 mm across and steeper than that.
    EXPECT_LT(depth, std::pow(1.3 * std::numbers::sqrt2 * 10 / 2, 2) / (2 * radius));
  }
}

TEST(ContactSurface, HasNoNeedlesAtANoisyBorderAndNoBridges) {
  std::vector<Contact> contacts = contacts_on(8, 8, flat);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.3, 0.3);
  for (Contact& contact : contacts)
    contact.position += Eigen::Vector3d{noise(random), noise(random), noise(random)};
  geometry::TriangleMesh mesh = contact_surface(contacts).mesh;
  EXPECT_TRUE(geometry::find_defects(mesh).empty());
  EXPECT_EQ(mesh.triangles.cols(), 2 * 7 * 7);
  // Without the quarter in the corner, the surface has an L's area, up to the corner that an edge
  // of 30 mm cuts off. The convex hull would have 1800 mm^2 more.
  contacts = contacts_on(13, 13, flat);
  std::erase_if(contacts, [](const Contact& contact) {
    return contact.position.x() > 60 && contact.position.y() > 60;
  });
  mesh = contact_surface(contacts).mesh;
  EXPECT_NEAR(area_of(mesh), 120 * 120 - 60 * 60, 30 * 30 / 4.0);
}

TEST(ContactSurface, IsNotRefusedForASliverOfItsHull) {
  // A saddle with a dent at its border, where normals lean outwards. The three contacts there are
  // nearly in a line, seen from above, and the sliver between them is steep and faces inwards.
  const auto saddle = [](double x, double y) {
    return 0.02 * std::pow(x - 35, 2) - 0.02 * std::pow(y - 35, 2);
  };
  std::vector<Contact> contacts = contacts_on(8, 8, saddle);
  contacts[3].position += Eigen::Vector3d(0, 0.3, -2.6);
  const ContactSurface surface = contact_surface(contacts);
  EXPECT_TRUE(surface.left_out.empty());
  EXPECT_EQ(surface.kept.size(), 64u);
  EXPECT_EQ(surface.mesh.triangles.cols(), 2 * 7 * 7);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(surface.mesh);
  EXPECT_GT(normals.row(2).minCoeff(), 0.25);
}

TEST(ContactSurface, IsMadeWithoutOneInFiftyContactsThatDoNotFit) {
  const std::vector<Contact> good = contacts_on(10, 10, flat);
  std::vector<Contact> contacts = good;
  contacts[7].normal *= -1;
  contacts[99].position.x() += 200;
  ContactSurface surface = contact_surface(contacts);
  ASSERT_EQ(surface.left_out.size(), 2u);
  EXPECT_EQ(surface.left_out[0].id, 107);
  EXPECT_THAT(surface.left_out[0].reason, HasSubstr("75 degrees"));
  EXPECT_EQ(surface.left_out[1].id, 199);
  EXPECT_THAT(surface.left_out[1].reason, HasSubstr("in no triangle"));
  ASSERT_EQ(surface.kept.size(), 98u);
  for (std::size_t k = 0; k < surface.kept.size(); ++k) {
    EXPECT_EQ(surface.mesh.vertices.col(static_cast<Eigen::Index>(k)),
              contacts[surface.kept[k]].position);
  }
  EXPECT_THAT(surface.kept, ::testing::Not(::testing::Contains(7u)));

  // A normal that faces away from the surface around it, but not from the mean normal: on a fold.
  contacts = contacts_on(10, 10, [](double x, double /*y*/) { return 30 - std::abs(x - 30); });
  ASSERT_TRUE(contact_surface(contacts).left_out.empty());
  contacts[51].normal = Eigen::Vector3d(0.8, 0, 0.6);
  surface = contact_surface(contacts);
  ASSERT_EQ(surface.left_out.size(), 1u);
  EXPECT_EQ(surface.left_out[0].id, 151);
  EXPECT_THAT(surface.left_out[0].reason, HasSubstr("faces away"));
}

TEST(ContactSurface, IsRefusedIfMoreThanOneInFiftyContactsDoNotFit) {
  std::vector<Contact> contacts = contacts_on(10, 10, flat);
  for (const std::size_t i : {7u, 31u, 68u}) contacts[i].normal *= -1;
  EXPECT_THAT(refusal([&] { return contact_surface(contacts); }),
              AllOf(HasSubstr("contact 107"), HasSubstr("3 contacts in all"),
                    HasSubstr("one side of an object")));
  // All normals point into an object that has other sides.
  for (std::size_t i = 0; i < contacts.size(); i += 2) contacts[i].normal *= -1;
  EXPECT_THAT(refusal([&] { return contact_surface(contacts); }), HasSubstr("contacts in all"));
}

TEST(ContactSurface, IsRefusedWhereContactsDoNotMakeOne) {
  const auto refused = [](const std::vector<Contact>& contacts) {
    return refusal([&] { return contact_surface(contacts); });
  };
  EXPECT_THAT(refused(contacts_on(2, 1, flat)), HasSubstr("at least three"));
  EXPECT_THAT(refused(contacts_on(5, 1, flat)), HasSubstr("in a line"));
  std::vector<Contact> contacts = contacts_on(5, 5, flat);
  contacts[7].normal *= -1;
  EXPECT_THAT(refused(contacts), AllOf(HasSubstr("contact 107"), HasSubstr("one side")));
  contacts = contacts_on(5, 5, flat);
  contacts[24].position.x() += 200;
  EXPECT_THAT(refused(contacts), AllOf(HasSubstr("contact 124"), HasSubstr("no triangle")));
  // A ball all around.
  contacts.clear();
  for (int i = 0; i < 50; ++i) {
    const double z = 1 - (2 * i + 1) / 50.0, angle = 2.4 * i, r = std::sqrt(1 - z * z);
    const Eigen::Vector3d n(r * std::cos(angle), r * std::sin(angle), z);
    contacts.push_back({i, 30 * n, n});
  }
  EXPECT_THAT(refused(contacts), HasSubstr("one side"));
  // A step whose triangles contradict the normals.
  contacts = contacts_on(6, 6, [](double x, double /*y*/) { return x < 25 ? 0 : 12; });
  for (Contact& contact : contacts)
    if (contact.position.x() > 25) contact.normal = Eigen::Vector3d(0.8, 0, 0.6);
  EXPECT_THAT(refused(contacts), AllOf(HasSubstr("faces away"), HasSubstr("folded")));
}

}  // namespace
}  // namespace palpate::probing
