// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "palpate/probing/table_reader.h"

namespace palpate::probing {

/// Reads a MAT file of version 5 to 7.3 (MATLAB, Octave, SciPy), compressed or not, of either byte
/// order, with libmatio, whose messages it takes over for the whole process.
class MatFile {
 public:
  /// \throws FileError if the file is missing, cut off or damaged; for another version, with the
  /// command that saves it in a version that is read.
  explicit MatFile(const std::filesystem::path& path);
  ~MatFile();
  MatFile(MatFile&&) noexcept;
  MatFile& operator=(MatFile&&) noexcept;

 private:
  friend class MatReader;
  struct Content;
  std::unique_ptr<const Content> content_;
};

/// Columns of variables as a table; row k has the k-th number of each column. A column is named as
/// MATLAB does: `F` (a vector), `F(:,2)` (a column of a matrix), `F(2,:)` (a row), `data.F(:,2)`
/// (in a structure). All columns have the same length. Variables must be real and not sparse.
class MatReader final : public TableReader {
 public:
  /// \param file must outlive the reader.
  /// \throws FileError if a column cannot be read; MissingColumn if there is no such variable.
  MatReader(const MatFile& file, std::span<const std::string_view> columns,
            const TableLayout& layout = {});
  ~MatReader() override;

  [[nodiscard]] bool next() override;
  [[nodiscard]] std::string text(std::size_t column) const override;
  [[nodiscard]] double number(std::size_t column) const override;
  [[nodiscard]] long long integer(std::size_t column) const override;
  [[nodiscard]] bool flag(std::size_t column) const override;

 private:
  struct Columns;
  std::unique_ptr<Columns> columns_;
};

}  // namespace palpate::probing
