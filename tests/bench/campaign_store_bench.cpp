// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Time of storing a trial in a store of 1e5 trials, on the disk of the temporary folder, against
// one insertion by plain SQLite into a table of as many rows, with the same pragmas. Counters are
// quantiles over the transactions [ms].
#include <benchmark/benchmark.h>

#include <sqlite3.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "paired.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/closed_form.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

constexpr int kStored = 100000;

void execute(sqlite3* database, const std::string& sql) {
  if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    throw std::runtime_error(sqlite3_errmsg(database));
}

struct OpenDatabase {
  explicit OpenDatabase(const std::filesystem::path& path) {
    if (sqlite3_open(path.c_str(), &database) != SQLITE_OK)
      throw std::runtime_error(sqlite3_errmsg(database));
  }
  ~OpenDatabase() { sqlite3_close(database); }
  OpenDatabase(const OpenDatabase&) = delete;
  OpenDatabase& operator=(const OpenDatabase&) = delete;
  sqlite3* database = nullptr;
};

/// A trial that held, as a row of the table.
TrialRecord trial_at(const ContactPlan& plan, long long number) {
  const Contact& contact = plan.contacts[static_cast<std::size_t>(number) % plan.contacts.size()];
  TrialRecord record{{.trial = number, .contact = contact, .level = 1, .direction = 2}, {}};
  record.order.normal_force = -0.7 * contact.normal;
  record.order.tangential_force = 0.3 * contact.normal.unitOrthogonal();
  TrialResult& result = record.result;
  result.outcome = TrialOutcome::held;
  result.touch = contact.position;
  result.a = result.a_again = contact.position - 1.1 * contact.normal;
  result.b = result.a + 0.2 * record.order.tangential_force;
  result.seconds = 12;
  return record;
}

/// Copies the latest row of a table under this number of further ids, in one transaction.
void multiply_row(sqlite3* database, const std::string& table, const std::string& columns,
                  int count) {
  execute(database, "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " +
                        std::to_string(count) + ") INSERT INTO " + table + " SELECT last.id + i, " +
                        columns + " FROM n, (SELECT * FROM " + table +
                        " ORDER BY id DESC LIMIT 1) AS last");
}

double quantile(std::vector<double> times, double share) {
  const auto middle =
      times.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(times.size() - 1));
  std::nth_element(times.begin(), middle, times.end());
  return 1e3 * *middle;
}

void append_at_1e5(benchmark::State& state) {
  const ScratchFolder folder;
  const auto path = folder.path() / "a.db", peer_path = folder.path() / "peer.db";
  const ContactPlan plan = plan_contacts(make_specimen(Sheet{})->surface());
  {
    CampaignStore store = CampaignStore::create(path, {.plan = to_text(plan),
                                                       .strategy = to_text(CampaignOptions{}),
                                                       .arm = "{}",
                                                       .software = "bench"});
    for (std::size_t i = 0; i < plan.contacts.size(); ++i)
      store.append(trial_at(plan, static_cast<long long>(i)), {}, 0);
    store.finish();
  }
  const int more = kStored - static_cast<int>(plan.contacts.size());
  {
    const OpenDatabase filling(path);
    multiply_row(filling.database, "trial",
                 "contact, level, direction, nx, ny, nz, tx, ty, tz, outcome, touch_x, touch_y, "
                 "touch_z, ax, ay, az, bx, by, bz, again_x, again_y, again_z, slip_statistic, "
                 "seconds, creep, work_dragging, work_releasing",
                 more);
    multiply_row(filling.database, "sample",
                 "contact, group_id, px, py, pz, ax, ay, az, bx, by, bz, on_friction_boundary, "
                 "slipped, range_map, time",
                 more);
  }
  CampaignStore store = CampaignStore::open(path);
  if (store.trials(plan.contacts).size() != kStored)
    throw std::runtime_error("the store was not filled");

  const OpenDatabase peer(peer_path);
  std::string columns = "id INTEGER PRIMARY KEY", values = "1";
  for (int i = 1; i < 28; ++i) {
    columns += ", c" + std::to_string(i) + " REAL";
    values += ", 0." + std::to_string(1000 + i);
  }
  execute(peer.database, "CREATE TABLE t(" + columns + "); INSERT INTO t VALUES(" + values + ")");
  std::string numbers = "c1";
  for (int i = 2; i < 28; ++i) numbers += ", c" + std::to_string(i);
  multiply_row(peer.database, "t", numbers, kStored - 1);
  execute(peer.database, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(
      peer.database,
      ("INSERT INTO t(" + numbers + ") VALUES(" + values.substr(values.find(' ') + 1) + ")")
          .c_str(),
      -1, &insert, nullptr);

  long long next = kStored;
  std::vector<double> ours, plain;
  const auto append = [&] {
    store.append(trial_at(plan, next++), {}, 1e6, R"({"tip": [1, 2, 3]})");
  };
  const auto insert_row = [&] {
    if (sqlite3_step(insert) != SQLITE_DONE)
      throw std::runtime_error(sqlite3_errmsg(peer.database));
    sqlite3_reset(insert);
  };
  for (auto _ : state) {
    if (next % 2 == 0) ours.push_back(bench::seconds(append));
    plain.push_back(bench::seconds(insert_row));
    if (ours.size() < plain.size()) ours.push_back(bench::seconds(append));
  }
  sqlite3_finalize(insert);
  for (const auto& [name, share] : {std::pair{"median", 0.5}, {"p95", 0.95}, {"max", 1.0}}) {
    state.counters[std::string("ours_") + name + "_ms"] = quantile(ours, share);
    state.counters[std::string("peer_") + name + "_ms"] = quantile(plain, share);
  }
  state.counters["ours/peer"] = quantile(ours, 0.5) / quantile(plain, 0.5);
}
BENCHMARK(append_at_1e5)->Iterations(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace palpate::probing
