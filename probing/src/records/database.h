// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/probing/acquisition.h"

// SQLite for the stores of this room and above.
namespace palpate::probing {

/// The tables of an acquisition.
inline constexpr const char* kAcquisitionSchema =
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
/// The key of `Acquisition::probe_radius` in the table meta.
inline constexpr const char* kProbeRadius = "probe_radius";
inline constexpr const char* kInsertContact = "INSERT INTO contact VALUES(?,?,?,?,?,?,?)";
inline constexpr const char* kInsertSample =
    "INSERT INTO sample VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)";

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, CloseDatabase>;

/// A failure of a database; the caller decides whether it is about reading or writing.
struct DatabaseError : Error {
  using Error::Error;
};

inline Database open_database(const std::filesystem::path& path, int flags) {
  // SQLite 3.40 does not open a path with more ".." than there are folders to leave.
  std::error_code unresolved;  // SQLite says what is wrong
  const std::filesystem::path place = std::filesystem::weakly_canonical(path, unresolved);
  sqlite3* raw = nullptr;
  const int status = sqlite3_open_v2((unresolved ? path : place).c_str(), &raw, flags, nullptr);
  Database database(raw);
  if (status != SQLITE_OK) throw DatabaseError(sqlite3_errstr(status));
  return database;
}

inline Statement prepare(sqlite3* database, const std::string& sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database, sql.c_str(), -1, &raw, nullptr) != SQLITE_OK) {
    throw DatabaseError(sqlite3_errmsg(database));
  }
  return Statement(raw);
}

inline bool step(sqlite3_stmt* statement) {
  const int status = sqlite3_step(statement);
  if (status == SQLITE_ROW) return true;
  if (status != SQLITE_DONE) throw DatabaseError(sqlite3_errmsg(sqlite3_db_handle(statement)));
  return false;
}

inline void execute(sqlite3* database, const char* sql) {
  if (sqlite3_exec(database, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
    throw DatabaseError(sqlite3_errmsg(database));
  }
}

/// Reads the columns of one row from left to right, refusing cells of another type.
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
  /// NaN is stored as NULL.
  double number_or_nan() {
    if (sqlite3_column_type(statement_, column_) != SQLITE_NULL) return number();
    ++column_;
    return std::numeric_limits<double>::quiet_NaN();
  }
  Eigen::Vector3d vector() {
    Eigen::Vector3d result;
    for (double& value : result) value = number();
    return result;
  }
  Eigen::Vector3d vector_or_nan() {
    Eigen::Vector3d result;
    for (double& value : result) value = number_or_nan();
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

/// The number that a pragma or a query answers with.
inline long long number_of(sqlite3* database, const char* sql) {
  const Statement statement = prepare(database, sql);
  return step(statement.get()) ? sqlite3_column_int64(statement.get(), 0) : 0;
}

/// Fills the parameters of a statement from left to right and runs it.
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

inline void insert_sample(Insert& statement, const Sample& s) {
  (statement << s.id << s.contact << s.group << s.force << s.a << s.b
             << static_cast<long long>(s.on_friction_boundary) << static_cast<long long>(s.slipped)
             << s.range_map.value_or("") << s.time)
      .run();
}

}  // namespace palpate::probing
