// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/merge_models.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "cgal_availability.h"
#include "hump_model.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"
#include "palpate/haptics/rounding.h"
#include "sheet_model.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kOverlap = 10;  // [mm] on each side of the middle

// The frames of one side have nothing to do with those of the other.
Model above() {
  return ball_model([](const Vector3d& c) { return c.z() > -kOverlap; }, uneven_twist);
}
Model below() {
  return ball_model([](const Vector3d& c) { return c.z() < kOverlap; }, [](int) { return 0; });
}

// Two halves of the ball, the second measured in a frame of its own.
std::vector<SideModel> halves() {
  const Eigen::Isometry3d away = some_motion();
  return {{.model = above(), .name = "above"},
          {.model = moved(below(), away), .T_object_model = away.inverse(), .name = "below"}};
}

// Halves of a dome, which is a disc: frames can agree on all of it.
std::vector<SideModel> halves_of_a_dome() {
  const auto part = [](double side, double turn) {
    return ball_model(
        [side](const Vector3d& c) { return side * c.x() > -kOverlap && c.z() > -kOverlap; },
        [turn](int i) { return turn * i; });
  };
  return {{.model = part(1, 1.9)}, {.model = part(-1, -2.3)}};
}

// The part of a model that `covers` wants.
Model part_of(const Model& model, const std::function<bool(const Vector3d&)>& covers) {
  Model part = model;
  std::erase_if(part.contacts,
                [&](const ContactModel& contact) { return !covers(contact.position); });
  Eigen::Index kept = 0;
  for (const auto& t : model.surface.triangles.colwise()) {
    if (covers(model.surface.vertices(Eigen::all, t).rowwise().mean()))
      part.surface.triangles.col(kept++) = t;
  }
  part.surface.triangles.conservativeResize(3, kept);
  const geometry::SurfaceQuery query(part.surface);
  std::vector<geometry::SurfacePoint> places;
  for (const ContactModel& contact : part.contacts)
    places.push_back(query.closest_point(contact.position).at);
  geometry::ContactTriangulation found = geometry::triangulate_contacts(part.surface, places);
  part.triangles = std::move(found.mesh.triangles);
  part.surface_weights = std::move(found.weights);
  return part;
}

// [N] the largest change of the force between places that follow each other on the way from `from`
// over the top to `to`.
double largest_jump(const BlendedField& field, const Vector3d& from, const Vector3d& to,
                    int steps) {
  double largest = 0;
  Vector3d before = Vector3d::Zero();
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const Vector3d place = ((1 - t) * from + t * to + Vector3d(0, 0, 15)).normalized();
    const Vector3d now = field.force(Vector3d(kSphereRadius * place), kDisplacement);
    if (i > 0) largest = std::max(largest, (now - before).norm());
    before = now;
  }
  return largest;
}

TEST(MergeModels, GivesTheModelThatWasCutInHalves) {
  const MergedModel merged = merge_models(halves());
  EXPECT_NO_THROW(check_model(merged.model));
  EXPECT_TRUE(geometry::boundary_loops(merged.model.surface).empty());
  EXPECT_EQ(geometry::euler_characteristic(merged.model.surface), 2);
  ASSERT_EQ(merged.model.contacts.size(), 120u);
  EXPECT_GT(merged.left_out.size(), 20u);
  EXPECT_TRUE(merged.isolated.empty());
  EXPECT_EQ(merged.components, 1);
  const BlendedField field(merged.model);
  for (const ContactModel& contact : merged.model.contacts) {
    const Vector3d truth = ball_force(
        places_on_sphere(120)[static_cast<std::size_t>(contact.id % 1000)], kDisplacement);
    EXPECT_LT((field.force(contact.position, kDisplacement) - truth).norm(), kForceRounding);
    EXPECT_EQ(contact.field, rounded(contact.field));
  }
}

TEST(MergeModels, KnowsTheProbeIfAllSidesWereMeasuredWithIt) {
  std::vector<SideModel> sides = halves();
  for (SideModel& side : sides) side.model.probe_radius = 4;
  EXPECT_EQ(merge_models(sides).model.probe_radius, 4);
  sides[1].model.probe_radius = 5;
  EXPECT_FALSE(merge_models(sides).model.probe_radius);
}

TEST(MergeModels, InterpolatesAsWellAsOneModel) {
  const BlendedField whole(ball_model([](const Vector3d&) { return true; }));
  const BlendedField merged(merge_models(halves()).model);
  double error_of_whole = 0, error_of_merged = 0;
  for (const Vector3d& place : places_on_sphere(2000)) {
    const Vector3d truth = ball_force(place, kDisplacement);
    error_of_whole += (whole.force(place, kDisplacement) - truth).squaredNorm();
    error_of_merged += (merged.force(place, kDisplacement) - truth).squaredNorm();
  }
  EXPECT_LT(error_of_merged, error_of_whole);
  EXPECT_LT(std::sqrt(error_of_merged / 2000), 0.1);  // [N] of forces of about 4 N
}

TEST(MergeModels, BlendsCompliancesLikeOneModelIfItsSidesDo) {
  std::vector<SideModel> sides = halves();
  sides[0].model = with_compliances(std::move(sides[0].model), 2.5);
  sides[1].model = with_compliances(std::move(sides[1].model), 2);
  const Model merged = merge_models(sides).model;
  const Model whole = with_compliances(ball_model([](const Vector3d&) { return true; }), 2);
  EXPECT_EQ(merged.interpolation.rule, BlendRule::compliances);
  EXPECT_EQ(merged.interpolation.reference_force, 2);  // with which both were pressed
  EXPECT_NEAR(merged.interpolation.reach, whole.interpolation.reach, 0.1);
  const BlendedField field(merged), one(whole);
  double difference = 0;
  for (const Vector3d& place : places_on_sphere(2000)) {
    const Vector3d inward = -0.05 * place;
    difference += (field.force(place, inward) - one.force(place, inward)).squaredNorm() / 2000;
  }
  EXPECT_LT(std::sqrt(difference), 0.06);  // [N] of forces of about 2 N; frames differ
  sides[0].model.interpolation = sides[1].model.interpolation = {};
  const Model forces = merge_models(sides).model;
  EXPECT_EQ(forces.interpolation, Interpolation{});
  for (const ContactModel& contact : forces.contacts) EXPECT_FALSE(contact.compliance);
}

// Values that a side learnt without the contacts of the other do not stay.
TEST(MergeModels, BlendsForcesByTheStrengthsOfAllContacts) {
  const Model whole = hump_model(14);
  const Eigen::Isometry3d away = some_motion();
  const Model right = part_of(whole, [](const Vector3d& p) { return p.x() > -kOverlap; });
  const Model left = part_of(whole, [](const Vector3d& p) { return p.x() < kOverlap; });
  const Model merged =
      merge_models(std::vector<SideModel>{{.model = with_strengths(right, 7)},
                                          {.model = with_strengths(moved(left, away), 6),
                                           .T_object_model = away.inverse()}})
          .model;
  EXPECT_NO_THROW(check_model(merged));
  ASSERT_EQ(merged.contacts.size(), whole.contacts.size());
  EXPECT_EQ(merged.interpolation.rule, BlendRule::forces);
  EXPECT_EQ(merged.interpolation.reference_depth, 6);  // to which both were pressed
  expect_strengths_of_hump(merged);
}

TEST(MergeModels, KeepsHowForcesDependOnLoadAndRate) {
  std::vector<SideModel> sides = halves_of_a_dome();
  const double forces[] = {1.5, 0.6};
  for (std::size_t k = 0; k < 2; ++k) {
    sides[k].model.friction_force = forces[k];
    sides[k].model.rate = {{0.3, 0.1}};
    for (ContactModel& contact : sides[k].model.contacts) contact.load_exponent = -0.15;
  }
  const MergedModel merged = merge_models(sides);
  EXPECT_EQ(merged.model.rate, sides[0].model.rate);
  for (std::size_t i = 0; i < merged.model.contacts.size(); ++i) {
    const Model& side = sides[static_cast<std::size_t>(merged.source[i].side)].model;
    const auto from = std::ranges::find(side.contacts, merged.source[i].id, &ContactModel::id);
    const ContactModel& contact = merged.model.contacts[i];
    EXPECT_NEAR(
        friction_limit(contact.friction, contact.load_exponent, merged.model.friction_force, 2.0),
        friction_limit(from->friction, from->load_exponent, side.friction_force, 2.0), 1e-5);
  }
  sides[1].model.rate[0].share = 0.4;
  EXPECT_TRUE(merge_models(sides).model.rate.empty());
}

TEST(MergeModels, IsContinuousAcrossTheSeam) {
  const BlendedField field(merge_models(halves_of_a_dome()).model);
  for (int i = 0; i < 8; ++i) {
    const double y = 4.7 * i - 17;
    const Vector3d from(-25, y, 0), to(25, -y / 2, 0);
    const double coarse = largest_jump(field, from, to, 2000);
    const double fine = largest_jump(field, from, to, 8000);
    EXPECT_LT(fine, 0.4 * coarse) << y;  // a quarter, but a jump would stay
    EXPECT_GT(fine, 0);
  }
}

TEST(MergeModels, JumpsOnAClosedSurfaceOnlyWhereNoFramesCanAgree) {
  const BlendedField field(merge_models(halves()).model);
  int jumping = 0;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    const Vector3d side(30 * std::cos(angle), 30 * std::sin(angle), -15);
    const Vector3d from = side + Vector3d(0, 0, 30), to = side - Vector3d(0, 0, 30);
    const double coarse = largest_jump(field, from, to, 2000);
    if (largest_jump(field, from, to, 8000) > 0.4 * coarse) ++jumping;
  }
  EXPECT_LE(jumping, 2);
}

TEST(MergeModels, KeepsTheBetterOfTwoContactsAtOnePlace) {
  std::vector<SideModel> sides = halves();
  for (ContactModel& contact : sides[0].model.contacts) contact.rms = contact.id % 2 ? 0.02 : 0.005;
  const MergedModel merged = merge_models(sides);
  for (const LeftOutContact& out : merged.left_out) {
    EXPECT_EQ(out.contact.id, out.kept.id);  // the same contact of the other side
    EXPECT_EQ(out.kept.side, out.kept.id % 2 ? 1 : 0);
  }
  EXPECT_EQ(merged.source.size(), merged.model.contacts.size());
  sides = halves();
  EXPECT_EQ(merge_models(sides, {.same_place = 0}).model.contacts.size(), 120u);
  sides[1].T_object_model.pretranslate(Vector3d(0.5, 0, 0));
  EXPECT_EQ(merge_models(sides).model.contacts.size(), 120u);
  EXPECT_GT(merge_models(sides, {.same_place = 0.1}).model.contacts.size(), 120u);
}

TEST(MergeModels, MakesIdsUniqueAndSaysWhereTheyAreFrom) {
  const MergedModel merged = merge_models(halves());
  std::set<long long> ids;
  for (std::size_t i = 0; i < merged.source.size(); ++i) {
    const long long id = merged.model.contacts[i].id;
    EXPECT_TRUE(ids.insert(id).second);
    EXPECT_EQ(id, merged.source[i].id + 1000 * merged.source[i].side);
  }
  EXPECT_EQ(merged.model.made.at("model 1"), "below");
  EXPECT_EQ(merged.model.made.at("model 1 ids"), "those of the model plus 1000");
  EXPECT_THAT(merged.model.made.at("model 1 left out"), HasSubstr("of model 0"));
  std::vector<SideModel> sides = halves();
  for (ContactModel& contact : sides[1].model.contacts) contact.id += 500;
  EXPECT_EQ(merge_models(sides).model.made.at("model 1 ids"), "those of the model plus 0");
  sides = halves();
  sides[0].model.contacts[0].id = sides[1].model.contacts[0].id = 1LL << 60;
  EXPECT_THAT(refusal([&] { return merge_models(sides); }), HasSubstr("too large"));
  constexpr long long kFirst = std::numeric_limits<long long>::min();
  sides[0].model.contacts[0].id = sides[1].model.contacts[0].id = kFirst;
  sides[0].model.contacts[1].id = std::numeric_limits<long long>::max();
  EXPECT_THAT(refusal([&] { return merge_models(sides); }), HasSubstr("too large"));
}

TEST(MergeModels, BelongsToNoAcquisition) {
  std::vector<SideModel> sides = halves();
  for (SideModel& side : sides) {
    side.model.triangulation = geometry::ContactTriangulationMethod::voronoi_dual;
    side.model.samples_fingerprint = "0123456789abcdef";
    side.model.pressing_offsets.emplace();
  }
  const Model merged = merge_models(sides).model;
  EXPECT_EQ(merged.triangulation, geometry::ContactTriangulationMethod::delaunay);
  EXPECT_FALSE(merged.samples_fingerprint || merged.pressing_offsets);
}

TEST(MergeModels, MovesFramesAndAxesOfFriction) {
  const Model model = uneven_model();
  const Eigen::Isometry3d motion = some_motion();
  const MergedModel merged = merge_models(std::vector<SideModel>{{model, motion, {}}});
  const Model truth = moved(model, motion);
  ASSERT_EQ(merged.model.contacts.size(), truth.contacts.size());
  const BlendedField expected(truth), field(merged.model);
  for (std::size_t i = 0; i < truth.contacts.size(); ++i) {
    const ContactModel &is = merged.model.contacts[i], &should = truth.contacts[i];
    EXPECT_EQ(is.id, should.id);
    constexpr double kStored = 1e-6;  // the change by `rounded`, and some
    EXPECT_LT((is.position - should.position).norm(), kStored);
    EXPECT_LT((is.frame.col(2) - should.frame.col(2)).norm(), kStored);
    EXPECT_LT((is.friction_axis - should.friction_axis).norm(), kStored);
    EXPECT_NEAR(is.friction, should.friction, 1e-9);
    EXPECT_LT(
        (field.force(is.position, kDisplacement) - expected.force(should.position, kDisplacement))
            .norm(),
        kForceRounding);
  }
}

TEST(MergeModels, FillsHolesOnRequest) {
  if (!geometry::test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
  std::vector<SideModel> sides = halves();
  geometry::TriangleMesh& surface = sides[0].model.surface;
  const geometry::TriangleMesh before = surface;
  Eigen::Index kept = 0;
  for (const auto& t : before.triangles.colwise()) {
    const Vector3d middle = before.vertices(Eigen::all, t).rowwise().mean();
    if ((middle - Vector3d(0, 0, kSphereRadius)).norm() > 5) surface.triangles.col(kept++) = t;
  }
  surface.triangles.conservativeResize(3, kept);
  sides[0].model.surface_weights = {};  // were those of other triangles
  EXPECT_EQ(geometry::boundary_loops(merge_models(sides).model.surface).size(), 1u);
  const MergedModel filled = merge_models(sides, {.fill_holes = 30});
  EXPECT_EQ(filled.holes_filled, 1);
  EXPECT_TRUE(geometry::boundary_loops(filled.model.surface).empty());
}

TEST(MergeModels, AveragesOnRequest) {
  std::vector<SideModel> sides = halves();
  sides[1].T_object_model.pretranslate(Vector3d(0.31, 0.22, 0.27));
  const MergedModel averaged =
      merge_models(sides, {.surface = MergedSurface::averaged, .max_distance = 5});
  EXPECT_EQ(geometry::euler_characteristic(averaged.model.surface), 2);
  EXPECT_LT(averaged.largest_distance, 2.6);  // [mm] as far as vertices are apart
  EXPECT_EQ(averaged.model.made.at("surface"), "averaged");
}

TEST(MergeModels, SaysThatSidesDoNotOverlap) {
  std::vector<SideModel> sides = halves();
  sides[1].T_object_model.pretranslate(Vector3d(0, 0, -60));
  const MergedModel merged = merge_models(sides);
  EXPECT_EQ(merged.components, 2);
  EXPECT_TRUE(merged.left_out.empty());
}

TEST(MergeModels, RefusesWrongPosesModelsAndOptions) {
  EXPECT_THAT(refusal([] { return merge_models({}); }), HasSubstr("no model"));
  EXPECT_THAT(refusal([] { return merge_models(halves(), {.max_distance = -1}); }),
              HasSubstr("max_distance"));
  EXPECT_THAT(refusal([] {
                return merge_models(halves(),
                                    {.same_place = std::numeric_limits<double>::quiet_NaN()});
              }),
              HasSubstr("same_place"));
  std::vector<SideModel> sides = halves();
  sides[1].T_object_model.linear() *= 1.01;
  EXPECT_THAT(refusal([&] { return merge_models(sides); }),
              AllOf(HasSubstr("model 1 (below)"), HasSubstr("rotation")));
  sides = halves();
  sides[1].T_object_model.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([&] { return merge_models(sides); }), HasSubstr("finite"));
  sides = halves();
  sides[0].model.contacts[5].position.x() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal([&] { return merge_models(sides); }),
              AllOf(HasSubstr("model 0 (above)"), HasSubstr("not finite")));
  sides = halves();
  sides[0].model.contacts[3].position *= 1.2;  // above the surface
  EXPECT_THAT(refusal([&] { return merge_models(sides); }),
              AllOf(HasSubstr("contact 3"), HasSubstr("at most 2")));
}

}  // namespace
}  // namespace palpate::haptics
