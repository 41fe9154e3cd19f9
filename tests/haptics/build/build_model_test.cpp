// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/build_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>

#include "beam_acquisition.h"
#include "build/synthetic_acquisition.h"
#include "model_testing.h"
#include "palpate/haptics/blended_field.h"
#include "strip_acquisition.h"
#include "test_surfaces.h"

namespace palpate::haptics {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The samples below are exact.
const BuildOptions kQuick{
    .fit = {.mode = FitMode::local, .accuracy = 0.01, .max_bases = 2, .epsilon = 20},
    .friction = {.force_noise = 1e-4}};

// The undeformed surface of the strip's contacts.
geometry::TriangleMesh strip_sheet() {
  geometry::TriangleMesh mesh = geometry::test::flat_sheet(25, 35, 4);
  const Eigen::Vector3d middle = mesh.vertices.rowwise().mean();
  for (auto vertex : mesh.vertices.colwise()) {
    vertex = testing::strip_surface(vertex.x() - middle.x(), vertex.y() - middle.y());
  }
  return mesh;
}

Eigen::Vector3d spring_force(const Eigen::Vector3d& d) { return 9 * d / std::hypot(d.norm(), 20); }

TEST(BuildModel, LearnsTheSpringAndTheFrictionEverywhere) {
  const BuildResult result = build_model(flat_acquisition(0.6), flat_surface(), kQuick);
  EXPECT_EQ(result.registration, RegistrationOutcome::not_needed);
  EXPECT_TRUE(result.isolated.empty());
  EXPECT_FALSE(result.surface_flipped);
  ASSERT_EQ(result.model.contacts.size(), 9u);
  EXPECT_NO_THROW(check_model(result.model));
  for (const ContactModel& contact : result.model.contacts) {
    EXPECT_NEAR(contact.friction, 0.6, 1e-4);
    EXPECT_EQ(contact.friction_source, FrictionSource::samples);
    EXPECT_LT((contact.frame.col(2) - Eigen::Vector3d::UnitZ()).norm(), 1e-6);
    EXPECT_LE(contact.rms, 0.01);
    EXPECT_EQ(contact.samples, 3 * (1 + 16));
  }
  const BlendedField field(result.model);
  const Eigen::Vector3d displacement(1, -0.7, 4);
  EXPECT_LT((field.force({7, -13, 700}, displacement) - spring_force(displacement)).norm(), 0.02);
}

TEST(BuildModel, IsTheSameForAnyNumberOfThreads) {
  BuildResult results[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, i == 0 ? 1 : 4);
    results[i] = build_model(flat_acquisition(), flat_surface(), kQuick);
  }
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(results[0].model.contacts[i].field, results[1].model.contacts[i].field);
    EXPECT_EQ(results[0].model.contacts[i].frame, results[1].model.contacts[i].frame);
  }
}

TEST(BuildModel, ReportsProgressToTheEndOfEachStage) {
  BuildOptions options = kQuick;
  std::map<BuildStage, std::vector<int>> done;
  options.progress = [&](BuildStage stage, int now, int total) {
    EXPECT_EQ(total, 9);
    done[stage].push_back(now);
  };
  const BuildResult result = build_model(flat_acquisition(), flat_surface(), options);
  EXPECT_THAT(done[BuildStage::friction], ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_THAT(done[BuildStage::fields], ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
  // What was known is done when the stage begins.
  done.clear();
  options.known_fit = [&](long long contact) {
    return contact % 3 == 0 ? &result.contacts[0].fit : nullptr;
  };
  static_cast<void>(build_model(flat_acquisition(), flat_surface(), options));
  EXPECT_THAT(done[BuildStage::fields], ElementsAre(3, 4, 5, 6, 7, 8, 9));
}

TEST(BuildModel, TakesOverTheFitsThatAreKnown) {
  BuildOptions options = kQuick;
  std::map<long long, FitResult> kept;
  options.keep_fit = [&](long long contact, const FitResult& fit) { kept[contact] = fit; };
  const BuildResult whole = build_model(flat_acquisition(), flat_surface(), options);
  EXPECT_EQ(kept.size(), 9u);
  for (const long long contact : {20, 23, 27}) kept.erase(contact);
  kept[25].rms = 0.125;
  std::vector<long long> fitted;
  options.known_fit = [&](long long contact) {
    const auto found = kept.find(contact);
    return found == kept.end() ? nullptr : &found->second;
  };
  options.keep_fit = [&](long long contact, const FitResult&) { fitted.push_back(contact); };
  const BuildResult rest = build_model(flat_acquisition(), flat_surface(), options);
  EXPECT_THAT(fitted, ::testing::UnorderedElementsAre(20, 23, 27));
  for (std::size_t i = 0; i < 9; ++i) {
    const ContactModel &l = rest.model.contacts[i], &r = whole.model.contacts[i];
    EXPECT_EQ(l.field, r.field);
    EXPECT_EQ(l.rms, l.id == 25 ? 0.125 : r.rms);
    EXPECT_EQ(rest.contacts[i].fit.field, whole.contacts[i].fit.field);
  }
}

// A coarse search for the friction boundary is enough for dense contacts.
const testing::StripProbing kDenselyProbed{.directions = 6, .resolution = 0.4, .seed = 31};

TEST(BuildModel, SharesTheLocalPartOfDenselyProbedContacts) {
  const testing::Beam beam;
  const probing::Acquisition acquisition = testing::beam_acquisition(beam, 5, kDenselyProbed);
  const geometry::TriangleMesh surface = testing::beam_surface(beam);
  BuildOptions options;
  options.dense_samples = 40;
  std::map<long long, FitResult> kept;
  options.keep_fit = [&](long long contact, const FitResult& fit) { kept[contact] = fit; };
  const BuildResult built = build_model(acquisition, surface, options);
  ASSERT_TRUE(built.local_part);
  EXPECT_EQ(built.local_part->outcome, SharingOutcome::shared);
  EXPECT_EQ(built.local_part->dense, 6);
  EXPECT_NO_THROW(check_model(built.model));
  const std::vector<Eigen::Vector2d> places = testing::beam_places(beam);
  std::vector<double> errors;
  int sharing = 0;  // noise may make one keep its own fit
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ContactModel& contact = built.model.contacts[i];
    EXPECT_FALSE(contact.shared_local && i % 5 == 1) << i;
    sharing += contact.shared_local ? 1 : 0;
    EXPECT_EQ(contact.passivity, Passivity::convex);
    double sum = 0;
    const auto truths = testing::strip_truths(beam, {places[i]}, 50);
    for (const auto& truth : truths) {
      sum += (contact.frame * force(contact.field, contact.frame.transpose() * truth.displacement) -
              truth.force)
                 .squaredNorm();
    }
    errors.push_back(std::sqrt(sum / static_cast<double>(truths.size())));
  }
  EXPECT_GE(sharing, 22);
  std::ranges::sort(errors);
  EXPECT_LT(errors[errors.size() / 2], 0.06);

  // Taken over, they are as they were kept.
  options.known_fit = [&](long long contact) { return &kept.at(contact); };
  options.keep_fit = {};
  const BuildResult again = build_model(acquisition, surface, options);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(again.model.contacts[i].field, built.model.contacts[i].field);
    EXPECT_EQ(again.model.contacts[i].shared_local, built.model.contacts[i].shared_local);
  }
}

TEST(BuildModel, RegistersAnAcquisitionThatIsOffTheSurface) {
  const Eigen::Vector3d offset(0, 0, 1.5);
  probing::Acquisition acquisition = flat_acquisition();
  for (probing::Contact& contact : acquisition.contacts) contact.position += offset;
  for (probing::Sample& sample : acquisition.samples) {
    sample.a += offset;
    sample.b += offset;
  }
  const BuildResult result = build_model(acquisition, flat_surface(), kQuick);
  EXPECT_EQ(result.registration, RegistrationOutcome::accepted);
  EXPECT_NEAR(result.distance_rms, 1.5, 1e-9);
  // The iterations end at the rounding of single precision.
  EXPECT_LT((result.model.T_surface_acquisition.translation() + offset).norm(), 1e-2);
  EXPECT_LT((result.model.contacts[0].position - Eigen::Vector3d(-30, -30, 700)).norm(), 1e-2);
  const Eigen::Vector3d displacement(1, -0.7, 4);
  EXPECT_LT(
      (BlendedField(result.model).force({7, -13, 700}, displacement) - spring_force(displacement))
          .norm(),
      0.1);
}

// The sheet above a block, as stiff and as noisy as what is measured.
TEST(BuildModel, MakesModelsOfLessThanAKilobyteAndAHalfAContact) {
  const probing::Acquisition acquisition =
      testing::strip_acquisition({.block = 1.5}, {.spacing_x = 28});
  const Model model = build_model(acquisition, strip_sheet()).model;
  ASSERT_EQ(model.contacts.size(), 25u);
  std::size_t bases = 0;
  for (const ContactModel& contact : model.contacts) bases += contact.field.bases.size();
  EXPECT_GE(bases, 5 * model.contacts.size());
  EXPECT_LT(field_document(model, ModelEncoding::json).size(), 1500 * model.contacts.size());
}

TEST(BuildModel, RefusesAContactOffTheSurface) {
  probing::Acquisition acquisition = flat_acquisition();
  acquisition.contacts[4].position.z() -= 3;
  EXPECT_THAT(
      refusal([&] { return build_model(acquisition, flat_surface(), kQuick); }),
      AllOf(HasSubstr("contact 24"), HasSubstr("from the surface"), HasSubstr("at most 2")));
  acquisition = flat_acquisition();
  for (probing::Contact& contact : acquisition.contacts) contact.position.z() += 10;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), kQuick); }),
              HasSubstr("too_far"));
}

TEST(BuildModel, TurnsTheSurfaceOverIfItIsSeenFromInside) {
  geometry::TriangleMesh surface = flat_surface();
  surface.triangles.row(0).swap(surface.triangles.row(1));
  const BuildResult result = build_model(flat_acquisition(), surface, kQuick);
  EXPECT_TRUE(result.surface_flipped);
  EXPECT_LT(geometry::triangle_normals(result.model.surface)(2, 0), 0);
  EXPECT_LT(geometry::triangle_normals(contact_mesh(result.model)).row(2).maxCoeff(), 0);
  probing::Acquisition acquisition = flat_acquisition();
  acquisition.contacts[3].normal *= -1;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), kQuick); }),
              HasSubstr("contact 23"));
}

TEST(BuildModel, LeavesOutContactsWithoutSamplesAndBorrowsFriction) {
  probing::Acquisition acquisition = flat_acquisition(0.6);
  std::erase_if(acquisition.samples, [](const probing::Sample& s) { return s.contact == 24; });
  std::erase_if(acquisition.samples, [](const auto& s) { return s.contact == 20 && s.slipped; });
  const BuildResult result = build_model(acquisition, flat_surface(), kQuick);
  EXPECT_THAT(result.without_samples, ElementsAre(24));
  EXPECT_EQ(result.model.contacts.size(), 8u);
  EXPECT_EQ(result.model.contacts[0].friction_source, FrictionSource::other_contacts);
  EXPECT_NEAR(result.model.contacts[0].friction, 0.6, 1e-4);
  EXPECT_EQ(result.contacts[0].friction.stop, FrictionStop::never_slipped);
  // Forces held up to 0.99 of the limit.
  EXPECT_NEAR(result.model.contacts[0].friction_lower_bound, 0.594, 1e-3);
  EXPECT_EQ(result.model.contacts[1].friction_source, FrictionSource::samples);
  acquisition.samples.clear();
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), kQuick); }),
              HasSubstr("at least three"));
}

TEST(BuildModel, TakesTheLowerBoundOfFrictionWhereNothingSlipped) {
  probing::Acquisition acquisition = flat_acquisition(0.6);
  std::erase_if(acquisition.samples, [](const probing::Sample& s) { return s.slipped; });
  for (const ContactModel& contact :
       build_model(acquisition, flat_surface(), kQuick).model.contacts) {
    EXPECT_EQ(contact.friction_source, FrictionSource::lower_bound);
    EXPECT_FALSE(contact.friction_error);
    EXPECT_EQ(contact.friction, contact.friction_lower_bound);
    EXPECT_NEAR(contact.friction, 0.6, 0.02);
  }
}

TEST(BuildModel, TakesTheLowerBoundOfFrictionAboveThatOfOtherContacts) {
  probing::Acquisition acquisition = flat_acquisition(0.6);
  std::erase_if(acquisition.samples, [](const probing::Sample& s) { return s.contact == 20; });
  for (const probing::Sample& sample : flat_acquisition(0.9).samples) {
    if (sample.contact == 20 && !sample.slipped) acquisition.samples.push_back(sample);
  }
  const Model model = build_model(acquisition, flat_surface(), kQuick).model;
  EXPECT_EQ(model.contacts[0].friction_source, FrictionSource::lower_bound);
  EXPECT_FALSE(model.contacts[0].friction_error);
  EXPECT_NEAR(model.contacts[0].friction, 0.891, 2e-3);  // forces held up to 0.99 of the limit
  EXPECT_EQ(model.contacts[1].friction_source, FrictionSource::samples);
  EXPECT_NEAR(model.contacts[1].friction, 0.6, 1e-4);
}

TEST(BuildModel, RefusesBadOptionsAndAcquisitions) {
  BuildOptions options = kQuick;
  options.max_distance = -1;
  EXPECT_THAT(refusal([&] { return build_model(flat_acquisition(), flat_surface(), options); }),
              HasSubstr("max_distance"));
  options = kQuick;
  options.dense_samples = 5;
  EXPECT_THAT(refusal([&] { return build_model(flat_acquisition(), flat_surface(), options); }),
              HasSubstr("dense_samples is 5; it must be >= 12"));
  probing::Acquisition acquisition = flat_acquisition();
  acquisition.contacts[1].position = acquisition.contacts[0].position;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), kQuick); }),
              HasSubstr("at one place"));
}

}  // namespace
}  // namespace palpate::haptics
