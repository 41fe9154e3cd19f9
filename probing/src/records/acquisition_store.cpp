// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_store.h"

#include <sqlite3.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "palpate/error.h"
#include "palpate/output_file.h"

namespace palpate::probing {
namespace {

constexpr const char* kSchema =
    "CREATE TABLE contact(id INTEGER PRIMARY KEY, x REAL NOT NULL, y REAL NOT NULL, z REAL NOT "
    "NULL,"
    " nx REAL NOT NULL, ny REAL NOT NULL, nz REAL NOT NULL);"
    "CREATE TABLE sample(id INTEGER PRIMARY KEY, contact INTEGER NOT NULL REFERENCES contact(id),"
    " group_id INTEGER NOT NULL, px REAL NOT NULL, py REAL NOT NULL, pz REAL NOT NULL,"
    " ax REAL NOT NULL, ay REAL NOT NULL, az REAL NOT NULL,"
    " bx REAL NOT NULL, by REAL NOT NULL, bz REAL NOT NULL,"
    " on_friction_boundary INTEGER NOT NULL CHECK(on_friction_boundary IN (0, 1)),"
    " slipped INTEGER NOT NULL CHECK(slipped IN (0, 1)),"
    " range_map TEXT NOT NULL, time REAL NOT NULL);"
    "CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL);";
constexpr const char* kWhatIsRight =
    "expected an SQLite database with the tables contact, sample and meta, as 'palpate probe "
    "import' "
    "writes it";

struct Close {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Close>;
using Statement = std::unique_ptr<sqlite3_stmt, Close>;

// What went wrong with a database; who calls decides whether it is about reading or writing.
struct DatabaseError : Error {
  using Error::Error;
};

Database open(const std::filesystem::path& path, int flags) {
  sqlite3* raw = nullptr;
  const int status = sqlite3_open_v2(path.c_str(), &raw, flags, nullptr);
  Database database(raw);
  if (status != SQLITE_OK) throw DatabaseError(sqlite3_errstr(status));
  return database;
}

Statement prepare(sqlite3* database, const std::string& sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database, sql.c_str(), -1, &raw, nullptr) != SQLITE_OK) {
    throw DatabaseError(sqlite3_errmsg(database));
  }
  return Statement(raw);
}

bool step(sqlite3_stmt* statement) {
  const int status = sqlite3_step(statement);
  if (status == SQLITE_ROW) return true;
  if (status != SQLITE_DONE) throw DatabaseError(sqlite3_errmsg(sqlite3_db_handle(statement)));
  return false;
}

void execute(sqlite3* database, const char* sql) {
  if (sqlite3_exec(database, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
    throw DatabaseError(sqlite3_errmsg(database));
  }
}

// Reads the columns of one row from left to right, refusing cells of another type.
class Row {
 public:
  Row(sqlite3_stmt* statement, const char* table) : statement_(statement), table_(table) {}

  long long integer() {
    expect(sqlite3_column_type(statement_, column_) == SQLITE_INTEGER, "a whole number");
    return sqlite3_column_int64(statement_, column_++);
  }
  bool flag() {
    const long long value = integer();
    --column_;
    expect(value == 0 || value == 1, "0 or 1");
    ++column_;
    return value == 1;
  }
  double number() {
    const int type = sqlite3_column_type(statement_, column_);
    expect(type == SQLITE_FLOAT || type == SQLITE_INTEGER, "a number");
    return sqlite3_column_double(statement_, column_++);
  }
  Eigen::Vector3d vector() {
    Eigen::Vector3d result;
    for (double& value : result) value = number();
    return result;
  }
  std::string text() {
    const int type = sqlite3_column_type(statement_, column_);
    expect(type == SQLITE_TEXT || type == SQLITE_NULL, "text");
    const auto* chars = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column_++));
    return chars ? chars : "";
  }
  std::optional<std::string> optional_text() {
    std::string found = text();
    return found.empty() ? std::nullopt : std::optional(std::move(found));
  }

 private:
  void expect(bool right, const char* what) const {
    if (right) return;
    const auto* id = reinterpret_cast<const char*>(sqlite3_column_text(statement_, 0));
    throw DatabaseError(std::string("table ") + table_ + ", row with id " + (id ? id : "NULL") +
                        ", column '" + sqlite3_column_name(statement_, column_) +
                        "' does not hold " + what);
  }

  sqlite3_stmt* statement_;
  const char* table_;
  int column_ = 0;
};

// The number that a pragma or a query answers with.
long long number_of(sqlite3* database, const char* sql) {
  const Statement statement = prepare(database, sql);
  return step(statement.get()) ? sqlite3_column_int64(statement.get(), 0) : 0;
}

// SQLite itself overlooks a cut inside the last page.
void check_integrity(sqlite3* database, std::uintmax_t file_size) {
  const long long size =
      number_of(database, "PRAGMA page_count") * number_of(database, "PRAGMA page_size");
  if (file_size < static_cast<std::uintmax_t>(size)) {
    throw DatabaseError("the file is truncated: " + std::to_string(file_size) + " of " +
                        std::to_string(size) + " bytes");
  }
  const Statement check = prepare(database, "PRAGMA quick_check(1)");
  if (!step(check.get())) throw DatabaseError("the database is damaged");
  const std::string answer = Row(check.get(), "quick_check").text();
  if (answer != "ok") throw DatabaseError("the database is damaged: " + answer);
}

Acquisition read_tables(sqlite3* database, std::uintmax_t file_size) {
  Acquisition acquisition;
  // A list that grows is in memory twice. What claims to be a table may count anything, but each
  // sample takes a byte a column at least.
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
    const std::string key = row.text();
    acquisition.meta[key] = row.text();
  }
  return acquisition;
}

// Fills the parameters of a statement from left to right and runs it.
class Insert {
 public:
  Insert(sqlite3* database, const char* sql) : statement_(prepare(database, sql)) {}

  Insert& operator<<(long long value) {
    return check(sqlite3_bind_int64(statement_.get(), ++parameter_, value));
  }
  Insert& operator<<(double value) {
    return check(sqlite3_bind_double(statement_.get(), ++parameter_, value));
  }
  Insert& operator<<(const Eigen::Vector3d& v) { return *this << v.x() << v.y() << v.z(); }
  Insert& operator<<(const std::string& text) {
    return check(sqlite3_bind_text(statement_.get(), ++parameter_, text.data(),
                                   static_cast<int>(text.size()), SQLITE_TRANSIENT));
  }
  void run() {
    step(statement_.get());
    check(sqlite3_reset(statement_.get()));
    parameter_ = 0;
  }

 private:
  Insert& check(int status) {
    if (status != SQLITE_OK) throw DatabaseError(sqlite3_errstr(status));
    return *this;
  }

  Statement statement_;
  int parameter_ = 0;
};

void write_tables(sqlite3* database, const Acquisition& acquisition) {
  execute(database, "PRAGMA foreign_keys = ON");
  execute(database, "BEGIN");
  execute(database, kSchema);
  Insert contact(database, "INSERT INTO contact VALUES(?,?,?,?,?,?,?)");
  for (const Contact& c : acquisition.contacts) (contact << c.id << c.position << c.normal).run();
  Insert sample(database, "INSERT INTO sample VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  for (const Sample& s : acquisition.samples) {
    (sample << s.id << s.contact << s.group << s.force << s.a << s.b
            << static_cast<long long>(s.on_friction_boundary) << static_cast<long long>(s.slipped)
            << s.range_map.value_or("") << s.time)
        .run();
  }
  Insert meta(database, "INSERT INTO meta VALUES(?,?)");
  for (const auto& [key, value] : acquisition.meta) (meta << key << value).run();
  execute(database, "COMMIT");
}

}  // namespace

CheckedAcquisition read_acquisition(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw FileError(path.string() + ": there is no such file; " + kWhatIsRight);
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (size == 0) {
    throw FileError(path.string() + ": the file is empty; " + kWhatIsRight);
  }
  Acquisition acquisition;
  try {
    const Database database = open(path, SQLITE_OPEN_READONLY);
    check_integrity(database.get(), size);
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

void write_acquisition(const std::filesystem::path& path, const CheckedAcquisition& acquisition) {
  write_file_by_path(path, [&](const std::filesystem::path& temporary) {
    try {
      // The temporary is renamed or thrown away as a whole: no journal is needed beside it.
      const Database database = open(temporary, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
      execute(database.get(), "PRAGMA journal_mode = MEMORY");
      write_tables(database.get(), acquisition.records());
    } catch (const DatabaseError& wrong) {
      throw OutputError(path.string() + ": " + wrong.what() +
                        "; free some space or choose another folder");
    }
  });
}

}  // namespace palpate::probing
