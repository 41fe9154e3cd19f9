// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "records/probing_testing.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

void execute(const std::filesystem::path& path, const char* sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

std::string refused_database(const std::filesystem::path& path) {
  return refusal([&] { return read_acquisition(path); });
}

// The message of reading after `sql` has changed a good database.
std::string refused_after(const char* sql) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "a.db";
  write_acquisition(path, small_acquisition());
  execute(path, sql);
  return refused_database(path);
}

TEST(AcquisitionStore, ReadsBackExactlyWhatWasWritten) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "new" / "a.db";
  Acquisition acquisition = small_acquisition();
  acquisition.meta = {{"arm", "it's \"new\""}, {"unit", "mm"}};
  acquisition.probe_radius = 0.1 + 0.2;
  write_acquisition(path, acquisition);
  write_acquisition(path, acquisition);
  const CheckedAcquisition read = read_acquisition(path);
  expect_same(read, acquisition);
  EXPECT_EQ(read.records().meta, acquisition.meta);
  EXPECT_EQ(read.records().probe_radius, 0.1 + 0.2);
}

TEST(AcquisitionStore, OpensAPathThatLeavesMoreFoldersThanThereAre) {
  const ScratchFolder scratch;
  std::string path = (scratch / "zwei Wörter.db").relative_path();
  for (int folders = 0; folders < 40; ++folders) path.insert(0, "../");
  write_acquisition(path, small_acquisition());
  expect_same(read_acquisition(path), small_acquisition());
}

TEST(AcquisitionStore, ReadsDatabasesThatOtherToolsMade) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "a.db";
  execute(path,
          "CREATE TABLE contact(note, nz, ny, nx, z, y, x, id);"
          "CREATE TABLE sample(id, contact, group_id, px, py, pz, ax, ay, az, bx, by, bz,"
          " on_friction_boundary, slipped, range_map, time);"
          "CREATE TABLE meta(key, value); CREATE TABLE other(x);"
          "INSERT INTO contact VALUES('rough', 1, 0, 0, 3, 2, 1.5, 4);"
          "INSERT INTO sample VALUES(9,4,0, 1,2,3, 4,5,6, 7,8,9, 0,1,NULL,0.5)");
  const CheckedAcquisition read = read_acquisition(path);
  EXPECT_EQ(read.contacts()[0].position, Eigen::Vector3d(1.5, 2, 3));
  EXPECT_EQ(read.samples()[0].b, Eigen::Vector3d(7, 8, 9));
  EXPECT_TRUE(read.samples()[0].slipped);
  EXPECT_EQ(read.samples()[0].range_map, std::nullopt);
}

TEST(AcquisitionStore, RefusesFilesThatAreNoSuchDatabase) {
  const ScratchFolder folder;
  EXPECT_THAT(refused_database(folder / "none.db"),
              AllOf(HasSubstr("none.db"), HasSubstr("no such file")));
  EXPECT_FALSE(std::filesystem::exists(folder / "none.db"));
  EXPECT_THAT(refused_database(folder.path()), HasSubstr("is a folder"));
  write_text(folder / "empty.db", "");
  EXPECT_THAT(refused_database(folder / "empty.db"), HasSubstr("empty"));
  write_text(folder / "text.db", std::string(5000, 'x'));
  EXPECT_THAT(refused_database(folder / "text.db"), HasSubstr("expected an SQLite database"));
}

TEST(AcquisitionStore, RefusesATruncatedDatabaseWhereverItIsCut) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "a.db";
  write_acquisition(path, small_acquisition());
  const std::string whole = read_text(path);
  for (std::size_t length = 1; length < whole.size(); length += 997) {
    write_text(path, whole.substr(0, length));
    EXPECT_THROW(static_cast<void>(read_acquisition(path)), FileError) << length;
  }
}

TEST(AcquisitionStore, NamesTheMissingTableOrColumn) {
  EXPECT_THAT(refused_after("INSERT INTO meta VALUES('probe_radius', '3 mm')"),
              AllOf(HasSubstr("'probe_radius' is '3 mm'"), HasSubstr("a number, in mm")));
  EXPECT_THAT(refused_after("INSERT INTO meta VALUES('probe_radius', '0')"),
              HasSubstr("Acquisition::probe_radius is 0 mm; it must be > 0 and finite"));
  EXPECT_THAT(refused_after("DROP TABLE meta"),
              AllOf(HasSubstr("a.db"), HasSubstr("no such table: meta")));
  EXPECT_THAT(refused_after("ALTER TABLE sample RENAME COLUMN slipped TO slid"),
              HasSubstr("no such column: slipped"));
}

TEST(AcquisitionStore, NamesTheRowThatIsWrong) {
  EXPECT_THAT(refused_after("UPDATE contact SET nx = 'left' WHERE id = 8"),
              AllOf(HasSubstr("table contact"), HasSubstr("id 8"), HasSubstr("'nx'"),
                    HasSubstr("a number")));
  EXPECT_THAT(
      refused_after(
          "PRAGMA ignore_check_constraints = 1; UPDATE sample SET slipped = 2 WHERE id = 7"),
      AllOf(HasSubstr("slipped"), HasSubstr("a.db")));
  EXPECT_THAT(refused_after("UPDATE sample SET contact = 5 WHERE id = 7"),
              AllOf(HasSubstr("a.db"), HasSubstr("sample 7"), HasSubstr("no contact 5")));
}

TEST(AcquisitionStore, ReplacesNothingButAnAcquisition) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "a.db";
  const auto expect_kept = [&](const char* what) {
    const std::string before = read_text(path);
    EXPECT_THAT(refusal([&] { write_acquisition(path, small_acquisition()); }),
                AllOf(HasSubstr("a.db: "), HasSubstr(what), HasSubstr("would be lost")));
    EXPECT_EQ(read_text(path), before);
  };
  write_text(path, "ply\nformat ascii 1.0\n");
  expect_kept("no database of measurements");
  write_text(path, "");
  write_acquisition(path, small_acquisition());
  execute(path, "CREATE TABLE notes(text)");
  expect_kept("further tables");
  execute(path, "DROP TABLE notes; CREATE TABLE run(key, value)");
  expect_kept("holds a campaign of 'palpate probe run'");
  execute(path, "DROP TABLE run; DROP TABLE meta");
  expect_kept("no database of measurements");
}

TEST(AcquisitionStore, KeepsTheOldFileIfTheAcquisitionIsWrong) {
  const ScratchFolder scratch;
  const std::filesystem::path path = scratch / "a.db";
  write_acquisition(path, small_acquisition());
  const std::string before = read_text(path);
  EXPECT_THROW(write_acquisition(path, Acquisition{}), InvalidInput);
  EXPECT_EQ(read_text(path), before);
}

}  // namespace
}  // namespace palpate::probing
