// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "import/import_testing.h"
#include "mat_writer.h"
#include "palpate/probing/acquisition_csv.h"
#include "records/probing_testing.h"
#include "repository.h"

namespace palpate::probing {
namespace {

using palpate::support::mat_structure;
using palpate::support::mat_variable;
using palpate::support::mat_variables;
using palpate::support::write_mat;
using ::testing::AllOf;
using ::testing::HasSubstr;

using AcquisitionImport = ImportTest;

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
  expected.samples[2].b.z() = 6;  // 1e12 loses what is added to it
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

}  // namespace
}  // namespace palpate::probing
