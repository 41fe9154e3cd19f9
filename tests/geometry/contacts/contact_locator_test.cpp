// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/contact_locator.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "contacts/contact_testing.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_topology.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// Some tens of operations on values of the order of one.
constexpr double kLocatorRounding = 1e-12;

class ContactLocatorTest : public ::testing::Test {
 protected:
  /// In faces, on an edge, at a vertex, and several in one triangle.
  static std::vector<SurfacePoint> some_contacts(const TriangleMesh& surface) {
    std::vector<SurfacePoint> contacts =
        test::nearest_places(surface, test::jittered_grid(5, 4, 13, 0.3));
    contacts.push_back({.triangle = 11, .barycentric = {0.31, 0.69, 0}});
    contacts.push_back(corner_point(1301, 2));
    contacts.push_back({.triangle = 2500, .barycentric = {0.2, 0.3, 0.5}});
    contacts.push_back({.triangle = 2500, .barycentric = {0.6, 0.3, 0.1}});
    contacts.push_back({.triangle = 2500, .barycentric = {0.4, 0, 0.6}});
    return contacts;
  }

  TriangleMesh surface = test::height_field(
      70, 60, 1.1, [](double x, double y) { return 5 * std::sin(x / 9) * std::sin(y / 8); });
  std::vector<SurfacePoint> contacts = some_contacts(surface);
  SurfaceWeights weights = triangulate_contacts(surface, contacts).weights;
  ContactLocator locator{surface, contacts, weights};

  [[nodiscard]] Eigen::VectorXd all_weights(const SurfacePoint& at) const {
    const ContactWeights found = locator.locate(at);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(contacts.size()));
    for (int i = 0; i < found.count; ++i) {
      result[found.contacts[static_cast<size_t>(i)]] += found.weights[static_cast<size_t>(i)];
    }
    return result;
  }
  [[nodiscard]] Eigen::VectorXd at_vertex(int v) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(contacts.size()));
    for (int k = 0; k < 3; ++k) {
      if (weights.contacts(k, v) >= 0) result[weights.contacts(k, v)] = weights.weights(k, v);
    }
    return result;
  }
};

TEST_F(ContactLocatorTest, TheWeightOfAContactAtItsOwnPlaceIsOne) {
  for (size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_NEAR(all_weights(contacts[i])[static_cast<Eigen::Index>(i)], 1, kLocatorRounding) << i;
  }
}

TEST_F(ContactLocatorTest, WeightsAreLinearInATriangleWithoutContacts) {
  std::set<int> cut = {11};
  const Eigen::Matrix3Xi opposite = opposite_half_edges(surface);
  for (const SurfacePoint& contact : contacts) {
    cut.insert(contact.triangle);
    for (int k = 0; k < 3; ++k) cut.insert(opposite(k, contact.triangle) / 3);
  }
  for (int t = 0; t < surface.triangles.cols(); t += 3) {
    if (cut.contains(t)) continue;
    const Vector3d place(0.2, 0.35, 0.45);
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(contacts.size()));
    for (int k = 0; k < 3; ++k) expected += place[k] * at_vertex(surface.triangles(k, t));
    EXPECT_LT((all_weights({t, place}) - expected).cwiseAbs().maxCoeff(), kLocatorRounding);
  }
}

TEST_F(ContactLocatorTest, WeightsAreTheSameFromBothSidesOfEveryEdge) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(surface);
  for (int h = 0; h < static_cast<int>(surface.triangles.size()); ++h) {
    const int o = opposite(h % 3, h / 3);
    if (o < h) continue;
    for (const double part : {0.0, 0.17, 0.31, 0.52, 0.69, 0.93}) {
      SurfacePoint here{.triangle = h / 3};
      here.barycentric[h % 3] = 1 - part;
      here.barycentric[(h + 1) % 3] = part;
      SurfacePoint there{.triangle = o / 3};
      there.barycentric[o % 3] = part;
      there.barycentric[(o + 1) % 3] = 1 - part;
      EXPECT_LT((all_weights(here) - all_weights(there)).cwiseAbs().maxCoeff(), kLocatorRounding)
          << h << " " << part;
    }
  }
}

TEST_F(ContactLocatorTest, WeightsDoNotJumpInATriangleThatIsCut) {
  constexpr double kStep = 1e-7;
  // The steepest weight goes from 0 to 1 within the smallest distance between contacts in it.
  constexpr double kSlope = 20;
  for (double a = 0.005; a < 1; a += 0.013) {
    for (double b = 0.004; a + b < 0.999; b += 0.017) {
      const Vector3d place(a, b, 1 - a - b);
      const Vector3d near = place + kStep * Vector3d(1, 0.3, -1.3);
      const Eigen::VectorXd change = all_weights({2500, near}) - all_weights({2500, place});
      EXPECT_LT(change.cwiseAbs().maxCoeff(), kSlope * kStep);
      EXPECT_NEAR(all_weights({2500, place}).sum(), 1, kLocatorRounding);
    }
  }
}

TEST_F(ContactLocatorTest, AContactThatIsNotOnTheSurfaceCutsNothing) {
  std::vector<SurfacePoint> without(contacts.size());
  const ContactLocator uncut(surface, without, weights);
  const ContactWeights found = uncut.locate({2500, {0.6, 0.3, 0.1}});
  double own = 0;
  for (int i = 0; i < found.count; ++i) {
    if (found.contacts[static_cast<size_t>(i)] == 23) own = found.weights[static_cast<size_t>(i)];
  }
  EXPECT_LT(own, 0.9);
}

TEST_F(ContactLocatorTest, SaysSoWhenThereIsNoSuchPlace) {
  EXPECT_EQ(locator.locate({-1, {1, 0, 0}}).count, 0);
  EXPECT_EQ(locator.locate({1 << 30, {1, 0, 0}}).count, 0);
  EXPECT_EQ(locator.locate({0, {0.5, 0.5, std::numeric_limits<double>::quiet_NaN()}}).count, 0);
  EXPECT_EQ(locator.locate({0, {0.5, 0.5, std::numeric_limits<double>::infinity()}}).count, 0);
  EXPECT_EQ(locator.locate({2500, {0, 0, 0}}).count, 0);
}

TEST_F(ContactLocatorTest, RefusesWeightsOfAnotherSurface) {
  try {
    const ContactLocator wrong(test::flat_sheet(3, 3, 1), {}, weights);
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("the surface has 16"), std::string::npos);
  }
}

TEST_F(ContactLocatorTest, RefusesWeightsThatAreNoneAndNamesTheVertex) {
  const auto locator_with = [&](int contact, double weight) {
    SurfaceWeights wrong = weights;
    wrong.contacts(1, 77) = contact;
    wrong.weights(1, 77) = weight;
    return ContactLocator(surface, contacts, wrong);
  };
  const auto refused = [&](int contact, double weight) {
    return refusal([&] { return locator_with(contact, weight); });
  };
  const auto count = static_cast<int>(contacts.size());
  EXPECT_NO_THROW((void)locator_with(-1, 0));
  EXPECT_NO_THROW((void)locator_with(count - 1, 0.5));
  EXPECT_NE(refused(-2, 0).find("vertex 77 name contact -2"), std::string::npos);
  EXPECT_NE(refused(count, 0.5).find("vertex 77"), std::string::npos);
  for (const double bad :
       {-0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(refused(0, bad).find("vertex 77"), std::string::npos) << bad;
  }
}

TEST(ProjectWeights, ReproduceLinearFunctionsOnAFlatSheet) {
  const TriangleMesh sheet = test::flat_sheet(80, 60, 1);
  const TriangleMesh contacts =
      triangulate_contacts(sheet, test::nearest_places(sheet, test::jittered_grid(7, 5, 9.7, 0.3)))
          .mesh;
  const SurfaceWeights weights = project_weights(sheet, contacts);
  int inside = 0;
  for (Eigen::Index v = 0; v < sheet.vertices.cols(); ++v) {
    const Vector3d p = sheet.vertices.col(v);
    EXPECT_NEAR(weights.weights.col(v).sum(), 1, kLocatorRounding);
    if (p.x() < 16 || p.x() > 60 || p.y() < 16 || p.y() > 42) continue;
    ++inside;
    Vector3d reproduced = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      if (weights.contacts(k, v) < 0) continue;
      reproduced += weights.weights(k, v) * contacts.vertices.col(weights.contacts(k, v));
    }
    EXPECT_LT((reproduced - p).norm(), 1e-9);
  }
  EXPECT_GT(inside, 500);
}

}  // namespace
}  // namespace palpate::geometry
