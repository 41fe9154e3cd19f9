// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/series_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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
  const CheckedAcquisition& acquisition = found.acquisition;
  ASSERT_EQ(acquisition.contacts().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const double stiffness = i == 0 ? 0.5 : 1, number = i == 0 ? 0 : 1;
    const Contact& contact = acquisition.contacts()[i];
    // Where 0.1 N is reached.
    EXPECT_LT((contact.position - Eigen::Vector3d(20.0 * number, 0, -0.1 / stiffness)).norm(),
              1e-5);
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

}  // namespace
}  // namespace palpate::probing
