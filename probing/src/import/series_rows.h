// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "import/contact_maker.h"
#include "import/import_conversion.h"
#include "import/import_tables.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/acquisition_import.h"
#include "palpate/probing/acquisition_mapping.h"
#include "palpate/probing/press_series.h"
#include "palpate/probing/table_reader.h"

namespace palpate::probing {

/// Reads recordings, and makes contacts and samples of their presses.
class SeriesRows {
 public:
  SeriesRows(const AcquisitionMapping& mapping, const ImportConversion& convert);

  void read(ImportTables& tables, const std::filesystem::path& file, std::size_t file_number);
  /// \throws InvalidInput if there is no sample.
  [[nodiscard]] Acquisition take();
  [[nodiscard]] SeriesCounts counts() const;

 private:
  struct Recording {
    std::size_t first_row = 1;
    std::vector<double> time = {};
    std::vector<Eigen::Vector3d> tip = {}, force = {}, normal = {};
    std::vector<bool> saturated = {};
  };

  void append(const TableReader& row, const RowPlace& place, Recording& recording);
  [[nodiscard]] SeriesPresses presses_of(const Recording& recording,
                                         const std::filesystem::path& file) const;
  void finish(const Recording& recording, long long contact, const std::filesystem::path& file);
  void add_press(const SeriesPress& press, const Recording& recording, long long contact,
                 const RowPlace& place);

  const AcquisitionMapping& mapping_;
  const ImportConversion& convert_;
  ImportColumns columns_;
  std::size_t time_ = 0, tip_ = 0;
  std::optional<std::size_t> force_, normal_force_, contact_, normal_;
  ContactMaker maker_;
  std::vector<Sample> samples_;
  SeriesCounts counts_;
  std::vector<double> depths_, deviations_;  // [mm] of touches that were extrapolated
  double earliest_ = std::numeric_limits<double>::infinity();
  double largest_ = 0;
};

}  // namespace palpate::probing
