// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/press_series.h"
#include "palpate/probing/table_reader.h"

namespace palpate::probing {

/// The meaning of a row of measurements.
enum class RowContent {
  presses_and_drags,  ///< a sample with all columns, see acquisition_csv.h
  presses,            ///< a sample without a drag: b is a, it did not slip, and is its own group
  time_series         ///< the tip at one moment: time, ax,ay,az (its position), px,py,pz
};

/// The source of the contacts.
enum class ContactSource {
  table,   ///< they have a table of their own: id,x,y,z,nx,ny,nz
  column,  ///< rows with the same `contact` are one; it has the mean of their x,y,z and nx,ny,nz
  place    ///< the same for rows whose x,y,z are at one place; they need no column `contact`
};

/// Mapping of the files of another laboratory to contacts and samples. docs/measurements.md
/// describes each field, and the mapping file that holds them. The meaning, unit and range of those
/// that are one number or word stand in their list, `visit`.
struct AcquisitionMapping {
  /// Names of columns in the files, where they differ. "contacts.id" and "samples.id" are the
  /// column `id` of one of the two tables. Besides the columns of acquisition_csv.h there are
  /// `depth` and `normal_force`, in place of ax,...,bz and px,py,pz.
  ColumnNames columns = {};
  std::optional<char> separator = std::nullopt;  ///< as in `TableLayout`, and so are the next two
  bool header = true;
  bool decimal_comma = false;   ///< in the list: decimal
  double length = 1;            ///< [mm] unit of positions; > 0 and finite
  double force = 1;             ///< [N] unit of forces; > 0 and finite
  double time = 1;              ///< [s] unit of times; > 0 and finite
  bool forces_on_tool = false;  ///< in the list: forces_on
  /// [N] Weight of what hangs on the sensor, as a vector in the frame of the files; finite. It is
  /// taken off the forces, with which the sensor measures it.
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  /// Maps the frame of the files to that of the surface, after lengths are in mm.
  std::optional<Eigen::Isometry3d> T_surface_file = std::nullopt;
  RowContent content = RowContent::presses_and_drags;
  ContactSource contacts = ContactSource::table;
  bool normals_from_forces = false;  ///< in the list: normals
  double same_place = 1;
  SeriesOptions series = {};  ///< of `time_series`
  std::optional<double> probe_radius = {};
};

void visit(AcquisitionMapping& mapping, FieldVisitor& visitor);

/// [N] Force of a unit given by name: N, mN, kN, g (the weight of a gram), kg or lbf.
/// \throws InvalidInput for another name, with the names that are known.
[[nodiscard]] double unit_force(std::string_view name);

/// [s] Time of a unit given by name: s, ms, us or min.
/// \throws InvalidInput for another name, with the names that are known.
[[nodiscard]] double unit_time(std::string_view name);

/// The separator of a text: one character, or "tab".
/// \throws InvalidInput for anything else.
[[nodiscard]] char separator_from(const std::string& text);

/// \throws InvalidInput if a number is outside its range, if `columns` has an unknown key or two
/// that exclude each other, or if a field does not suit the other ones.
void check_mapping(const AcquisitionMapping& mapping);

/// Reads a mapping file (YAML).
/// \throws FileError naming the file, the line, what is wrong and what would be right.
[[nodiscard]] AcquisitionMapping read_mapping(const std::filesystem::path& path);

}  // namespace palpate::probing
