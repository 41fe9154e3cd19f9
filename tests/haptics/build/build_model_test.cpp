// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/build_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>

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
using ::testing::Not;

// The samples below are exact.
const BuildOptions kQuick{
    .fit = {.mode = FitMode::local, .accuracy = 0.01, .max_bases = 2, .epsilon = 20},
    .friction = {.steady_error = 0},
    .force_noise = 1e-4};

// The undeformed surface of the strip's contacts.
geometry::TriangleMesh strip_sheet() {
  geometry::TriangleMesh mesh = geometry::test::flat_sheet(25, 35, 4);
  const Eigen::Vector3d middle = mesh.vertices.rowwise().mean();
  for (auto vertex : mesh.vertices.colwise()) {
    vertex = support::strip_surface(vertex.x() - middle.x(), vertex.y() - middle.y());
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

TEST(BuildModel, TakesTheNoiseThatItFindsForFrictionToo) {
  probing::Acquisition acquisition = flat_acquisition();
  std::erase_if(acquisition.contacts, [](const auto& contact) { return contact.id > 23; });
  std::erase_if(acquisition.samples, [](const auto& sample) { return sample.contact > 23; });
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.08);
  for (probing::Sample& sample : acquisition.samples)
    sample.force += Eigen::Vector3d{noise(random), noise(random), noise(random)};
  const BuildResult found = build_model(acquisition, flat_surface());
  ASSERT_TRUE(found.model.noise);
  const double force_noise = found.model.noise->force;
  EXPECT_NEAR(force_noise, 0.08, 0.03);
  BuildOptions told;
  told.force_noise = force_noise;
  told.friction = {.force_noise = force_noise, .steady_error = 1.5 * force_noise};
  const BuildResult expected = build_model(acquisition, flat_surface(), told);
  for (std::size_t i = 0; i < found.contacts.size(); ++i) {
    EXPECT_NEAR(found.contacts[i].friction.coefficient, expected.contacts[i].friction.coefficient,
                1e-9);
    EXPECT_NEAR(found.contacts[i].friction.lower_bound, expected.contacts[i].friction.lower_bound,
                1e-9);
  }
}

TEST(BuildModel, LearnsSmallForcesAsItDoesLargeOnes) {
  probing::Acquisition acquisition = flat_acquisition();
  std::erase_if(acquisition.contacts, [](const auto& contact) { return contact.id > 23; });
  std::erase_if(acquisition.samples, [](const auto& sample) { return sample.contact > 23; });
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.02);
  for (probing::Sample& sample : acquisition.samples)
    sample.force += Eigen::Vector3d{noise(random), noise(random), noise(random)};
  const BuildResult large = build_model(acquisition, flat_surface());
  constexpr double kFactor = 1e-3;
  for (probing::Sample& sample : acquisition.samples) sample.force *= kFactor;
  const BuildResult small = build_model(acquisition, flat_surface());
  EXPECT_NEAR(small.model.noise->force / (kFactor * large.model.noise->force), 1, 0.01);
  const Eigen::Vector3d displacement(1, -0.7, 4);
  for (std::size_t i = 0; i < large.contacts.size(); ++i) {
    const ContactModel &is = small.model.contacts[i], &was = large.model.contacts[i];
    const Eigen::Vector3d expected = kFactor * force(was.field, displacement);
    EXPECT_LT((force(is.field, displacement) - expected).norm(), 1e-3 * expected.norm());
    EXPECT_EQ(is.friction_source, FrictionSource::samples);
    EXPECT_NEAR(is.friction, was.friction, 1e-3);
    EXPECT_NEAR(is.friction_lower_bound, was.friction_lower_bound, 1e-3);
    EXPECT_EQ(is.fit_stop, was.fit_stop);
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
  // Contacts with a known fit are done when the stage begins.
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
const support::StripProbing kDenselyProbed{.directions = 6, .resolution = 0.4, .seed = 31};

TEST(BuildModel, SharesTheLocalPartOfDenselyProbedContacts) {
  const support::Beam beam;
  const probing::Acquisition acquisition = support::beam_acquisition(beam, 5, kDenselyProbed);
  const geometry::TriangleMesh surface = support::beam_surface(beam);
  BuildOptions options;
  options.dense_samples = 40;
  std::map<long long, FitResult> kept;
  options.keep_fit = [&](long long contact, const FitResult& fit) { kept[contact] = fit; };
  const BuildResult built = build_model(acquisition, surface, options);
  ASSERT_TRUE(built.local_part);
  EXPECT_EQ(built.local_part->outcome, SharingOutcome::shared);
  EXPECT_EQ(built.local_part->dense, 6);
  EXPECT_NO_THROW(check_model(built.model));
  const std::vector<Eigen::Vector2d> places = support::beam_places(beam);
  std::vector<double> errors;
  int sharing = 0;  // noise may make one keep its own fit
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ContactModel& contact = built.model.contacts[i];
    EXPECT_FALSE(contact.shared_local && i % 5 == 1) << i;
    sharing += contact.shared_local ? 1 : 0;
    EXPECT_EQ(contact.passivity, Passivity::convex);
    double sum = 0;
    const auto truths = support::strip_truths(beam, {places[i]}, 50);
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
      support::strip_acquisition({.block = 1.5}, {.spacing_x = 28});
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
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), kQuick); }),
              AllOf(HasSubstr("contact 24 is "), HasSubstr(" mm from the surface"),
                    HasSubstr("at most 2 mm")));
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

TEST(BuildModel, LeavesOutAsManyContactsThatDoNotFitTheSurfaceAsAllowed) {
  probing::Acquisition acquisition = flat_acquisition();
  acquisition.contacts[3].normal *= -1;
  acquisition.contacts[7].position.z() -= 400;
  BuildOptions options = kQuick;
  options.max_left_out = 1;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), options); }),
              AllOf(HasSubstr("2 contacts do not fit"), HasSubstr("contact 23 has a normal"),
                    HasSubstr("BuildOptions::max_left_out of 2")));
  // Nothing is left of contacts in another unit than the surface.
  probing::Acquisition metres = flat_acquisition();
  for (probing::Contact& contact : metres.contacts) contact.position /= 1000;
  EXPECT_THAT(refusal([&] { return build_model(metres, flat_surface(), kQuick); }),
              AllOf(HasSubstr("check the units of both"), Not(HasSubstr("max_left_out"))));
  options.max_left_out = 2;
  const BuildResult result = build_model(acquisition, flat_surface(), options);
  ASSERT_EQ(result.left_out.size(), 2u);
  EXPECT_EQ(result.left_out[0].id, 23);
  EXPECT_THAT(result.left_out[0].reason, HasSubstr("points into the surface"));
  EXPECT_EQ(result.left_out[1].id, 27);
  EXPECT_THAT(result.left_out[1].reason, HasSubstr("is 400 mm from"));

  // The others are as without them.
  probing::Acquisition others = flat_acquisition();
  const auto is_out = [](long long id) { return id == 23 || id == 27; };
  std::erase_if(others.contacts, [&](const auto& contact) { return is_out(contact.id); });
  std::erase_if(others.samples, [&](const auto& sample) { return is_out(sample.contact); });
  const BuildResult expected = build_model(others, flat_surface(), kQuick);
  ASSERT_EQ(result.model.contacts.size(), 7u);
  EXPECT_EQ(result.model.triangles, expected.model.triangles);
  EXPECT_EQ(result.registration, RegistrationOutcome::not_needed);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(result.model.contacts[i].id, expected.model.contacts[i].id);
    EXPECT_EQ(result.model.contacts[i].field, expected.model.contacts[i].field);
    EXPECT_EQ(result.model.contacts[i].friction, expected.model.contacts[i].friction);
  }
  std::erase_if(acquisition.contacts, [](const auto& contact) { return contact.id > 23; });
  std::erase_if(acquisition.samples, [](const auto& sample) { return sample.contact > 22; });
  acquisition.contacts[0].normal *= -1;
  acquisition.contacts[3].normal *= -1;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), options); }),
              HasSubstr("only 2 contacts fit the surface"));
}

TEST(BuildModel, AcceptsAContactOnASingleTriangleThatIsFolded) {
  geometry::TriangleMesh surface = flat_surface();
  probing::Acquisition acquisition = flat_acquisition();
  probing::Contact& contact = acquisition.contacts[4];
  const auto middle_of = [&](Eigen::Index t) -> Eigen::Vector3d {
    return (surface.vertices.col(surface.triangles(0, t)) +
            surface.vertices.col(surface.triangles(1, t)) +
            surface.vertices.col(surface.triangles(2, t))) /
           3;
  };
  Eigen::Index folded = 0;
  for (Eigen::Index t = 1; t < surface.triangles.cols(); ++t) {
    if ((middle_of(t) - contact.position).norm() < (middle_of(folded) - contact.position).norm())
      folded = t;
  }
  // One corner is pulled over the edge between the others, and 1 mm off the plane.
  const Eigen::Vector3i corners = surface.triangles.col(folded);
  const Eigen::Vector3d edge =
      (surface.vertices.col(corners[0]) + surface.vertices.col(corners[1])) / 2;
  surface.vertices.col(corners[2]) += 1.5 * (edge - surface.vertices.col(corners[2]));
  surface.vertices(2, corners[2]) -= 1;
  ASSERT_LT(geometry::triangle_normals(surface)(2, folded) *
                geometry::triangle_normals(flat_surface())(2, folded),
            0);
  const Eigen::Vector3d shift = middle_of(folded) - contact.position;
  contact.position += shift;
  for (probing::Sample& sample : acquisition.samples) {
    if (sample.contact != contact.id) continue;
    sample.a += shift;
    sample.b += shift;
  }
  EXPECT_EQ(build_model(acquisition, surface, kQuick).model.contacts.size(), 9u);
}

TEST(BuildModel, TellsFitsThatCannotBeUsedAndTheShareThatIsExplained) {
  const BuildResult built = build_model(flat_acquisition(), flat_surface(), kQuick);
  double largest = 0, squares = 0;
  for (const ContactReport& contact : built.contacts) {
    EXPECT_TRUE(is_usable(contact));
    // The largest force is that of 3 N with 0.99 of the limit across.
    EXPECT_NEAR(contact.largest_force, 3 * std::hypot(1, 0.99 * 0.5), 1e-9);
    largest = std::max(largest, contact.fit.rms);
    squares += contact.fit.rms * contact.fit.rms / (contact.force_rms * contact.force_rms) / 9;
  }
  EXPECT_NEAR(explained_share(built.contacts), 1 - squares, 1e-12);
  EXPECT_LT(largest, 0.01);
  ContactReport contact = built.contacts[0];
  contact.fit.rms = contact.largest_force;
  EXPECT_TRUE(is_usable(contact));
  contact.fit.rms = 1.01 * contact.largest_force;
  EXPECT_FALSE(is_usable(contact));
  contact.fit.rms = std::nan("");
  EXPECT_FALSE(is_usable(contact));
  EXPECT_EQ(explained_share({}), 0);
}

TEST(BuildModel, FailsIfTheErrorsOfAFitExceedItsForces) {
  BuildOptions options = kQuick;
  FitResult wild = build_model(flat_acquisition(), flat_surface(), kQuick).contacts[3].fit;
  for (const double rms : {3.4, std::numeric_limits<double>::infinity(), std::nan("")}) {
    wild.rms = rms;
    options.known_fit = [&](long long contact) { return contact == 23 ? &wild : nullptr; };
    try {
      static_cast<void>(build_model(flat_acquisition(), flat_surface(), options));
      ADD_FAILURE() << rms;
    } catch (const SolverError& error) {
      EXPECT_THAT(error.what(),
                  AllOf(HasSubstr("1 of 9 contacts"), HasSubstr("Contacts: 23. Check")));
    }
  }
}

TEST(BuildModel, CountsSamplesThatContradictTheFriction) {
  probing::Acquisition acquisition = flat_acquisition(0.6);
  for (const ContactReport& contact : build_model(acquisition, flat_surface(), kQuick).contacts) {
    EXPECT_EQ(contact.friction_contradictions, 0);
    EXPECT_EQ(contact.friction_trials, 72);
  }
  // Half of the force at which the others slip.
  for (probing::Sample& sample : acquisition.samples) {
    if (sample.contact == 20 && sample.id % 24 == 0) sample.slipped = true;
  }
  const BuildResult built = build_model(acquisition, flat_surface(), kQuick);
  EXPECT_EQ(built.contacts[0].friction_contradictions, 3);
  EXPECT_EQ(built.contacts[1].friction_contradictions, 0);
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
  options.max_left_out = -1;
  EXPECT_THAT(refusal([&] { return build_model(flat_acquisition(), flat_surface(), options); }),
              HasSubstr("max_left_out is -1; it must be >= 0"));
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
