// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "records/probing_testing.h"
#include "repository.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::filesystem::path kSheet = repository("demo") / "sheet";

TEST(AcquisitionCsv, ReadsBackExactlyWhatWasWritten) {
  const ScratchFolder folder;
  write_acquisition_csv(small_acquisition(), folder / "c.csv", folder / "s.csv");
  expect_same(read_acquisition_csv(folder / "c.csv", folder / "s.csv"), small_acquisition());
}

TEST(AcquisitionCsv, ReadsTheBundledSheet) {
  const CheckedAcquisition sheet =
      read_acquisition_csv(kSheet / "contacts.csv", kSheet / "samples.csv");
  EXPECT_EQ(sheet.contacts().size(), 46u);
  EXPECT_EQ(sheet.samples().size(), 11638u);
  EXPECT_EQ(sheet.samples()[1].b, Eigen::Vector3d(-37.5019, -58.0806, 701.03));
  EXPECT_TRUE(sheet.samples()[1].slipped);
}

TEST(AcquisitionCsv, NamesTheFileAndTheRecordThatIsWrong) {
  const ScratchFolder folder;
  write_acquisition_csv(small_acquisition(), folder / "c.csv", folder / "s.csv");
  std::string text = read_text(folder / "s.csv");
  text.replace(text.find("\n2,3,"), 5, "\n2,9,");
  write_text(folder / "s.csv", text);
  EXPECT_THAT(refusal([&] { return read_acquisition_csv(folder / "c.csv", folder / "s.csv"); }),
              AllOf(HasSubstr("s.csv"), HasSubstr("sample 2"), HasSubstr("no contact 9")));
  EXPECT_THAT(refusal([&] { return read_acquisition_csv(folder / "s.csv", folder / "s.csv"); }),
              AllOf(HasSubstr("s.csv: line 1"), HasSubstr("no column 'x'")));
}

TEST(AcquisitionCsv, ReadsOtherNamesSeparatorsAndUnits) {
  const ScratchFolder folder;
  write_text(folder / "c.csv",
             "Place;X;Y;Z;nx;ny;nz\n3;0.01;0.02;0.7;0;0;-1\n8;0.03;0.02;0.7;0;0;-1\n");
  write_text(folder / "s.csv",
             "Nr;Place;Fx;Fy;Fz;X;Y;Z\n1;3;10;20;1500;0.01;0.02;0.705\n"
             "2;8;0;0;500;0.03;0.02;0.702\n");
  const AcquisitionCsvOptions options{.names = {{"contacts.id", "Place"},
                                                {"samples.id", "Nr"},
                                                {"contact", "Place"},
                                                {"group_id", "Nr"},
                                                {"x", "X"},
                                                {"y", "Y"},
                                                {"z", "Z"},
                                                {"px", "Fx"},
                                                {"py", "Fy"},
                                                {"pz", "Fz"},
                                                {"ax", "X"},
                                                {"ay", "Y"},
                                                {"az", "Z"},
                                                {"bx", "X"},
                                                {"by", "Y"},
                                                {"bz", "Z"},
                                                {"slipped", "0"},
                                                {"on_friction_boundary", "0"},
                                                {"range_map", ""},
                                                {"time", "0"}},
                                      .length = 1000,
                                      .force = unit_force("mN")};
  Acquisition expected;
  expected.contacts = {{3, {10, 20, 700}, {0, 0, -1}}, {8, {30, 20, 700}, {0, 0, -1}}};
  expected.samples = {{1, 3, 1, {0.01, 0.02, 1.5}, {10, 20, 705}, {10, 20, 705}},
                      {2, 8, 2, {0, 0, 0.5}, {30, 20, 702}, {30, 20, 702}}};
  expect_same(read_acquisition_csv(folder / "c.csv", folder / "s.csv", options), expected);
  AcquisitionCsvOptions on_tool = options;
  on_tool.forces_on_tool = true;
  for (Sample& sample : expected.samples) sample.force = -sample.force;
  expect_same(read_acquisition_csv(folder / "c.csv", folder / "s.csv", on_tool), expected);
}

TEST(AcquisitionCsv, NamesTheOptionThatIsWrong) {
  const auto refused = [](const AcquisitionCsvOptions& options) {
    return refusal([&] {
      return read_acquisition_csv(kSheet / "contacts.csv", kSheet / "samples.csv", options);
    });
  };
  EXPECT_THAT(refused({.names = {{"pX", "Fx"}}}), HasSubstr("no column 'pX'"));
  EXPECT_THAT(refused({.length = 0}), HasSubstr("AcquisitionCsvOptions::length"));
  EXPECT_THAT(refused({.force = -1}), HasSubstr("AcquisitionCsvOptions::force"));
}

TEST(AcquisitionCsv, KnowsTheUnitsOfForce) {
  EXPECT_EQ(unit_force("N"), 1);
  EXPECT_EQ(unit_force("mN"), 1e-3);
  EXPECT_EQ(unit_force("kN"), 1e3);
  EXPECT_DOUBLE_EQ(1000 * unit_force("g"), unit_force("kg"));
  EXPECT_NEAR(unit_force("lbf"), 4.4482216152605, 1e-12);  // its definition
  EXPECT_THAT(refusal([] { return unit_force("lbs"); }), HasSubstr("N, mN, kN, g, kg or lbf"));
}

TEST(AcquisitionCsv, RefusesEveryFileThatIsCutInsideALine) {
  const ScratchFolder folder;
  write_acquisition_csv(small_acquisition(), folder / "c.csv", folder / "s.csv");
  const std::string text = read_text(folder / "s.csv");
  const std::size_t last_line = text.rfind('\n', text.size() - 2);
  for (std::size_t length = last_line + 2; length < text.rfind(','); ++length) {
    write_text(folder / "s.csv", text.substr(0, length));
    EXPECT_THROW(static_cast<void>(read_acquisition_csv(folder / "c.csv", folder / "s.csv")),
                 FileError)
        << length;
  }
}

TEST(AcquisitionCsv, WritesNothingIfTheAcquisitionIsWrong) {
  const ScratchFolder folder;
  write_text(folder / "c.csv", "old");
  Acquisition acquisition = small_acquisition();
  acquisition.samples[0].range_map = "two\nlines";
  EXPECT_THROW(write_acquisition_csv(acquisition, folder / "c.csv", folder / "s.csv"),
               InvalidInput);
  EXPECT_EQ(read_text(folder / "c.csv"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "s.csv"));
}

}  // namespace
}  // namespace palpate::probing
