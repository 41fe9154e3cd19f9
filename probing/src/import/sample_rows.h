// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "import/contact_maker.h"
#include "import/import_conversion.h"
#include "import/import_tables.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/acquisition_mapping.h"
#include "palpate/probing/table_reader.h"

namespace palpate::probing {

/// Reads samples whose contacts are in a table or in the same rows.
class SampleRows {
 public:
  SampleRows(const AcquisitionMapping& mapping, const ImportConversion& convert);

  /// Contacts of a table, which `depth` and `normal_force` refer to.
  void set_contacts(std::vector<Contact> contacts);
  void read(ImportTables& tables, const std::filesystem::path& file, std::size_t file_number);
  [[nodiscard]] Acquisition take();

 private:
  [[nodiscard]] Sample sample_of(const TableReader& row, const RowPlace& place);

  const AcquisitionMapping& mapping_;
  const ImportConversion& convert_;
  bool one_table_;
  ImportColumns columns_;
  std::size_t rest_ = 0, marks_ = 0;
  std::optional<std::size_t> contact_, force_, normal_force_, tool_, depth_, place_, normal_;
  ContactMaker maker_;
  std::vector<Contact> contacts_;
  std::map<long long, std::size_t> known_;
  std::vector<Sample> samples_;
};

}  // namespace palpate::probing
