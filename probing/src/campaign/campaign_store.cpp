// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign_store.h"

#include <algorithm>
#include <array>
#include <utility>

#include "campaign/writer_lock.h"
#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/core/output_file.h"
#include "palpate/probing/csv.h"
#include "records/database.h"

namespace palpate::probing {
namespace {

constexpr const char* kCampaignSchema =
    "CREATE TABLE run(key TEXT PRIMARY KEY, value TEXT NOT NULL);"
    "CREATE TABLE trial(id INTEGER PRIMARY KEY, contact INTEGER NOT NULL, level INTEGER NOT NULL,"
    " direction INTEGER NOT NULL, nx REAL NOT NULL, ny REAL NOT NULL, nz REAL NOT NULL,"
    " tx REAL NOT NULL, ty REAL NOT NULL, tz REAL NOT NULL, outcome TEXT NOT NULL,"
    " touch_x REAL, touch_y REAL, touch_z REAL, ax REAL, ay REAL, az REAL, bx REAL, by REAL,"
    " bz REAL, again_x REAL, again_y REAL, again_z REAL, slip_statistic REAL,"
    " seconds REAL NOT NULL, creep REAL, work_dragging REAL, work_releasing REAL);"
    "CREATE TABLE event(id INTEGER PRIMARY KEY, trial INTEGER, kind TEXT NOT NULL,"
    " text TEXT NOT NULL);";
// Stores that earlier versions began do not have these two.
constexpr const char* kRangeMapSchema =
    "CREATE TABLE IF NOT EXISTS range_map(name TEXT PRIMARY KEY, fingerprint TEXT NOT NULL)";
constexpr const char* kReferenceSchema =
    "CREATE TABLE IF NOT EXISTS reference_probe(id INTEGER PRIMARY KEY, trials INTEGER NOT NULL,"
    " time REAL NOT NULL, contact INTEGER NOT NULL, nx REAL NOT NULL, ny REAL NOT NULL,"
    " nz REAL NOT NULL, outcome TEXT NOT NULL, touch_x REAL, touch_y REAL, touch_z REAL,"
    " ax REAL, ay REAL, az REAL, seconds REAL NOT NULL)";
constexpr const char* kWhatACampaignIs = "; expected the store of 'palpate probe run'";

constexpr std::array kOutcomes = {TrialOutcome::held,      TrialOutcome::slipped,
                                  TrialOutcome::fell_off,  TrialOutcome::no_contact,
                                  TrialOutcome::unsettled, TrialOutcome::timed_out};

TrialOutcome outcome_of(const std::string& name) {
  for (const TrialOutcome outcome : kOutcomes) {
    if (name == to_string(outcome)) return outcome;
  }
  throw DatabaseError("a trial has the outcome '" + name + "', which is unknown");
}

bool has_table(sqlite3* database, const std::string& name) {
  const std::string count = "SELECT count(*) FROM sqlite_master WHERE name = '" + name + "'";
  return number_of(database, count.c_str()) > 0;
}

bool has_campaign(sqlite3* database) { return has_table(database, "run"); }

void check_is_campaign(sqlite3* database) {
  const long long version = number_of(database, "PRAGMA user_version");
  if (version > kStoreVersion) {
    throw DatabaseError("is of version " + std::to_string(version) +
                        ", newer than this program, which reads " + std::to_string(kStoreVersion));
  }
  if (!has_campaign(database)) throw DatabaseError("holds no campaign");
  if (version < kStoreVersion) {
    throw DatabaseError("is of version " + std::to_string(version) +
                        ", older than this program, which reads " + std::to_string(kStoreVersion) +
                        "; its samples can be exported, its campaign must be begun again");
  }
}

CampaignDescription read_description(sqlite3* database) {
  std::map<std::string, std::string> values;
  const Statement run = prepare(database, "SELECT key, value FROM run");
  while (step(run.get())) {
    Row row(run.get(), "run");
    const std::string key = row.text();
    values[key] = row.text();
  }
  return {.plan = values["plan"],
          .strategy = values["strategy"],
          .arm = values["arm"],
          .software = values["software"],
          .camera = values["camera"]};
}

}  // namespace

struct CampaignStore::Impl {
  std::filesystem::path path;
  std::unique_ptr<WriterLock> lock;  // before the database, as writer_lock.h says
  Database database;
  CampaignDescription description = {};
  std::optional<Insert> contact = {}, sample = {}, trial = {}, boundary = {}, event = {},
                        memory = {}, reference = {}, range_map = {};

  void prepare_to_write() {
    sqlite3* db = database.get();
    execute(db, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON");
    execute(db, kReferenceSchema);
    execute(db, kRangeMapSchema);
  }

  void prepare_statements() {
    sqlite3* db = database.get();
    contact.emplace(db, "INSERT OR IGNORE INTO contact VALUES(?,?,?,?,?,?,?)");
    sample.emplace(db, kInsertSample);
    trial.emplace(
        db, "INSERT INTO trial VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    boundary.emplace(db, "UPDATE sample SET on_friction_boundary = 1 WHERE id = ?");
    event.emplace(db, "INSERT INTO event(trial, kind, text) VALUES(?,?,?)");
    memory.emplace(db, "INSERT OR REPLACE INTO run VALUES('memory', ?)");
    range_map.emplace(db, "INSERT INTO range_map VALUES(?,?)");
    reference.emplace(db, "INSERT INTO reference_probe VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  }

  // Performs all of `work` or nothing.
  template <typename Work>
  void transact(const Work& work) {
    try {
      execute(database.get(), "BEGIN IMMEDIATE");
      work();
      execute(database.get(), "COMMIT");
    } catch (const DatabaseError& wrong) {
      const std::string cause = wrong.what();
      sqlite3_exec(database.get(), "ROLLBACK", nullptr, nullptr, nullptr);
      throw OutputError(path.string() + ": " + cause +
                        "; free some space, then go on with 'palpate probe resume'");
    }
  }
};

CampaignStore::CampaignStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CampaignStore::~CampaignStore() = default;
CampaignStore::CampaignStore(CampaignStore&&) noexcept = default;
CampaignStore& CampaignStore::operator=(CampaignStore&&) noexcept = default;

CampaignStore CampaignStore::create(const std::filesystem::path& path,
                                    const CampaignDescription& description) {
  if (std::filesystem::exists(path)) {
    throw OutputError(path.string() +
                      ": it exists already; choose another name, or go on with it "
                      "by 'palpate probe resume'");
  }
  // The file appears only when it is complete, so that every existing file can be resumed.
  write_file_by_path(path, [&](const std::filesystem::path& temporary) {
    try {
      const Database database = open_database(temporary, SQLITE_OPEN_READWRITE);
      sqlite3* db = database.get();
      execute(db, "PRAGMA journal_mode = MEMORY; BEGIN");
      execute(db, kAcquisitionSchema);
      execute(db, kCampaignSchema);
      std::string set_version = "PRAGMA user_version = ";
      set_version += std::to_string(kStoreVersion);
      execute(db, set_version.c_str());
      Insert run(db, "INSERT INTO run VALUES(?,?)"), meta(db, "INSERT INTO meta VALUES(?,?)");
      const std::pair<const char*, const std::string*> values[] = {
          {"plan", &description.plan},
          {"strategy", &description.strategy},
          {"arm", &description.arm},
          {"software", &description.software}};
      for (const auto& [key, value] : values) (run << std::string(key) << *value).run();
      if (!description.camera.empty()) (run << std::string("camera") << description.camera).run();
      (meta << std::string("source") << description.software).run();
      if (description.probe_radius)
        (meta << std::string(kProbeRadius) << to_text(*description.probe_radius)).run();
      execute(db, "COMMIT");
    } catch (const DatabaseError& wrong) {
      throw OutputError(path.string() + ": " + wrong.what() + "; choose another folder");
    }
  });
  return open(path);
}

CampaignStore CampaignStore::open(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path))
    throw FileError(path.string() + ": there is no such file" + kWhatACampaignIs);
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->lock = std::make_unique<WriterLock>(path);
  try {
    impl->database = open_database(path, SQLITE_OPEN_READWRITE);
    check_is_campaign(impl->database.get());
    impl->description = read_description(impl->database.get());
    impl->prepare_to_write();
    impl->prepare_statements();
  } catch (const DatabaseError& wrong) {
    throw FileError(path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
  return CampaignStore(std::move(impl));
}

CampaignStore CampaignStore::look(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path))
    throw FileError(path.string() + ": there is no such file" + kWhatACampaignIs);
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  try {
    impl->database = open_database(path, SQLITE_OPEN_READONLY);
    check_is_campaign(impl->database.get());
    impl->description = read_description(impl->database.get());
  } catch (const DatabaseError& wrong) {
    throw FileError(path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
  return CampaignStore(std::move(impl));
}

std::optional<CampaignStore> CampaignStore::find(const std::filesystem::path& path) {
  try {
    const Database database = open_database(path, SQLITE_OPEN_READONLY);
    if (!has_campaign(database.get()) ||
        number_of(database.get(), "PRAGMA user_version") != kStoreVersion)
      return std::nullopt;
  } catch (const DatabaseError& wrong) {
    throw FileError(path.string() + ": " + wrong.what());
  }
  return look(path);
}

const CampaignDescription& CampaignStore::description() const { return impl_->description; }

std::vector<TrialRecord> CampaignStore::trials(const std::vector<Contact>& contacts) const {
  std::vector<TrialRecord> records;
  try {
    const Statement rows = prepare(impl_->database.get(), "SELECT * FROM trial ORDER BY id");
    while (step(rows.get())) {
      Row row(rows.get(), "trial");
      TrialRecord record;
      record.order.trial = row.integer();
      const long long contact = row.integer();
      const auto found = std::find_if(contacts.begin(), contacts.end(),
                                      [&](const Contact& each) { return each.id == contact; });
      if (found == contacts.end())
        throw DatabaseError("a trial is of contact " + std::to_string(contact) +
                            ", which the plan does not have");
      record.order.contact = *found;
      record.order.level = static_cast<int>(row.integer());
      record.order.direction = static_cast<int>(row.integer());
      record.order.normal_force = row.vector();
      record.order.tangential_force = row.vector();
      record.result.outcome = outcome_of(row.text());
      record.result.touch = row.vector_or_nan();
      record.result.a = row.vector_or_nan();
      record.result.b = row.vector_or_nan();
      record.result.a_again = row.vector_or_nan();
      record.result.slip_statistic = row.number_or_nan();
      record.result.seconds = row.number();
      record.result.creep = row.number_or_nan();
      record.result.work_dragging = row.number_or_nan();
      record.result.work_releasing = row.number_or_nan();
      records.push_back(record);
    }
  } catch (const DatabaseError& wrong) {
    throw FileError(impl_->path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
  return records;
}

std::vector<ReferenceProbe> CampaignStore::references() const {
  sqlite3* db = impl_->database.get();
  std::vector<ReferenceProbe> probes;
  try {
    if (!has_table(db, "reference_probe")) return {};
    const Statement rows = prepare(db, "SELECT * FROM reference_probe ORDER BY id");
    while (step(rows.get())) {
      Row row(rows.get(), "reference_probe");
      ReferenceProbe probe;
      probe.number = row.integer();
      probe.trials = row.integer();
      probe.time = row.number();
      static_cast<void>(row.integer());  // contact and force, which the plan gives
      static_cast<void>(row.vector());
      probe.result.outcome = outcome_of(row.text());
      probe.result.touch = row.vector_or_nan();
      probe.result.a = row.vector_or_nan();
      probe.result.seconds = row.number();
      probes.push_back(probe);
    }
  } catch (const DatabaseError& wrong) {
    throw FileError(impl_->path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
  return probes;
}

std::vector<CampaignEvent> CampaignStore::events() const {
  std::vector<CampaignEvent> events;
  try {
    const Statement rows =
        prepare(impl_->database.get(), "SELECT trial, kind, text FROM event ORDER BY id");
    while (step(rows.get())) {
      Row row(rows.get(), "event");
      CampaignEvent event;
      event.trial = row.integer();
      event.kind = row.text();
      event.text = row.text();
      events.push_back(std::move(event));
    }
  } catch (const DatabaseError& wrong) {
    throw FileError(impl_->path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
  return events;
}

int CampaignStore::range_maps() const {
  try {
    return static_cast<int>(
        number_of(impl_->database.get(), "SELECT count(*) FROM sample WHERE range_map <> ''"));
  } catch (const DatabaseError& wrong) {
    throw FileError(impl_->path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
}

std::map<std::string, std::string> CampaignStore::range_map_fingerprints() const {
  std::map<std::string, std::string> fingerprints;
  try {
    sqlite3* db = impl_->database.get();
    if (!has_table(db, "range_map")) return {};
    const Statement rows = prepare(db, "SELECT name, fingerprint FROM range_map");
    while (step(rows.get())) {
      Row row(rows.get(), "range_map");
      std::string name = row.text();
      fingerprints[std::move(name)] = row.text();
    }
  } catch (const DatabaseError& wrong) {
    throw FileError(impl_->path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
  return fingerprints;
}

void CampaignStore::append(const TrialRecord& record, const TrialVerdict& verdict, double time,
                           const std::string& memory) {
  const TrialOrder& order = record.order;
  const TrialResult& result = record.result;
  impl_->transact([&] {
    if (const std::optional<Sample> sample = sample_of(order, result, time)) {
      (*impl_->contact << order.contact.id << order.contact.position << order.contact.normal).run();
      insert_sample(*impl_->sample, *sample);
      if (sample->range_map) {
        (*impl_->range_map << *sample->range_map
                           << file_fingerprint(impl_->path.parent_path() / *sample->range_map))
            .run();
      }
    }
    (*impl_->trial << order.trial << order.contact.id << static_cast<long long>(order.level)
                   << static_cast<long long>(order.direction) << order.normal_force
                   << order.tangential_force << std::string(to_string(result.outcome))
                   << result.touch << result.a << result.b << result.a_again
                   << result.slip_statistic << result.seconds << result.creep
                   << result.work_dragging << result.work_releasing)
        .run();
    if (verdict.on_boundary) (*impl_->boundary << *verdict.on_boundary).run();
    const auto note = [&](const char* kind, const std::string& text) {
      (*impl_->event << order.trial << std::string(kind)
                     << "contact " + std::to_string(order.contact.id) + ": " + text)
          .run();
    };
    if (!result.reason.empty()) note("no_equilibrium", result.reason);
    if (!result.no_range_map.empty()) note("no_range_map", result.no_range_map);
    if (verdict.contact_given_up) note("contact_given_up", to_string(result.outcome));
    if (!memory.empty()) (*impl_->memory << memory).run();
  });
}

void CampaignStore::append(const ReferenceProbe& probe, const TrialOrder& order,
                           const std::string& memory) {
  const TrialResult& result = probe.result;
  impl_->transact([&] {
    (*impl_->reference << probe.number << probe.trials << probe.time << order.contact.id
                       << order.normal_force << std::string(to_string(result.outcome))
                       << result.touch << result.a << result.seconds)
        .run();
    if (!memory.empty()) (*impl_->memory << memory).run();
  });
}

std::string CampaignStore::memory() const {
  try {
    const Statement run =
        prepare(impl_->database.get(), "SELECT value FROM run WHERE key = 'memory'");
    return step(run.get()) ? Row(run.get(), "run").text() : std::string();
  } catch (const DatabaseError& wrong) {
    throw FileError(impl_->path.string() + ": " + wrong.what() + kWhatACampaignIs);
  }
}

void CampaignStore::note(const std::string& kind, const std::string& text) {
  impl_->transact([&] {
    const long long trial =
        number_of(impl_->database.get(), "SELECT coalesce(max(id), -1) FROM trial");
    (*impl_->event << trial << kind << text).run();
  });
}

void CampaignStore::finish() {
  for (std::optional<Insert>* each :
       {&impl_->contact, &impl_->sample, &impl_->trial, &impl_->boundary, &impl_->event,
        &impl_->memory, &impl_->reference})
    each->reset();
  sqlite3* db = impl_->database.get();
  try {
    execute(db, "PRAGMA wal_checkpoint(TRUNCATE); PRAGMA journal_mode = DELETE");
  } catch (const DatabaseError& wrong) {
    // Someone reads it at this moment: it is complete with its log.
    if (const int code = sqlite3_errcode(db); code == SQLITE_BUSY || code == SQLITE_LOCKED) return;
    throw OutputError(impl_->path.string() + ": " + wrong.what() + "; free some space");
  }
}

}  // namespace palpate::probing
