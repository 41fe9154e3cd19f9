// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_mapping.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "import/import_columns.h"
#include "import/series_fields.h"
#include "import/wrong_mapping.h"
#include "palpate/core/error.h"
#include "palpate/core/idle_fields.h"
#include "palpate/core/input_file.h"
#include "palpate/core/require.h"
#include "palpate/documents/document.h"
#include "palpate/documents/document_fields.h"
#include "palpate/documents/document_node.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::probing {
namespace {

using documents::DocumentMembers;
using documents::DocumentNode;
using NamedUnit = std::pair<std::string_view, double>;

template <std::size_t Size>
double unit_from(const std::array<NamedUnit, Size>& units, std::string_view name) {
  std::string known;
  for (std::size_t i = 0; i < Size; ++i) {
    if (units[i].first == name) return units[i].second;
    known += i == 0 ? "" : i + 1 == Size ? " or " : ", ";
    known += units[i].first;
  }
  throw InvalidInput("unit \"" + std::string(name) + "\" is not known; use " + known);
}

bool is_known_column(const std::string& name) {
  return std::ranges::find(kContactColumns, name) != kContactColumns.end() ||
         std::ranges::find(kSampleColumns, name) != kSampleColumns.end() || name == kDepthColumn ||
         name == kNormalForceColumn || name == std::string(kContactsPrefix) + "id" ||
         name == std::string(kSamplesPrefix) + "id";
}

void check_column(const std::string& column) {
  if (is_known_column(column)) return;
  throw wrong_mapping("columns",
                      "there is no column '" + column +
                          "' to be read; the columns are those of contacts (id,x,y,z,nx,ny,nz) and "
                          "of samples (id,contact,group_id,px,py,pz,ax,ay,az,bx,by,bz,"
                          "on_friction_boundary,slipped,range_map,time,depth,normal_force)");
}

void check_names(const ColumnNames& columns) {
  for (const auto& [column, name] : columns) check_column(column);
  const auto exclude = [&](std::string_view scalar, std::initializer_list<const char*> vectors) {
    if (!columns.contains(scalar)) return;
    for (const char* const column : vectors) {
      if (!columns.contains(column)) continue;
      throw wrong_mapping("columns", "names both '" + std::string(scalar) + "' and '" + column +
                                         "'; the first is in place of the other");
    }
  };
  exclude(kDepthColumn, {"ax", "ay", "az", "bx", "by", "bz"});
  exclude(kNormalForceColumn, {"px", "py", "pz"});
}

// The rotation that is nearest to a matrix of few digits.
Eigen::Matrix3d rotation_of(const DocumentNode& node) {
  const Eigen::Matrix3d matrix = node.rows();
  // Three printed digits.
  constexpr double kRotationTolerance = 2e-3;
  const double error =
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance)) {
    node.fail("the rows are not perpendicular unit vectors (by " + std::to_string(error) +
              "); they must be a rotation matrix, without scale");
  }
  if (matrix.determinant() < 0) {
    node.fail(
        "the rows are a reflection; they must be a rotation, which is right-handed. For files with "
        "a left-handed frame, negate a column: y: -Y, py: -Fy, ...");
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  // An exact matrix stays as it is.
  constexpr double kRounding = 1e-15;
  return error <= kRounding ? matrix : nearest;
}

Eigen::Isometry3d frame_of(const DocumentNode& node) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  DocumentMembers members(node);
  if (const auto rotation = members.find("rotation")) frame.linear() = rotation_of(*rotation);
  if (const auto translation = members.find("translation"))
    frame.translation() = translation->vector();
  members.end();
  return frame;
}

ColumnNames columns_of(const DocumentNode& node) {
  ColumnNames columns;
  node.for_each_member([&](const std::string& column, const DocumentNode& name) {
    name.checked([&] { check_column(column); });
    columns[column] = name.word();
  });
  return columns;
}

void take_units(const DocumentNode& node, AcquisitionMapping& mapping) {
  DocumentMembers members(node);
  const auto take = [&](const char* name, double& unit, auto&& size_of) {
    if (const auto found = members.find(name))
      unit = found->checked([&] { return size_of(found->word()); });
  };
  take("length", mapping.length, [](const auto& name) { return geometry::unit_length(name); });
  take("force", mapping.force, [](const auto& name) { return unit_force(name); });
  take("time", mapping.time, [](const auto& name) { return unit_time(name); });
  members.end();
}

void take_series(const DocumentNode& node, SeriesOptions& series) {
  DocumentMembers members(node);
  members.take("tare", series.tare);
  for (const SeriesField& field : kSeriesFields)
    members.take(field.name, series.*field.field, field.range, field.unit);
  members.end();
}

AcquisitionMapping mapping_of(const DocumentNode& root) {
  AcquisitionMapping mapping;
  DocumentMembers members(root);
  if (const auto columns = members.find("columns")) mapping.columns = columns_of(*columns);
  if (const auto separator = members.find("separator"))
    mapping.separator = separator->checked([&] { return separator_from(separator->word()); });
  if (const auto units = members.find("units")) take_units(*units, mapping);
  members.take("weight", mapping.weight);
  if (const auto frame = members.find("frame")) mapping.T_surface_file = frame_of(*frame);
  if (const auto series = members.find("time_series")) take_series(*series, mapping.series);
  documents::take_fields(members, fields_of(mapping));
  members.end();
  return mapping;
}

}  // namespace

double unit_force(std::string_view name) {
  constexpr double kGravity = 9.80665;   // [m/s^2] standard gravity
  constexpr double kPound = 0.45359237;  // [kg]
  constexpr std::array<NamedUnit, 6> kUnits = {{{"N", 1},
                                                {"mN", 1e-3},
                                                {"kN", 1e3},
                                                {"g", 1e-3 * kGravity},
                                                {"kg", kGravity},
                                                {"lbf", kPound * kGravity}}};
  return unit_from(kUnits, name);
}

double unit_time(std::string_view name) {
  constexpr std::array<NamedUnit, 4> kUnits = {{{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}};
  return unit_from(kUnits, name);
}

char separator_from(const std::string& text) {
  if (text == "tab" || text == "\\t" || text == "\t") return '\t';
  if (text.size() != 1 || text == "\"")
    throw InvalidInput("is " + text + "; it must be one character, or tab");
  return text.front();
}

void visit(AcquisitionMapping& mapping, FieldVisitor& visitor) {
  using namespace std::string_view_literals;
  static constexpr std::array kSigns{"point"sv, "comma"sv}, kBodies{"object"sv, "tool"sv},
      kNormals{"columns"sv, "forces"sv};
  static constexpr std::array kContents{"presses_and_drags"sv, "presses"sv, "time_series"sv},
      kSources{"table"sv, "column"sv, "place"sv};
  visitor.begin("AcquisitionMapping");
  visitor.flag({"header",
                "Read the names of columns in the first line of the files. Without them, the first "
                "column is column_1"},
               mapping.header);
  visitor.choice({"decimal", "Decimal separator of all numbers"}, mapping.decimal_comma, kSigns);
  visitor.choice({"forces_on",
                  "What the forces act on: object, or tool if they are those that the tool feels, "
                  "which changes their signs"},
                 mapping.forces_on_tool, kBodies);
  visitor.choice(
      {"content",
       "What a row is: a sample with all columns, a sample without a drag, or the tip at "
       "one moment of a recording"},
      mapping.content, kContents);
  visitor.choice({"contacts",
                  "What a contact is: a row of a table of its own, all rows with one number in the "
                  "column contact, or all rows at one place"},
                 mapping.contacts, kSources);
  visitor.choice({"normals",
                  "Where the normals of contacts come from that are made of rows: the columns "
                  "nx,ny,nz, or the forces, opposite to their mean"},
                 mapping.normals_from_forces, kNormals);
  visitor.real({"same_place", "Rows at most this far apart are at one place", "mm"},
               mapping.same_place, above(0).finite());
  visitor.real({"probe_radius",
                "Radius of the ball that touched the object, for palpate play --tool-radius", "mm"},
               mapping.probe_radius, above(0).finite());
}

void check_mapping(const AcquisitionMapping& mapping) {
  require("AcquisitionMapping::length", mapping.length, above(0).finite(), "mm");
  require("AcquisitionMapping::force", mapping.force, above(0).finite(), "N");
  require("AcquisitionMapping::time", mapping.time, above(0).finite(), "s");
  static_cast<void>(in_range(mapping));
  for (const double component : mapping.weight)
    require("AcquisitionMapping::weight", component, finite(), "N");
  check_names(mapping.columns);
  if (mapping.contacts == ContactSource::table && mapping.content != RowContent::time_series)
    refuse_idle(mapping, "contacts", {"same_place"});
  if (mapping.normals_from_forces && mapping.contacts == ContactSource::table &&
      mapping.content != RowContent::time_series)
    throw wrong_mapping("normals",
                        "contacts that have a table have their normals in "
                        "it; make the contacts from the rows (contacts: column or place)");
  if (mapping.normals_from_forces && mapping.columns.contains(kNormalForceColumn))
    throw wrong_mapping("columns",
                        "'normal_force' is along the normal, so that normals cannot "
                        "come from the forces; give nx,ny,nz");
}

AcquisitionMapping read_mapping(const std::filesystem::path& path) {
  const documents::Document document = documents::parse_yaml(read_input_file(path), path.string());
  if (document.value.is_null()) {
    throw FileError(path.string() +
                    ": is empty; it must say what differs, such as columns: {px: Fx}");
  }
  return documents::in_file(path.string(), [&] {
    AcquisitionMapping mapping = mapping_of(DocumentNode(document));
    check_mapping(mapping);
    return mapping;
  });
}

}  // namespace palpate::probing
