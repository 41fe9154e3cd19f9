// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/probing/campaign.h"

namespace palpate::probing {

/// The description of a campaign: all that its decisions and its arm depend on, as text.
struct CampaignDescription {
  std::string plan;         ///< `to_text` of its plan
  std::string strategy;     ///< of CampaignOptions and the seed (JSON)
  std::string arm;          ///< data with which the arm continues; not read by the campaign
  std::string software;     ///< name and version of the program
  std::string camera = {};  ///< data with which the camera continues; empty: no camera
  std::optional<double> probe_radius = {};  ///< [mm] as in `Acquisition`
};

/// A message about a campaign.
struct CampaignEvent {
  long long trial = -1;  ///< that it belongs to, or that was the latest; -1 if there was none
  std::string kind;      ///< "contact_given_up", "no_equilibrium", "no_range_map", ...
  std::string text;
};

/// Version of the campaign's tables that this library reads and writes.
inline constexpr int kStoreVersion = 2;

/// The store of a running campaign: the database of acquisition_store.h, with the tables
/// `run(key, value)`, `trial` (one row a `TrialRecord`), `reference_probe` (one row a
/// `ReferenceProbe`), `range_map(name, fingerprint)` and `event(id, trial, kind, text)` beside.
/// Each trial is one transaction, which survives a crash and a loss of power (write-ahead log,
/// fully synchronous). `read_acquisition` reads the file at any time.
class CampaignStore {
 public:
  /// Begins a new campaign.
  /// \throws OutputError if `path` exists, or cannot be written.
  static CampaignStore create(const std::filesystem::path& path,
                              const CampaignDescription& description);
  /// Opens a campaign in order to continue it.
  /// \throws FileError if it is missing, damaged, of a newer version, or holds no campaign.
  /// \throws OutputError if it is read-only, or another process writes into it.
  static CampaignStore open(const std::filesystem::path& path);
  /// Opens a campaign, which may be running, in order to look at it.
  /// \throws FileError as `open`.
  static CampaignStore look(const std::filesystem::path& path);
  /// The same for any acquisition; none if it was not measured by a campaign of this version.
  static std::optional<CampaignStore> find(const std::filesystem::path& path);

  ~CampaignStore();
  CampaignStore(CampaignStore&&) noexcept;
  CampaignStore& operator=(CampaignStore&&) noexcept;

  [[nodiscard]] const CampaignDescription& description() const;
  /// The trials so far, in order. `contacts` of the plan give what the table does not repeat.
  /// \throws FileError if a row is not a trial of these contacts.
  [[nodiscard]] std::vector<TrialRecord> trials(const std::vector<Contact>& contacts) const;

  /// The reference probes so far, in order. \throws FileError if a row is not one.
  [[nodiscard]] std::vector<ReferenceProbe> references() const;
  /// In order. \throws FileError if the table cannot be read.
  [[nodiscard]] std::vector<CampaignEvent> events() const;
  /// Number of samples with a range map. \throws FileError if the table cannot be read.
  [[nodiscard]] int range_maps() const;
  /// The `file_fingerprint` that each range map had when it was recorded, by its name in
  /// `Sample::range_map`. \throws FileError if the table cannot be read.
  [[nodiscard]] std::map<std::string, std::string> range_map_fingerprints() const;

  /// Stores a trial, its sample with its contact, the fingerprint of its range map, whose file is
  /// already there, and what followed from it. A trial that failed
  /// for a `TrialResult::reason` gives an event "no_equilibrium", one whose camera saw nothing of
  /// use an event "no_range_map".
  /// \param time [s] since the campaign began.
  /// \param memory `Prober::memory` after the trial.
  /// \throws OutputError if the disk is full: nothing of the trial is then stored.
  void append(const TrialRecord& record, const TrialVerdict& verdict, double time,
              const std::string& memory = {});
  /// Stores a reference probe, which was made with this order. \throws as above.
  void append(const ReferenceProbe& probe, const TrialOrder& order, const std::string& memory = {});
  /// `memory` of the latest trial or reference probe; empty if the arm had none.
  [[nodiscard]] std::string memory() const;

  /// Stores a message about the campaign.
  void note(const std::string& kind, const std::string& text);

  /// Joins the log with the database, so that it is one file again. If another process reads it at
  /// this moment, the log stays beside it.
  void finish();

 private:
  struct Impl;
  explicit CampaignStore(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::probing
