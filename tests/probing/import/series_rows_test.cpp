// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/series_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "import/import_testing.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using SeriesRowsTest = ImportTest;

/// A recording of two presses at 100 Hz: at x = 0 onto 0.5 N/mm and at x = 20 onto 1 N/mm, each
/// 3 mm deep along -z, held for a second, with a bias of the sensor and a reading every 10 ms.
std::string recording(double bias) {
  std::string text = "t,X,Z,Fx,Fz\n";
  double time = 0;
  const auto add = [&](double x, double z) {
    const double stiffness = x < 10 ? 0.5 : 1;
    text += std::to_string(time) + ',' + std::to_string(x) + ',' + std::to_string(z) + ',' +
            std::to_string(bias) + ',' + std::to_string(2 * bias + stiffness * std::max(-z, 0.0)) +
            '\n';
    time += 0.01;
  };
  for (const double x : {0.0, 20.0}) {
    for (int i = 0; i < 100; ++i) add(x, 2);
    for (int i = 0; i < 100; ++i) add(x, 2 - 0.05 * i);
    for (int i = 0; i < 100; ++i) add(x, -3);
    for (int i = 0; i < 100; ++i) add(x, -3 + 0.05 * i);
  }
  return text;
}

TEST_F(SeriesRowsTest, FindsThePressesOfARecording) {
  write_text(folder / "r.csv", recording(0.4));
  AcquisitionMapping mapping{.columns = {{"time", "t"},
                                         {"ax", "X"},
                                         {"ay", "0"},
                                         {"az", "Z"},
                                         {"px", "Fx"},
                                         {"py", "0"},
                                         {"pz", "Fz"}},
                             .forces_on_tool = true,
                             .content = RowContent::time_series,
                             .contacts = ContactSource::place,
                             .normals_from_forces = true};
  const std::vector<std::filesystem::path> files = {folder / "r.csv"};
  const ImportedAcquisition found = import_acquisition(files, mapping);
  EXPECT_EQ(found.series.presses, 2u);
  EXPECT_EQ(found.series.slides, 0u);
  EXPECT_EQ(found.series.not_extrapolated, 0u);
  EXPECT_NEAR(found.series.touch_depth, (0.2 + 0.1) / 2, 0.06);  // one of them, or their mean
  EXPECT_LT(found.series.touch_deviation, 1e-3);
  const CheckedAcquisition& acquisition = found.acquisition;
  ASSERT_EQ(acquisition.contacts().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const double stiffness = i == 0 ? 0.5 : 1, number = i == 0 ? 0 : 1;
    const Contact& contact = acquisition.contacts()[i];
    // At the surface, although the touch is noticed at 0.1 N.
    EXPECT_LT((contact.position - Eigen::Vector3d(20.0 * number, 0, 0)).norm(), 1e-4);
    EXPECT_LT((contact.normal - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
    ASSERT_EQ(acquisition.samples_of(i).size(), 1u);
    const Sample& sample = acquisition.samples_of(i)[0];
    EXPECT_LT((sample.force - Eigen::Vector3d(0, 0, -3 * stiffness)).norm(), 1e-6);
    EXPECT_LT((sample.a - Eigen::Vector3d(20.0 * number, 0, -3)).norm(), 1e-6);
    EXPECT_NEAR(sample.time, 4.0 * number + 2.5, 0.02);
  }
  mapping.series.touch_force = 10;
  EXPECT_THAT(refused({"r.csv"}, mapping),
              AllOf(HasSubstr("no press was found"), HasSubstr("unit of the forces")));
  mapping.series.touch_force = 0.1;
  mapping.series.sample_time = 5;
  EXPECT_THAT(refused({"r.csv"}, mapping), HasSubstr("2 presses were found, but none is slower"));
}

TEST_F(SeriesRowsTest, MakesSamplesOfDragsAndOfTheForceUnderWhichTheTipSlid) {
  // 0.5 N/mm along -z and 0.4 N/mm along x, up to friction of 0.5, at 50 Hz: pressed 4 mm deep,
  // held, dragged by 8 mm with 0.4 mm/s, and lifted.
  std::string text = "t,X,Z,Fx,Fz\n";
  double time = 0, held = 0;
  const auto add = [&](double x, double z) {
    const double load = 0.5 * std::max(-z, 0.0), reach = 0.5 * load / 0.4;
    held = load > 0 ? std::clamp(held, x - reach, x + reach) : x;
    text += std::to_string(time) + ',' + std::to_string(x) + ',' + std::to_string(z) + ',' +
            std::to_string(0.4 * (x - held)) + ',' + std::to_string(-load) + '\n';
    time += 0.02;
  };
  for (int i = 0; i < 50; ++i) add(0, 2);
  for (int i = 0; i < 120; ++i) add(0, 2 - 0.05 * i);
  for (int i = 0; i < 50; ++i) add(0, -4);
  for (int i = 0; i <= 1000; ++i) add(0.008 * i, -4);
  for (int i = 0; i < 100; ++i) add(8, -4 + 0.1 * i);
  write_text(folder / "r.csv", text);
  const AcquisitionMapping mapping{.columns = {{"time", "t"},
                                               {"ax", "X"},
                                               {"ay", "0"},
                                               {"az", "Z"},
                                               {"px", "Fx"},
                                               {"py", "0"},
                                               {"pz", "Fz"}},
                                   .content = RowContent::time_series,
                                   .contacts = ContactSource::place,
                                   .normals_from_forces = true};
  const std::vector<std::filesystem::path> files = {folder / "r.csv"};
  const ImportedAcquisition found = import_acquisition(files, mapping);
  EXPECT_EQ(found.series.slides, 1u);
  EXPECT_EQ(found.series.drags_without_base, 0u);
  ASSERT_EQ(found.acquisition.contacts().size(), 1u);
  EXPECT_LT((found.acquisition.contacts()[0].normal - Eigen::Vector3d::UnitZ()).norm(), 0.05);
  std::size_t drags = 0, slipped = 0;
  for (const Sample& sample : found.acquisition.samples()) {
    slipped += sample.slipped ? 1 : 0;
    EXPECT_NEAR(sample.force.z(), -2, 0.05);
    if (sample.slipped) {
      EXPECT_NEAR(sample.force.x(), 1, 0.06);  // friction
      continue;
    }
    // Friction yields at 2.5 mm. Samples that held have the forces of the springs.
    EXPECT_LT(sample.b.x(), 2.5);
    EXPECT_NEAR(sample.force.x(), 0.4 * sample.b.x(), 1e-3);
    if (sample.a == sample.b) continue;
    ++drags;
    EXPECT_LT(sample.a.x(), 0.3);  // up to a twentieth of the force, it is no drag
  }
  EXPECT_EQ(slipped, 1u);
  EXPECT_GE(drags, 7u);
  EXPECT_EQ(found.series.drags, drags);
}

}  // namespace
}  // namespace palpate::probing
