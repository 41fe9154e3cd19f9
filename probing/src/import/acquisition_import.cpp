// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_import.h"

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "import/column_units.h"
#include "import/import_columns.h"
#include "import/import_conversion.h"
#include "import/import_tables.h"
#include "import/sample_rows.h"
#include "import/series_rows.h"
#include "import/wrong_mapping.h"
#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

namespace fs = std::filesystem;

std::vector<Contact> read_contacts(TableReader& row, const ImportConversion& convert) {
  std::vector<Contact> contacts;
  while (row.next())
    contacts.push_back(
        {row.integer(0), convert.position(row.vector(1)), convert.direction(row.vector(4))});
  return contacts;
}
void check_combination(std::span<const fs::path> files, const AcquisitionMapping& mapping) {
  check_mapping(mapping);
  check_units_of_names(mapping);
  if (files.empty())
    throw InvalidInput("import_acquisition(): there is no file; give at least one");
  const bool has_depth = mapping.columns.contains(kDepthColumn);
  if (has_depth && mapping.content == RowContent::presses_and_drags)
    throw wrong_mapping("columns",
                        "'depth' is that of a press without a drag; the content must "
                        "be presses");
  if (has_depth && mapping.content == RowContent::time_series)
    throw wrong_mapping("columns",
                        "a time series has the position of the tip in ax,ay,az, not a "
                        "depth");
  if (has_depth && mapping.normals_from_forces)
    throw wrong_mapping("columns",
                        "'depth' is along the normal, so that normals cannot come "
                        "from the forces; give nx,ny,nz");
  if (mapping.contacts != ContactSource::table) return;
  if (mapping.content == RowContent::time_series)
    throw wrong_mapping("contacts",
                        "the contacts of a time series are made from its touches: "
                        "contacts must be place, or column if a column says which contact it is");
  if (files.size() > 2 || (files.size() == 1 && !is_mat_file(files[0]))) {
    throw InvalidInput("there are " + std::to_string(files.size()) +
                       " files; pass two, the table of contacts and that of samples, or one MAT "
                       "file that holds both. If contacts are to be made from the rows of one "
                       "table, a mapping must say so (contacts: column or place)");
  }
}

std::string names_of(std::span<const fs::path> files) {
  std::string names = files[0].string();
  if (files.size() == 2) names += " and " + files[1].string();
  if (files.size() > 2) names += " and " + std::to_string(files.size() - 1) + " more";
  return names;
}

}  // namespace

ImportedAcquisition import_acquisition(std::span<const std::filesystem::path> files,
                                       const AcquisitionMapping& mapping) {
  check_combination(files, mapping);
  const ImportConversion convert(mapping);
  ImportTables tables;
  SeriesCounts counts;
  const auto read = [&]() -> Acquisition {
    if (mapping.content == RowContent::time_series) {
      SeriesRows rows(mapping, convert);
      for (std::size_t i = 0; i < files.size(); ++i) rows.read(tables, files[i], i + 1);
      counts = rows.counts();
      return rows.take();
    }
    SampleRows rows(mapping, convert);
    if (mapping.contacts == ContactSource::table) {
      const std::vector<std::string_view> columns(kContactColumns.begin(), kContactColumns.end());
      const std::unique_ptr<TableReader> row =
          tables.open(files[0], columns, layout_of(mapping, kContactsPrefix, 1, 1));
      rows.set_contacts(read_contacts(*row, convert));
      rows.read(tables, files.back(), 1);
    } else {
      for (std::size_t i = 0; i < files.size(); ++i) rows.read(tables, files[i], i + 1);
    }
    return rows.take();
  };
  try {
    Acquisition acquisition = read();
    acquisition.probe_radius = mapping.probe_radius;
    return {CheckedAcquisition(std::move(acquisition)), counts};
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw FileError(names_of(files) + ": " + error.what());
  }
}

}  // namespace palpate::probing
