// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "strip_acquisition.h"
#include "repository.h"

#include <gtest/gtest.h>

#include <string>

#include "palpate/haptics/evaluate.h"

namespace palpate::support {
namespace {

constexpr double kRounding = 2e-4;  // [mm] six digits of displacements up to 24 mm and their forces

double worst_query(const Strip& strip, const std::string& folder) {
  double worst = 0;
  for (const haptics::Query& query :
       haptics::read_queries(repository("demo/").string() + folder + "/queries.csv")) {
    const double x = query.contact.x(), y = query.contact.y();
    const Eigen::Matrix3d frame = strip_frame(x, y);
    const Eigen::Vector3d displacement =
        frame.transpose() * strip_displacement(strip, x, y, frame * query.force);
    worst = std::max(worst, (displacement - query.displacement).norm());
  }
  return worst;
}

TEST(StripAcquisition, IsOfTheSameSheetAsTheBundledData) {
  EXPECT_LT(worst_query({}, "sheet"), kRounding);
}

TEST(StripAcquisition, HasTheBlockOfTheBundledData) {
  EXPECT_LT(worst_query({.block = 1.5}, "sheet_block"), kRounding);
  EXPECT_GT(worst_query({}, "sheet_block"), 1);
}

TEST(StripAcquisition, ScattersAsStated) {
  const StripProbing noisy{.normal_forces = {1.1}};
  StripProbing exact = noisy;
  exact.position_noise = exact.location_noise = exact.force_noise = 0;
  const probing::Acquisition measured = strip_contact(42, 60, {}, noisy);
  const probing::Acquisition truth = strip_contact(42, 60, {}, exact);
  double squares = 0;
  for (std::size_t i = 0; i < measured.samples.size(); ++i) {
    squares += (measured.samples[i].a - truth.samples[i].a).squaredNorm();
  }
  // Three components of position noise, two of location; near the support forces hardly matter.
  const double expected = std::sqrt(5 * 0.02 * 0.02);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(measured.samples.size())), expected,
              0.4 * expected);
}

}  // namespace
}  // namespace palpate::support
