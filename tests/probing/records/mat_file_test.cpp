// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/mat_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <complex>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>

#include "mat_writer.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

using palpate::support::mat_structure;
using palpate::support::mat_variable;
using palpate::support::mat_variables;
using palpate::support::write_mat;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The numbers of one column of the file.
std::vector<double> mat_column(const std::filesystem::path& path, const std::string& name) {
  const MatFile file(path);
  constexpr std::array<std::string_view, 1> kColumn = {"x"};
  MatReader row(file, kColumn, {.names = {{"x", name}}});
  std::vector<double> numbers;
  while (row.next()) numbers.push_back(row.number(0));
  return numbers;
}

std::string refused_mat(const std::filesystem::path& path, const std::string& name) {
  return refusal([&] { return mat_column(path, name); });
}

Eigen::MatrixXd awkward(Eigen::Index rows, Eigen::Index columns) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1e3);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random) / 3; });
}

std::vector<double> as_list(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

TEST(MatFile, HasTheNumbersThatLibmatioWroteToTheLastBit) {
  const ScratchFolder folder;
  const Eigen::MatrixXd f = awkward(400, 3), x = awkward(5, 30);
  for (const auto& [version, compression] :
       {std::pair(MAT_FT_MAT5, MAT_COMPRESSION_NONE), std::pair(MAT_FT_MAT5, MAT_COMPRESSION_ZLIB),
        std::pair(MAT_FT_MAT73, MAT_COMPRESSION_ZLIB)}) {
    write_mat(
        folder / "m.mat",
        mat_variables(mat_variable("F", f), mat_variable("t", f.col(1)),
                      mat_structure("lab",
                                    [&] {
                                      auto fields = mat_variables(mat_variable("tip", x));
                                      fields.push_back(mat_structure(
                                          "arm", mat_variables(mat_variable("q", f.leftCols(2)))));
                                      return fields;
                                    }())),
        compression, version);
    EXPECT_EQ(mat_column(folder / "m.mat", "F(:,3)"), as_list(f.col(2)));
    EXPECT_EQ(mat_column(folder / "m.mat", "t"), as_list(f.col(1)));
    EXPECT_EQ(mat_column(folder / "m.mat", "lab.tip( 2, : )"), as_list(x.row(1)));
    EXPECT_EQ(mat_column(folder / "m.mat", "lab.arm.q(:,2)"), as_list(f.col(1)));
    EXPECT_EQ(mat_column(folder / "m.mat", "-F(:,1)"), as_list(-f.col(0)));
  }
}

/// A file of level 5 byte by byte, as MATLAB's description of the format says.
class RawMat {
 public:
  explicit RawMat(bool swapped) : swapped_(swapped) {
    bytes_.assign(124, ' ');
    number<std::uint16_t>(0x0100);
    number<std::uint16_t>(0x4D49);  // "MI" as a number of the writing machine
  }
  /// A variable of 2 x 2 numbers: its class, and the type in which they are stored.
  template <typename Number>
  void add(std::uint32_t kind, std::uint32_t type, const std::array<Number, 4>& values) {
    number<std::uint32_t>(14);
    number<std::uint32_t>(16 + 16 + 8 + 8 + padded(4 * sizeof(Number)));
    for (const std::uint32_t each : {6U, 8U, kind, 0U}) number(each);  // flags
    for (const std::uint32_t each : {5U, 8U, 2U, 2U}) number(each);    // size
    number<std::uint32_t>(1 | 1U << 16);                               // name, a small element
    bytes_ += std::string("v\0\0\0", 4);
    number(type);
    number<std::uint32_t>(4 * sizeof(Number));
    for (const Number each : values) number(each);
    bytes_.append(padded(4 * sizeof(Number)) - 4 * sizeof(Number), '\0');
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  static std::uint32_t padded(std::size_t size) {
    return static_cast<std::uint32_t>((size + 7) / 8 * 8);
  }
  template <typename Number>
  void number(Number value) {
    std::array<char, sizeof(Number)> parts{};
    std::memcpy(parts.data(), &value, sizeof(Number));
    if (swapped_) std::ranges::reverse(parts);
    bytes_.append(parts.data(), parts.size());
  }
  bool swapped_;
  std::string bytes_;
};

TEST(MatFile, IsReadInBothByteOrdersAndAllTypesOfNumbers) {
  const ScratchFolder folder;
  const auto expect = [&](const RawMat& raw, const std::vector<double>& second_column) {
    write_text(folder / "m.mat", raw.bytes());
    EXPECT_EQ(mat_column(folder / "m.mat", "v(:,2)"), second_column);
  };
  for (const bool swapped : {false, true}) {
    const auto test = [&]<typename Number>(std::uint32_t kind, std::uint32_t type,
                                           std::array<Number, 4> values) {
      RawMat raw(swapped);
      raw.add(kind, type, values);
      expect(raw, {static_cast<double>(values[2]), static_cast<double>(values[3])});
    };
    test(6, 9, std::array<double, 4>{1, 2, -1.0 / 3, 1e300});
    test(7, 7, std::array<float, 4>{1, 2, -0.1F, 3e38F});
    test(6, 2, std::array<std::uint8_t, 4>{1, 2, 250, 4});  // doubles that are small numbers
    test(8, 1, std::array<std::int8_t, 4>{1, 2, -3, 4});
    test(10, 3, std::array<std::int16_t, 4>{1, 2, -300, 4});
    test(11, 4, std::array<std::uint16_t, 4>{1, 2, 65000, 4});
    test(12, 5, std::array<std::int32_t, 4>{1, 2, -70000, 4});
    test(13, 6, std::array<std::uint32_t, 4>{1, 2, 4000000000U, 4});
    test(14, 12, std::array<std::int64_t, 4>{1, 2, -5000000000LL, 4});
    test(15, 13, std::array<std::uint64_t, 4>{1, 2, 5000000000ULL, 4});
  }
}

TEST(MatFile, GivesRowsOfSeveralColumnsConstantsAndRowNumbers) {
  const ScratchFolder folder;
  write_mat(folder / "m.mat", mat_variables(mat_variable("id", Eigen::Vector3d(4, 5, 6)),
                                            mat_variable("ok", Eigen::Vector3d(0, 1, 2))));
  const MatFile file(folder / "m.mat");
  constexpr std::array<std::string_view, 5> kColumns = {"id", "ok", "nr", "mu", "map"};
  MatReader row(file, kColumns,
                {.names = {{"nr", "row_number"}, {"mu", "0.25"}},
                 .defaults = {{"map", ""}, {"id", "7"}},
                 .first_row = 11});
  ASSERT_TRUE(row.next());
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.integer(0), 5);
  EXPECT_TRUE(row.flag(1));
  EXPECT_EQ(row.integer(2), 12);
  EXPECT_EQ(row.number(3), 0.25);
  EXPECT_EQ(row.text(4), "");
  ASSERT_TRUE(row.next());
  EXPECT_THAT(refusal([&] { return row.flag(1); }),
              AllOf(HasSubstr("m.mat: ok (ok), row 3: found 2"), HasSubstr("0 or 1")));
  EXPECT_FALSE(row.next());
}

TEST(MatFile, NamesWhatIsWrongWithAColumn) {
  const ScratchFolder folder;
  Eigen::MatrixXd f = awkward(4, 3);
  f(2, 1) = std::numeric_limits<double>::quiet_NaN();
  f(1, 2) = 1.5;
  auto variables = mat_variables(mat_variable("F", f), mat_variable("t", awkward(5, 1)));
  std::size_t one[] = {1, 4};
  std::array<char, 4> text = {'a', 'b', 'c', 'd'};
  variables.emplace_back(Mat_VarCreate("name", MAT_C_CHAR, MAT_T_UINT8, 2, one, text.data(), 0));
  std::array<double, 4> real = {1, 2, 3, 4};
  mat_complex_split_t parts = {real.data(), real.data()};
  variables.emplace_back(
      Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, one, &parts, MAT_F_COMPLEX));
  std::size_t cube[] = {2, 2, 2};
  std::array<double, 8> eight = {1, 2, 3, 4, 5, 6, 7, 8};
  variables.emplace_back(
      Mat_VarCreate("cube", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, cube, eight.data(), 0));
  std::array<matvar_t*, 4> cells{};
  for (matvar_t*& cell : cells) cell = mat_variable("", awkward(1, 1)).release();
  variables.emplace_back(
      Mat_VarCreate("c", MAT_C_CELL, MAT_T_CELL, 2, one, static_cast<void*>(cells.data()), 0));
  write_mat(folder / "m.mat", variables);
  const std::filesystem::path path = folder / "m.mat";
  EXPECT_THAT(refused_mat(path, "F(:,2)"),
              AllOf(HasSubstr("m.mat: F(:,2) (x), row 3: found NaN"), HasSubstr("leave the row")));
  EXPECT_THAT(refused_mat(path, "G"),
              AllOf(HasSubstr("no variable 'G' (for x)"), HasSubstr("F, c, cube, name, t, z")));
  EXPECT_THAT(refused_mat(path, "F"), AllOf(HasSubstr("4 x 3"), HasSubstr("F(:,1)")));
  EXPECT_THAT(refused_mat(path, "F(:,4)"), HasSubstr("the matrix has 3 columns"));
  EXPECT_THAT(refused_mat(path, "F(5,:)"), HasSubstr("the matrix has 4 rows"));
  EXPECT_THAT(refused_mat(path, "F(:,0)"), HasSubstr("is no column; name one as F, F(:,2)"));
  EXPECT_THAT(refused_mat(path, "F(1,2)"), HasSubstr("is no column"));
  EXPECT_THAT(refused_mat(path, "name"), HasSubstr("is text; a column must be real numbers"));
  EXPECT_THAT(refused_mat(path, "z"), HasSubstr("is complex"));
  EXPECT_THAT(refused_mat(path, "c"), HasSubstr("is a cell array"));
  EXPECT_THAT(refused_mat(path, "cube"), HasSubstr("2 x 2 x 2"));
  EXPECT_THAT(refused_mat(path, "t.x"), HasSubstr("is no structure"));
  EXPECT_THAT(refused_mat(path, "3"), HasSubstr("no column is read from the file"));
  const MatFile file(path);
  constexpr std::array<std::string_view, 2> kTwo = {"F(:,1)", "t"};
  EXPECT_THAT(refusal([&] { return MatReader(file, kTwo).next(); }),
              AllOf(HasSubstr("t has 5 rows and F(:,1) has 4"), HasSubstr("same number")));
  constexpr std::array<std::string_view, 1> kWhole = {"F(:,3)"};
  MatReader row(file, kWhole);
  ASSERT_TRUE(row.next());
  ASSERT_TRUE(row.next());
  EXPECT_THAT(refusal([&] { return row.integer(0); }),
              AllOf(HasSubstr("found 1.5"), HasSubstr("whole number")));
}

TEST(MatFile, OfAnotherKindIsRefusedWithWhatWouldBeRight) {
  const ScratchFolder folder;
  EXPECT_THAT(refused_mat(folder / "none.mat", "F"), HasSubstr("there is no such file"));
  write_text(folder / "m.mat", "");
  EXPECT_THAT(refused_mat(folder / "m.mat", "F"), HasSubstr("the file is empty"));
  write_text(folder / "m.mat", "x,y\n1,2\n");
  EXPECT_THAT(refused_mat(folder / "m.mat", "F"),
              AllOf(HasSubstr("is not a MAT file of version 5 to 7.3"), HasSubstr("'-v7'")));
  write_mat(folder / "m.mat", mat_variables(mat_variable("F", awkward(40, 3))),
            MAT_COMPRESSION_NONE, MAT_FT_MAT4);
  EXPECT_THAT(refused_mat(folder / "m.mat", "F(:,1)"),
              HasSubstr("is not a MAT file of version 5 to 7.3"));
}

TEST(MatFile, OfVersion73ThatIsCutOffIsRefused) {
  const ScratchFolder folder;
  const Eigen::MatrixXd f = awkward(200, 3);
  write_mat(folder / "m.mat", mat_variables(mat_variable("F", f), mat_variable("G", f)),
            MAT_COMPRESSION_NONE, MAT_FT_MAT73);
  const std::string whole = read_text(folder / "m.mat");
  ASSERT_EQ(mat_column(folder / "m.mat", "F(:,1)"), as_list(f.col(0)));
  constexpr std::size_t kLengths = 24;
  for (std::size_t i = 0; i < kLengths; ++i) {
    write_text(folder / "c.mat", whole.substr(0, whole.size() * i / kLengths));
    EXPECT_THROW(static_cast<void>(mat_column(folder / "c.mat", "F(:,1)")), FileError) << i;
  }
}

TEST(MatFile, ThatIsCutOffOrDamagedNeverGivesOtherNumbersSilently) {
  const ScratchFolder folder;
  const Eigen::MatrixXd f = awkward(20, 3);
  constexpr std::size_t kStep = 7;  // bytes from one damage to the next
  for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    write_mat(folder / "m.mat",
              mat_variables(mat_structure("s", mat_variables(mat_variable("F", f)))), compression);
    const std::string whole = read_text(folder / "m.mat");
    ASSERT_EQ(mat_column(folder / "m.mat", "s.F(:,1)"), as_list(f.col(0)));
    for (std::size_t length = 0; length < whole.size(); length += kStep) {
      write_text(folder / "c.mat", whole.substr(0, length));
      EXPECT_THROW(static_cast<void>(mat_column(folder / "c.mat", "s.F(:,1)")), FileError)
          << length;
    }
    std::size_t refused = 0;
    // Bits of compressed data are covered by a checksum, those of plain numbers are not.
    if (compression == MAT_COMPRESSION_NONE) continue;
    for (std::size_t byte = 136; byte < whole.size(); byte += kStep) {
      std::string changed = whole;
      changed[byte] = static_cast<char>(changed[byte] ^ 16);
      write_text(folder / "c.mat", changed);
      try {  // a few bits are between the data and their checksum
        EXPECT_EQ(mat_column(folder / "c.mat", "s.F(:,1)"), as_list(f.col(0))) << byte;
      } catch (const FileError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, whole.size() / kStep * 9 / 10 - 136 / kStep);
  }
}

}  // namespace
}  // namespace palpate::probing
