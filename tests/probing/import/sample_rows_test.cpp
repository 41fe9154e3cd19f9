// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/sample_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "import/import_testing.h"
#include "records/probing_testing.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using SampleRowsTest = ImportTest;

TEST_F(SampleRowsTest, OfPressesAloneNeedsNeitherDragsNorSlipsNorIds) {
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

TEST_F(SampleRowsTest, MakesContactsOfTheRowsOfOneTable) {
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

TEST_F(SampleRowsTest, MakesNormalsOfForcesAndCountsOnFromFileToFile) {
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

}  // namespace
}  // namespace palpate::probing
