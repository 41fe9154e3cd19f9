// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "build/synthetic_acquisition.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/scale_model.h"
#include "palpate/probing/fingerprint.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

TEST(EvaluateQueries, ReadsThemFromATable) {
  const ScratchFolder folder;
  write_text(folder / "q.csv", "cx,cy,cz,dx,dy,dz,fx,fy,fz\n1,2,3,4,5,6,7,8,9");
  const std::vector<Query> queries = read_queries(folder / "q.csv");
  ASSERT_EQ(queries.size(), 1u);
  EXPECT_EQ(queries[0].contact, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(queries[0].displacement, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(queries[0].force, Eigen::Vector3d(7, 8, 9));
  write_text(folder / "q.csv", "cx,cy,cz,dx,dy,dz,fx,fy,fz\n");
  EXPECT_THAT(refusal([&] { return read_queries(folder / "q.csv"); }), HasSubstr("q.csv"));
}

TEST(EvaluateQueries, TellsForcesOfOtherSignsAndUnits) {
  const Model model = sheet_model();
  const BlendedField field(model);
  for (const double scale : {1.0, -1.0, 1000.0}) {
    std::vector<Query> queries;
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3d contact(i, 2, 700), displacement(0.1 * i, 0, 3);
      queries.push_back({contact, displacement, scale * field.force(contact, displacement)});
    }
    const QueryErrors errors = evaluate_queries(model, queries);
    EXPECT_NEAR(errors.scale.value(), scale, 1e-12 * std::abs(scale));
    EXPECT_NEAR(errors.explained_if_scaled.value(), 1, 1e-12);
    EXPECT_NEAR(errors.explained.value(), 1 - std::pow(1 - 1 / scale, 2), 1e-12);
    for (Query& query : queries) query.force.setZero();
    EXPECT_FALSE(evaluate_queries(model, queries).explained);
    for (Query& query : queries) query = {query.contact, Eigen::Vector3d::Zero(), {0, 0, 1}};
    EXPECT_FALSE(evaluate_queries(model, queries).scale);
  }
}

TEST(EvaluateQueries, SumsUpTheLengthsOfTheErrors) {
  const Model model = sheet_model();
  std::vector<Query> queries;
  double known = 0;  // squared forces
  for (int i = 1; i <= 10; ++i) {
    const Eigen::Vector3d displacement(0.1 * i, 0, 3);
    const Eigen::Vector3d truth = 4 * displacement / std::hypot(displacement.norm(), 10);
    queries.push_back(
        {{1.0 * i, 2, 700}, displacement, truth + Eigen::Vector3d(0, 0.6 * i, -0.8 * i)});
    known += queries.back().force.squaredNorm();
  }
  const QueryErrors errors = evaluate_queries(model, queries);  // 1, 2, ..., 10
  EXPECT_EQ(errors.count, 10);
  EXPECT_NEAR(errors.rms, std::sqrt(38.5), 1e-9);
  EXPECT_NEAR(errors.median, 5.5, 1e-9);
  EXPECT_NEAR(errors.p90, 9.1, 1e-9);
  EXPECT_NEAR(errors.explained.value(), 1 - 385 / known, 1e-9);
  EXPECT_THAT(refusal([&] { return evaluate_queries(model, {}); }), HasSubstr("no query"));
  queries[3].force.y() = std::nan("");
  EXPECT_THAT(refusal([&] { return evaluate_queries(model, queries); }),
              HasSubstr("query 4 of 10"));
}

TEST(LeaveOneOut, PredictsAnObjectThatIsTheSameEverywhere) {
  const probing::Acquisition acquisition = flat_acquisition();
  const Model model =
      build_model(acquisition, flat_surface(), {.fit = {.accuracy = 0.01, .max_bases = 2}}).model;
  const LeaveOneOut errors = leave_one_out(model, acquisition);
  ASSERT_EQ(errors.per_contact.size(), 9u);
  EXPECT_EQ(errors.per_contact[3].contact, 23);
  EXPECT_EQ(errors.per_contact[3].samples, 51);
  for (const ContactError& error : errors.per_contact) EXPECT_LT(error.rms, 0.1);
  EXPECT_GT(errors.rms, 0);
}

TEST(LeaveOneOut, DoesNotUseTheContactItPredicts) {
  const probing::Acquisition acquisition = flat_acquisition();
  Model model =
      build_model(acquisition, flat_surface(),
                  {.fit = {.accuracy = 0.01, .max_bases = 2}, .blend_rule = BlendRule::forces})
          .model;
  const LeaveOneOut before = leave_one_out(model, acquisition);
  model.contacts[1].field = scaled(model.contacts[1].field, 100);
  const LeaveOneOut after = leave_one_out(model, acquisition);
  EXPECT_EQ(after.per_contact[1].rms, before.per_contact[1].rms);
  EXPECT_GT(after.rms, 2 * before.rms);
  EXPECT_GE(before.per_contact[4].expected.value(), 0);
}

TEST(LeaveOneOut, TellsTheBorderFromTheInteriorAndWhereToProbeMore) {
  const probing::Acquisition acquisition = flat_acquisition();
  Model model =
      build_model(acquisition, flat_surface(50, 20), {.fit = {.accuracy = 0.01, .max_bases = 2}})
          .model;
  int done = 0;
  const LeaveOneOut errors =
      leave_one_out(model, acquisition, {.suggestions = 3, .progress = [&](int, int total) {
                                           ++done;
                                           EXPECT_EQ(total, 9);
                                         }});
  EXPECT_EQ(done, 9);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(errors.per_contact[i].at_border, i != 4);
  EXPECT_EQ(errors.interior_rms, errors.per_contact[4].rms);
  EXPECT_GT(errors.border_rms, 0);
  EXPECT_GE(errors.per_contact[4].expected.value(), 0);
  ASSERT_EQ(errors.suggested.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    // Contacts are 30 mm apart, on a square of 60 mm; the surface goes on for another 20 mm.
    const Eigen::Array2d place = errors.suggested[i].position.head<2>();
    EXPECT_LE((place.abs() - 30).max(0).matrix().norm(), 15);
    for (const ContactModel& contact : model.contacts) {
      EXPECT_GE((contact.position - errors.suggested[i].position).norm(), 15);
    }
    if (i == 0) continue;
    EXPECT_LE(errors.suggested[i].expected, errors.suggested[i - 1].expected);
  }
}

TEST(EvaluateQueries, RefusesAPlaceOffTheSurface) {
  const Model model = sheet_model();
  std::vector<Query> queries(2, {{1, 2, 700}, {0, 0, 1}, {0, 0, 1}});
  queries[1].contact.z() = 697;
  EXPECT_THAT(refusal([&] { return evaluate_queries(model, queries); }),
              HasSubstr("query 2 of 2 is 3"));
  EXPECT_EQ(evaluate_queries(model, queries, {.max_distance = 4}).count, 2);
  EXPECT_THAT(refusal([&] { return evaluate_queries(model, queries, {.max_distance = -1}); }),
              HasSubstr("max_distance"));
}

TEST(LeaveOneOut, RefusesOtherSamplesOfTheSameContacts) {
  probing::Acquisition acquisition = flat_acquisition();
  Model model =
      build_model(acquisition, flat_surface(), {.fit = {.accuracy = 0.01, .max_bases = 2}}).model;
  std::reverse(acquisition.samples.begin(), acquisition.samples.end());
  EXPECT_NO_THROW(static_cast<void>(leave_one_out(model, acquisition)));
  acquisition.samples[5].b.z() += 1e-6;
  EXPECT_THAT(refusal([&] { return leave_one_out(model, acquisition); }),
              HasSubstr("other samples"));
  model.samples_fingerprint.reset();
  EXPECT_THAT(refusal([&] { return leave_one_out(model, acquisition); }),
              HasSubstr("which samples it was fitted to"));
}

// Stretched across itself, a flat object keeps its contacts where they were.
TEST(LeaveOneOut, RefusesAModelThatWasScaled) {
  const probing::Acquisition acquisition = flat_acquisition();
  const Model model =
      build_model(acquisition, flat_surface(), {.fit = {.accuracy = 0.01, .max_bases = 2}}).model;
  const Model scaled = scale_model(model, {.factor = 2, .axis = Eigen::Vector3d::UnitZ()}).model;
  for (std::size_t i = 0; i < model.contacts.size(); ++i)
    ASSERT_EQ(scaled.contacts[i].position, model.contacts[i].position);
  EXPECT_THAT(refusal([&] { return leave_one_out(scaled, acquisition); }), HasSubstr("scaled"));
}

TEST(LeaveOneOut, RefusesAnotherAcquisitionAndTooFewContacts) {
  Model model = sheet_model();
  model.samples_fingerprint = probing::fingerprint(flat_acquisition());
  EXPECT_THAT(refusal([&] { return leave_one_out(model, flat_acquisition()); }),
              HasSubstr("contact 1"));
  for (std::size_t i = 0; i < 4; ++i) model.contacts[i].id = 20 + static_cast<long long>(i);
  EXPECT_THAT(refusal([&] { return leave_one_out(model, flat_acquisition()); }),
              HasSubstr("mm along the surface"));
  model.contacts.pop_back();
  model.triangles.conservativeResize(3, 1);
  EXPECT_THAT(refusal([&] { return leave_one_out(model, flat_acquisition()); }),
              HasSubstr("at least four"));
}

}  // namespace
}  // namespace palpate::haptics
