// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

#include "palpate/probing/acquisition_mapping.h"
#include "palpate/probing/mat_file.h"
#include "palpate/probing/table_reader.h"

namespace palpate::probing {

/// By its extension.
[[nodiscard]] bool is_mat_file(const std::filesystem::path& path);

/// Files as tables; a MAT file is read once.
class ImportTables {
 public:
  [[nodiscard]] std::unique_ptr<TableReader> open(const std::filesystem::path& path,
                                                  const std::vector<std::string_view>& columns,
                                                  const TableLayout& layout);

 private:
  std::map<std::filesystem::path, MatFile> mat_;
};

/// The columns that are asked for, and where.
class ImportColumns {
 public:
  std::size_t add(std::initializer_list<std::string_view> names) {
    const std::size_t first = names_.size();
    for (const std::string_view name : names) names_.push_back(name);
    return first;
  }
  [[nodiscard]] const std::vector<std::string_view>& names() const { return names_; }

 private:
  std::vector<std::string_view> names_;
};

/// The layout of one of the tables. `prefix` is that of the columns of this table alone.
[[nodiscard]] TableLayout layout_of(const AcquisitionMapping& mapping, std::string_view prefix,
                                    std::size_t file_number, long long first_row);

/// Adds defaults of the columns that a table of presses without drags may lack.
void add_defaults_of_presses(TableLayout& layout);

}  // namespace palpate::probing
