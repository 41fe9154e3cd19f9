// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/import_tables.h"

#include <cctype>
#include <string>

#include "import/import_columns.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {

bool is_mat_file(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".mat";
}

std::unique_ptr<TableReader> ImportTables::open(const std::filesystem::path& path,
                                                const std::vector<std::string_view>& columns,
                                                const TableLayout& layout) {
  if (!is_mat_file(path)) return std::make_unique<CsvReader>(path, columns, layout);
  auto found = mat_.find(path);
  if (found == mat_.end()) found = mat_.emplace(path, MatFile(path)).first;
  return std::make_unique<MatReader>(found->second, columns, layout);
}

TableLayout layout_of(const AcquisitionMapping& mapping, std::string_view prefix,
                      std::size_t file_number, long long first_row) {
  TableLayout layout{.separator = mapping.separator,
                     .header = mapping.header,
                     .decimal_comma = mapping.decimal_comma,
                     .mapped = true,
                     .first_row = first_row};
  for (const auto& [column, given] : mapping.columns) {
    const std::string name =
        given == kFileNumber ? to_text(static_cast<long long>(file_number)) : given;
    if (column.starts_with(prefix))
      layout.names[column.substr(prefix.size())] = name;
    else
      layout.names.try_emplace(column, name);
  }
  return layout;
}

void add_defaults_of_presses(TableLayout& layout) {
  const auto name_of = [&](const char* column) {
    const auto named = layout.names.find(column);
    return named == layout.names.end() ? std::string(column) : named->second;
  };
  layout.defaults = {{"id", std::string(kRowNumber)},
                     {"group_id", std::string(kRowNumber)},
                     {"bx", name_of("ax")},
                     {"by", name_of("ay")},
                     {"bz", name_of("az")},
                     {"on_friction_boundary", "0"},
                     {"slipped", "0"},
                     {"range_map", ""},
                     {"time", "0"}};
}

}  // namespace palpate::probing
