// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_mapping.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "import/import_columns.h"
#include "import/series_fields.h"
#include "import/wrong_mapping.h"
#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/core/idle_fields.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::probing {
namespace {

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

void check_names(const ColumnNames& columns) {
  for (const auto& [column, name] : columns) {
    if (is_known_column(column)) continue;
    throw wrong_mapping(
        "columns", "there is no column '" + column +
                       "' to be read; the columns are those of contacts (id,x,y,z,nx,ny,nz) and of "
                       "samples (id,contact,group_id,px,py,pz,ax,ay,az,bx,by,bz,"
                       "on_friction_boundary,slipped,range_map,time,depth,normal_force)");
  }
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

/// Places in a mapping file, and what is wrong there.
class MappingPage {
 public:
  explicit MappingPage(std::string path) : path_(std::move(path)) {}

  [[noreturn]] void refuse(const YAML::Node& at, const std::string& what) const {
    throw FileError(path_ + ": line " + std::to_string(at.Mark().line + 1) + ": " + what);
  }

  /// Runs `read`; what it refuses gets its place.
  template <typename Read>
  auto at(const YAML::Node& node, const std::string& name, Read&& read) const {
    try {
      return read();
    } catch (const FileError&) {
      throw;
    } catch (const InvalidInput& wrong) {
      refuse(node, name + ": " + wrong.what());
    }
  }

  [[nodiscard]] std::string text(const YAML::Node& node, const std::string& name) const {
    if (node.IsNull()) return {};
    if (!node.IsScalar()) refuse(node, "'" + name + "' has parts; it must be one word or number");
    return node.Scalar();
  }

  [[nodiscard]] double number(const YAML::Node& node, const std::string& name) const {
    const std::string found = text(node, name);
    double value = 0;
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error != std::errc{} || end != found.data() + found.size() || !std::isfinite(value))
      refuse(node, "'" + name + "' is '" + found + "'; it must be a finite number such as 0.5");
    return value;
  }

  [[nodiscard]] Eigen::Vector3d vector(const YAML::Node& node, const std::string& name) const {
    if (!node.IsSequence() || node.size() != 3)
      refuse(node, "'" + name + "' must be three numbers such as [0, 0, 1]");
    return {number(node[0], name), number(node[1], name), number(node[2], name)};
  }

  using Keys = std::vector<std::pair<std::string, std::function<void(const YAML::Node&)>>>;
  /// Passes each value of a map to the function of its key.
  void read(const YAML::Node& map, const std::string& what, const Keys& keys) const {
    std::string known;
    for (const auto& [key, take] : keys) known += (known.empty() ? "" : ", ") + key;
    if (!map.IsMap()) refuse(map, what + " must have keys with values; the keys are " + known);
    std::set<std::string> seen;
    for (const auto& entry : map) {
      const std::string key = text(entry.first, "key");
      const auto found = std::ranges::find(keys, key, [](const auto& each) { return each.first; });
      if (found == keys.end()) refuse_unknown(entry.first, key, what, known);
      if (!seen.insert(key).second) refuse(entry.first, "'" + key + "' is there twice; keep one");
      found->second(entry.second);
    }
  }

 private:
  [[noreturn]] void refuse_unknown(const YAML::Node& at, const std::string& key,
                                   const std::string& what, const std::string& known) const {
    refuse(at, "'" + key + "' is unknown; " + what + " has " + known);
  }

  std::string path_;
};

/// The rotation that is nearest to a matrix of few digits.
Eigen::Matrix3d read_rotation(const MappingPage& page, const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != 3) {
    page.refuse(node, "'rotation' must be three rows such as [[1, 0, 0], [0, 1, 0], [0, 0, 1]]");
  }
  Eigen::Matrix3d matrix;
  for (Eigen::Index row = 0; row < 3; ++row)
    matrix.row(row) = page.vector(node[row], "rotation").transpose();
  // Three printed digits.
  constexpr double kRotationTolerance = 2e-3;
  const double error =
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kRotationTolerance)) {
    page.refuse(node, "'rotation' has rows that are not perpendicular unit vectors (by " +
                          std::to_string(error) + "); it must be a rotation matrix, without scale");
  }
  if (matrix.determinant() < 0) {
    page.refuse(node,
                "'rotation' is a reflection; it must be a rotation, whose rows are right-handed. "
                "For files with a left-handed frame, negate a column: y: -Y, py: -Fy, ...");
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  // An exact matrix stays as it is.
  constexpr double kRounding = 1e-15;
  return error <= kRounding ? matrix : nearest;
}

Eigen::Isometry3d read_frame(const MappingPage& page, const YAML::Node& node) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  page.read(node, "frame",
            {{"rotation", [&](const auto& value) { frame.linear() = read_rotation(page, value); }},
             {"translation", [&](const auto& value) {
                frame.translation() = page.vector(value, "translation");
              }}});
  return frame;
}

void read_columns(const MappingPage& page, const YAML::Node& node, ColumnNames& columns) {
  if (!node.IsMap()) page.refuse(node, "'columns' must give names to columns, such as px: Fx");
  for (const auto& entry : node) {
    const std::string column = page.text(entry.first, "columns");
    if (!is_known_column(column)) {
      page.refuse(entry.first,
                  "there is no column '" + column +
                      "' to be read; the columns are those of contacts (id,x,y,z,nx,ny,nz) and of "
                      "samples (id,contact,group_id,px,py,pz,ax,ay,az,bx,by,bz,"
                      "on_friction_boundary,slipped,range_map,time,depth,normal_force)");
    }
    if (!columns.emplace(column, page.text(entry.second, column)).second)
      page.refuse(entry.first, "'" + column + "' is there twice; keep one");
  }
}

void read_units(const MappingPage& page, const YAML::Node& node, AcquisitionMapping& mapping) {
  const auto unit = [&](const YAML::Node& at, const char* name, auto&& size_of) {
    return page.at(at, name, [&] { return size_of(page.text(at, name)); });
  };
  page.read(node, "units",
            {{"length",
              [&](const YAML::Node& at) {
                mapping.length = unit(at, "length",
                                      [](const auto& name) { return geometry::unit_length(name); });
              }},
             {"force",
              [&](const YAML::Node& at) {
                mapping.force =
                    unit(at, "force", [](const auto& name) { return unit_force(name); });
              }},
             {"time", [&](const YAML::Node& at) {
                mapping.time = unit(at, "time", [](const auto& name) { return unit_time(name); });
              }}});
}

void read_series(const MappingPage& page, const YAML::Node& node, SeriesOptions& series) {
  MappingPage::Keys keys = {{"tare", [&](const auto& value) {
                               const std::string word = page.text(value, "tare");
                               if (word != "true" && word != "false")
                                 page.refuse(value,
                                             "'tare' is '" + word + "'; it must be true or false");
                               series.tare = word == "true";
                             }}};
  for (const SeriesField& field : kSeriesFields) {
    keys.emplace_back(field.name, [&page, &series, &field](const YAML::Node& value) {
      const double number = page.number(value, field.name);
      page.at(value, "time_series", [&] {
        require(std::string("'") + field.name + "'", number, field.range, field.unit);
        return 0;
      });
      series.*field.field = number;
    });
  }
  page.read(node, "time_series", keys);
}

void read_page(const MappingPage& page, const YAML::Node& root, AcquisitionMapping& mapping) {
  MappingPage::Keys keys = {
      {"columns", [&](const auto& node) { read_columns(page, node, mapping.columns); }},
      {"separator",
       [&](const auto& node) {
         mapping.separator = page.at(node, "separator",
                                     [&] { return separator_from(page.text(node, "separator")); });
       }},
      {"units", [&](const auto& node) { read_units(page, node, mapping); }},
      {"weight", [&](const auto& node) { mapping.weight = page.vector(node, "weight"); }},
      {"frame", [&](const auto& node) { mapping.T_surface_file = read_frame(page, node); }},
      {"time_series", [&](const auto& node) { read_series(page, node, mapping.series); }}};
  for (const FieldText& field : texts_of(fields_of(mapping))) {
    keys.emplace_back(field.name, [&, name = field.name](const YAML::Node& node) {
      try {
        assign(fields_of(mapping), name, page.text(node, name));
      } catch (const FileError&) {
        throw;
      } catch (const InvalidInput& wrong) {
        page.refuse(node, wrong.with_names([&](const auto&) { return "'" + name + "'"; }));
      }
    });
  }
  page.read(root, "a mapping", keys);
}

std::string mapping_text(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw FileError(path.string() + ": there is no such file; expected a mapping file (YAML)");
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.good() && !file.eof()) throw FileError(path.string() + ": cannot be read");
  return text;
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
  const std::string text = mapping_text(path);
  const MappingPage page(path.string());
  AcquisitionMapping mapping;
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsNull()) {
      throw FileError(path.string() +
                      ": the file is empty; it must say what differs, such as columns: {px: Fx}");
    }
    read_page(page, root, mapping);
  } catch (const YAML::Exception& error) {
    throw FileError(path.string() + ": line " + std::to_string(error.mark.line + 1) +
                    ": is not YAML (" + error.msg + "); a mapping has lines such as px: Fx");
  }
  try {
    check_mapping(mapping);
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& wrong) {
    throw FileError(path.string() + ": " + wrong.what());
  }
  return mapping;
}

}  // namespace palpate::probing
