// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "mat_writer.h"
#include "palpate/probing/acquisition_csv.h"
#include "records/probing_testing.h"
#include "repository.h"

namespace palpate::probing {
namespace {

using palpate::testing::mat_structure;
using palpate::testing::mat_variable;
using palpate::testing::mat_variables;
using palpate::testing::write_mat;
using ::testing::AllOf;
using ::testing::HasSubstr;

class AcquisitionImport : public ::testing::Test {
 protected:
  CheckedAcquisition import(const std::vector<std::string>& names,
                            const AcquisitionMapping& mapping) const {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) files.push_back(folder / name);
    return import_acquisition(files, mapping).acquisition;
  }
  std::string refused(const std::vector<std::string>& names,
                      const AcquisitionMapping& mapping) const {
    return refusal([&] { return import(names, mapping); });
  }

  ScratchFolder folder;
};

TEST_F(AcquisitionImport, ReadsOtherNamesSeparatorsAndUnits) {
  write_text(folder / "c.csv",
             "Place;X;Y;Z;nx;ny;nz\n3;0.01;0.02;0.7;0;0;-1\n8;0.03;0.02;0.7;0;0;-1\n");
  write_text(folder / "s.csv",
             "Nr;Place;Fx;Fy;Fz;X;Y;Z;t\n1;3;10;20;1500;0.01;0.02;0.705;250\n"
             "2;8;0;0;500;0.03;0.02;0.702;500\n");
  AcquisitionMapping mapping{.columns = {{"contacts.id", "Place"},
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
                                         {"time", "t"}},
                             .length = 1000,
                             .force = unit_force("mN"),
                             .time = unit_time("ms")};
  Acquisition expected;
  expected.contacts = {{3, {10, 20, 700}, {0, 0, -1}}, {8, {30, 20, 700}, {0, 0, -1}}};
  expected.samples = {
      {1, 3, 1, {0.01, 0.02, 1.5}, {10, 20, 705}, {10, 20, 705}, false, false, {}, 0.25},
      {2, 8, 2, {0, 0, 0.5}, {30, 20, 702}, {30, 20, 702}, false, false, {}, 0.5}};
  expect_same(import({"c.csv", "s.csv"}, mapping), expected);
  mapping.forces_on_tool = true;
  for (Sample& sample : expected.samples) sample.force = -sample.force;
  expect_same(import({"c.csv", "s.csv"}, mapping), expected);
}

TEST_F(AcquisitionImport, MovesEverythingIntoTheFrameOfTheSurface) {
  write_acquisition_csv(small_acquisition(), folder / "c.csv", folder / "s.csv");
  Eigen::Isometry3d T(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
  T.translation() = Eigen::Vector3d(100.5, -20, 3);
  Acquisition expected = small_acquisition();
  expected.samples[2].b.z() = 6;  // 1e300 loses what is added to it
  write_acquisition_csv(expected, folder / "c.csv", folder / "s.csv");
  const CheckedAcquisition found = import({"c.csv", "s.csv"}, {.T_surface_file = T});
  for (std::size_t i = 0; i < expected.contacts.size(); ++i) {
    EXPECT_LT((found.contacts()[i].position - T * expected.contacts[i].position).norm(), 1e-11);
    EXPECT_LT((found.contacts()[i].normal - T.linear() * expected.contacts[i].normal).norm(),
              1e-14);
  }
  for (std::size_t i = 0; i < expected.samples.size(); ++i) {
    EXPECT_LT((found.samples()[i].force - T.linear() * expected.samples[i].force).norm(), 1e-14);
    EXPECT_LT((found.samples()[i].a - T * expected.samples[i].a).norm(), 1e-11);
    EXPECT_LT((found.samples()[i].b - T * expected.samples[i].b).norm(), 1e-11);
  }
}

TEST_F(AcquisitionImport, OfAMatFileGivesTheNumbersOfTheCsvFiles) {
  const std::filesystem::path sheet = repository("demo") / "sheet";
  const CheckedAcquisition expected =
      read_acquisition_csv(sheet / "contacts.csv", sheet / "samples.csv");
  const auto columns = [](const auto& records, Eigen::Index width, auto&& row_of) {
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(records.size()), width);
    for (std::size_t i = 0; i < records.size(); ++i)
      matrix.row(static_cast<Eigen::Index>(i)) = row_of(records[i]).transpose();
    return matrix;
  };
  const Eigen::MatrixXd contacts = columns(expected.contacts(), 7, [](const Contact& contact) {
    Eigen::VectorXd row(7);
    row << static_cast<double>(contact.id), contact.position, contact.normal;
    return row;
  });
  const Eigen::MatrixXd samples = columns(expected.samples(), 15, [](const Sample& sample) {
    Eigen::VectorXd row(15);
    row << static_cast<double>(sample.id), static_cast<double>(sample.contact),
        static_cast<double>(sample.group), sample.force, sample.a, sample.b,
        static_cast<double>(sample.on_friction_boundary), static_cast<double>(sample.slipped),
        sample.time;
    return row;
  });
  write_mat(folder / "sheet.mat",
            mat_variables(mat_variable("C", contacts),
                          mat_structure("data", mat_variables(mat_variable("S", samples)))));
  AcquisitionMapping mapping{.columns = {{"contacts.id", "C(:,1)"}, {"samples.id", "data.S(:,1)"}}};
  const std::array names = {"x", "y", "z", "nx", "ny", "nz"};
  for (std::size_t i = 0; i < names.size(); ++i)
    mapping.columns[names[i]] = "C(:," + std::to_string(i + 2) + ")";
  const std::array of_samples = {"contact", "group_id", "px", "py", "pz", "ax",
                                 "ay",      "az",       "bx", "by", "bz", "on_friction_boundary",
                                 "slipped", "time"};
  for (std::size_t i = 0; i < of_samples.size(); ++i)
    mapping.columns[of_samples[i]] = "data.S(:," + std::to_string(i + 2) + ")";
  mapping.columns["range_map"] = "";
  Acquisition without_maps = expected.records();
  for (Sample& sample : without_maps.samples) sample.range_map.reset();
  expect_same(import({"sheet.mat"}, mapping), without_maps);
}

TEST_F(AcquisitionImport, OfPressesAloneNeedsNeitherDragsNorSlipsNorIds) {
  write_text(folder / "c.csv", "id,x,y,z,nx,ny,nz\n3,10,20,700,0,0,-1\n");
  write_text(folder / "s.csv",
             "contact,px,py,pz,X,ay,az\n3,0,0,1,10,20,702\n3,0,0,2,10.5,20,703\n");
  Acquisition expected;
  expected.contacts = {{3, {10, 20, 700}, {0, 0, -1}}};
  expected.samples = {{1, 3, 1, {0, 0, 1}, {10, 20, 702}, {10, 20, 702}},
                      {2, 3, 2, {0, 0, 2}, {10.5, 20, 703}, {10.5, 20, 703}}};
  AcquisitionMapping mapping{.columns = {{"ax", "X"}}, .content = RowContent::presses};
  expect_same(import({"c.csv", "s.csv"}, mapping), expected);
  // Columns that are there are used.
  write_text(folder / "s.csv",
             "id,contact,px,py,pz,X,ay,az,time\n7,3,0,0,1,10,20,702,5\n9,3,0,0,2,10.5,20,703,6\n");
  expected.samples[0].id = 7;
  expected.samples[1].id = 9;
  expected.samples[0].time = 5;
  expected.samples[1].time = 6;
  expect_same(import({"c.csv", "s.csv"}, mapping), expected);
  mapping.content = RowContent::presses_and_drags;
  EXPECT_THAT(refused({"c.csv", "s.csv"}, mapping), HasSubstr("no column 'group_id'"));
}

TEST_F(AcquisitionImport, MakesContactsOfTheRowsOfOneTable) {
  // Depths in mm and the readings of a scale in grams, by place; the outward normal is +y.
  write_text(folder / "one.tsv",
             "X\tZ\tdepth\tload\n5\t1\t1\t100\n5\t1\t2\t250\n25\t1\t1\t50\n5.2\t1\t3\t400\n");
  AcquisitionMapping mapping{.columns = {{"x", "X"},
                                         {"y", "40"},
                                         {"z", "Z"},
                                         {"nx", "0"},
                                         {"ny", "1"},
                                         {"nz", "0"},
                                         {"depth", "depth"},
                                         {"normal_force", "load"}},
                             .force = unit_force("g"),
                             .content = RowContent::presses,
                             .contacts = ContactSource::place,
                             .same_place = 0.5};
  const CheckedAcquisition found = import({"one.tsv"}, mapping);
  ASSERT_EQ(found.contacts().size(), 2u);
  EXPECT_LT((found.contacts()[0].position - Eigen::Vector3d((5 + 5 + 5.2) / 3, 40, 1)).norm(),
            1e-12);
  EXPECT_EQ(found.contacts()[0].normal, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(found.contacts()[1].position, Eigen::Vector3d(25, 40, 1));
  ASSERT_EQ(found.samples_of(0).size(), 3u);
  EXPECT_EQ(found.samples_of(0)[1].a, Eigen::Vector3d(5, 38, 1));
  EXPECT_LT((found.samples_of(0)[1].force - Eigen::Vector3d(0, -0.25 * 9.80665, 0)).norm(), 1e-14);
  EXPECT_EQ(found.samples_of(1)[0].id, 3);

  // The same as a column that says which contact it is; too far from each other for one.
  mapping.columns["contact"] = "nr";
  mapping.contacts = ContactSource::column;
  write_text(folder / "one.tsv",
             "nr\tX\tZ\tdepth\tload\n8\t5\t1\t1\t100\n4\t25\t1\t1\t50\n8\t5\t1\t2\t250\n");
  const CheckedAcquisition by_column = import({"one.tsv"}, mapping);
  ASSERT_EQ(by_column.contacts().size(), 2u);
  EXPECT_EQ(by_column.contacts()[0].id, 8);
  EXPECT_EQ(by_column.contacts()[0].position, Eigen::Vector3d(5, 40, 1));
  EXPECT_EQ(by_column.samples_of(0).size(), 2u);
  write_text(folder / "one.tsv", "nr\tX\tZ\tdepth\tload\n8\t5\t1\t1\t100\n8\t6\t1\t2\t250\n");
  EXPECT_THAT(refused({"one.tsv"}, mapping),
              AllOf(HasSubstr("one.tsv: row 2: contact 8 is 1 mm from"), HasSubstr("same_place")));
}

TEST_F(AcquisitionImport, MakesNormalsOfForcesAndCountsOnFromFileToFile) {
  write_text(folder / "1.csv", "px,py,pz,ax,ay,az\n0,0,1,0,0,2\n0,0.6,2,0,0,4\n");
  write_text(folder / "2.csv", "px,py,pz,ax,ay,az\n0,-3,4,50,0,2\n");
  AcquisitionMapping mapping{
      .columns = {{"contact", "file_number"}, {"x", "file_number"}, {"y", "0"}, {"z", "0"}},
      .content = RowContent::presses,
      .contacts = ContactSource::column,
      .normals_from_forces = true};
  const CheckedAcquisition found = import({"1.csv", "2.csv"}, mapping);
  ASSERT_EQ(found.contacts().size(), 2u);
  EXPECT_LT((found.contacts()[0].normal - Eigen::Vector3d(0, -0.6, -3).normalized()).norm(), 1e-15);
  EXPECT_LT((found.contacts()[1].normal - Eigen::Vector3d(0, 0.6, -0.8)).norm(), 1e-15);
  EXPECT_EQ(found.contacts()[1].position.x(), 2);
  EXPECT_EQ(found.samples()[2].id, 3);
  write_text(folder / "2.csv", "px,py,pz,ax,ay,az\n0,-3,4,50,0,2\n0,3,-4,50,0,2\n");
  EXPECT_THAT(refused({"1.csv", "2.csv"}, mapping),
              AllOf(HasSubstr("contact 2"), HasSubstr("different directions")));
}

TEST_F(AcquisitionImport, NamesWhatDoesNotSuitTheFiles) {
  write_text(folder / "c.csv", "id,x,y,z,nx,ny,nz\n3,10,20,700,0,0,-1\n");
  write_text(folder / "d.csv", "contact,depth,F\n3,1,2\n4,1,2\n");
  EXPECT_THAT(refused({"c.csv"}, {}), AllOf(HasSubstr("pass two"), HasSubstr("contacts: column")));
  const AcquisitionMapping depth{.columns = {{"depth", "depth"}, {"normal_force", "F"}},
                                 .content = RowContent::presses};
  EXPECT_THAT(refused({"c.csv", "d.csv"}, depth),
              AllOf(HasSubstr("d.csv: row 2: there is no contact 4"), HasSubstr("remove the row")));
  EXPECT_THAT(refused({"c.csv", "d.csv"}, {.columns = {{"depth", "depth"}}}),
              HasSubstr("content must be presses"));
  EXPECT_THAT(refused({"c.csv"}, {.content = RowContent::time_series}),
              HasSubstr("contacts must be place, or column"));
  AcquisitionMapping one{.columns = {{"nx", "0"}, {"ny", "0"}, {"nz", "2"}},
                         .content = RowContent::presses,
                         .contacts = ContactSource::place};
  write_text(folder / "o.csv", "x,y,z,px,py,pz,ax,ay,az\n1,2,3,0,0,-1,1,2,2\n");
  EXPECT_THAT(refused({"o.csv"}, one),
              AllOf(HasSubstr("o.csv: row 1: its normal"), HasSubstr("has length 2")));
  one.columns["nz"] = "1";
  write_text(folder / "o.csv", "x,y,z,px,py,pz,ax,ay,az\n1,2,3,0,0,-1,1,2,high\n");
  EXPECT_THAT(refused({"o.csv"}, one),
              AllOf(HasSubstr("o.csv: line 2, column 'az': found 'high'"), HasSubstr("number")));
  write_text(folder / "o.csv", "x,y,z,px,py,pz,ax,ay,az\n");
  EXPECT_THAT(refused({"o.csv"}, one), AllOf(HasSubstr("o.csv"), HasSubstr("no contact")));
}

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

TEST_F(AcquisitionImport, FindsThePressesOfARecording) {
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
