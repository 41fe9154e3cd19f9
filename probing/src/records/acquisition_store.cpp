// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_store.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/probing/csv.h"
#include "records/database.h"

namespace palpate::probing {
namespace {

constexpr const char* kWhatIsRight =
    "expected an SQLite database with the tables contact, sample and meta, as 'palpate probe "
    "import' "
    "writes it";

// SQLite itself overlooks a cut inside the last page.
void check_integrity(sqlite3* database, std::uintmax_t file_size, bool has_log) {
  const long long size =
      number_of(database, "PRAGMA page_count") * number_of(database, "PRAGMA page_size");
  // Pages of a campaign that runs, or was killed, may be in its log.
  if (!has_log && file_size < static_cast<std::uintmax_t>(size)) {
    throw DatabaseError("the file is truncated: " + std::to_string(file_size) + " of " +
                        std::to_string(size) + " bytes");
  }
  const Statement check = prepare(database, "PRAGMA quick_check(1)");
  if (!step(check.get())) throw DatabaseError("the database is damaged");
  const std::string answer = Row(check.get(), "quick_check").text();
  if (answer != "ok") throw DatabaseError("the database is damaged: " + answer);
}

double length_of(const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || rest != end)
    throw DatabaseError("table meta: '" + std::string(kProbeRadius) + "' is '" + text +
                        "'; it must be a number, in mm");
  return value;
}

Acquisition read_tables(sqlite3* database, std::uintmax_t file_size) {
  Acquisition acquisition;
  execute(database, "BEGIN");  // a campaign may be adding samples: all tables as of one moment
  // A list that grows is in memory twice. A file that claims to be a table may state any count, but
  // each sample takes at least one byte per column.
  constexpr std::uintmax_t kColumns = 16;
  const long long count = number_of(database, "SELECT count(*) FROM sample");
  acquisition.samples.reserve(static_cast<std::size_t>(
      std::min(static_cast<std::uintmax_t>(std::max(count, 0LL)), file_size / kColumns)));
  const Statement contacts =
      prepare(database, "SELECT id, x, y, z, nx, ny, nz FROM contact ORDER BY id");
  while (step(contacts.get())) {
    Row row(contacts.get(), "contact");
    acquisition.contacts.push_back({row.integer(), row.vector(), row.vector()});
  }
  const Statement samples =
      prepare(database,
              "SELECT id, contact, group_id, px, py, pz, ax, ay, az, bx, by, bz,"
              " on_friction_boundary, slipped, range_map, time FROM sample ORDER BY id");
  while (step(samples.get())) {
    Row row(samples.get(), "sample");
    acquisition.samples.push_back({row.integer(), row.integer(), row.integer(), row.vector(),
                                   row.vector(), row.vector(), row.flag(), row.flag(),
                                   row.optional_text(), row.number()});
  }
  const Statement meta = prepare(database, "SELECT key, value FROM meta ORDER BY key");
  while (step(meta.get())) {
    Row row(meta.get(), "meta");
    const std::string key = row.text(), value = row.text();
    if (key == kProbeRadius)
      acquisition.probe_radius = length_of(value);
    else
      acquisition.meta[key] = value;
  }
  return acquisition;
}

void write_tables(sqlite3* database, const Acquisition& acquisition) {
  execute(database, "PRAGMA foreign_keys = ON");
  execute(database, "BEGIN");
  execute(database, kAcquisitionSchema);
  Insert contact(database, kInsertContact);
  for (const Contact& c : acquisition.contacts) (contact << c.id << c.position << c.normal).run();
  Insert sample(database, kInsertSample);
  for (const Sample& s : acquisition.samples) insert_sample(sample, s);
  Insert meta(database, "INSERT INTO meta VALUES(?,?)");
  for (const auto& [key, value] : acquisition.meta) (meta << key << value).run();
  if (acquisition.probe_radius)
    (meta << std::string(kProbeRadius) << to_text(*acquisition.probe_radius)).run();
  execute(database, "COMMIT");
}

// In words; empty if the database holds the three tables of `write_tables` alone.
std::string more_than_an_acquisition(sqlite3* database) {
  constexpr const char* kOwn =
      "SELECT count(*) FROM sqlite_master WHERE name IN ('contact', 'sample', 'meta')";
  constexpr const char* kOther =
      "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name NOT IN ('contact', "
      "'sample', 'meta')";
  constexpr const char* kCampaign = "SELECT count(*) FROM sqlite_master WHERE name = 'run'";
  if (number_of(database, kCampaign) > 0) return "holds a campaign of 'palpate probe run'";
  if (number_of(database, kOwn) < 3) return "is no database of measurements";
  return number_of(database, kOther) > 0 ? "holds further tables" : "";
}

}  // namespace

CheckedAcquisition read_acquisition(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    const bool is_folder = std::filesystem::is_directory(path, error);
    throw FileError(path.string() + (is_folder ? ": is a folder; " : ": there is no such file; ") +
                    kWhatIsRight);
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (size == 0) {
    throw FileError(path.string() + ": the file is empty; " + kWhatIsRight);
  }
  Acquisition acquisition;
  try {
    const Database database = open_database(path, SQLITE_OPEN_READONLY);
    check_integrity(database.get(), size, std::filesystem::exists(path.string() + "-wal", error));
    acquisition = read_tables(database.get(), size);
  } catch (const DatabaseError& wrong) {
    throw FileError(path.string() + ": " + wrong.what() + "; " + kWhatIsRight);
  }
  try {
    return CheckedAcquisition(std::move(acquisition));
  } catch (const InvalidInput& wrong) {
    throw FileError(path.string() + ": " + wrong.what());
  }
}

void check_acquisition_output(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return;
  if (std::filesystem::file_size(path, error) == 0) return;
  std::string lost;
  try {
    lost = more_than_an_acquisition(open_database(path, SQLITE_OPEN_READONLY).get());
  } catch (const DatabaseError&) {
    lost = "is no database of measurements";
  }
  if (lost.empty()) return;
  throw InvalidInput(path.string() + ": " + lost +
                     ", and would be lost; choose another name, or remove it first");
}

void write_acquisition(const std::filesystem::path& path, const CheckedAcquisition& acquisition) {
  check_acquisition_output(path);
  write_file_by_path(path, [&](const std::filesystem::path& temporary) {
    try {
      // The temporary is renamed or thrown away as a whole: no journal is needed beside it.
      const Database database =
          open_database(temporary, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
      execute(database.get(), "PRAGMA journal_mode = MEMORY");
      write_tables(database.get(), acquisition.records());
    } catch (const DatabaseError& wrong) {
      throw OutputError(path.string() + ": " + wrong.what() +
                        "; free some space or choose another folder");
    }
  });
}

}  // namespace palpate::probing
