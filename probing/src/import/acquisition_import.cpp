// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_import.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "import/import_columns.h"
#include "palpate/error.h"
#include "palpate/probing/csv.h"
#include "palpate/probing/mat_file.h"

namespace palpate::probing {
namespace {

namespace fs = std::filesystem;

bool is_mat(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".mat";
}

/// Files as tables; a MAT file is read once.
class Tables {
 public:
  std::unique_ptr<TableReader> open(const fs::path& path,
                                    const std::vector<std::string_view>& columns,
                                    const TableLayout& layout) {
    if (!is_mat(path)) return std::make_unique<CsvReader>(path, columns, layout);
    auto found = mat_.find(path);
    if (found == mat_.end()) found = mat_.emplace(path, MatFile(path)).first;
    return std::make_unique<MatReader>(found->second, columns, layout);
  }

 private:
  std::map<fs::path, MatFile> mat_;
};

/// The columns that are asked for, and where.
class ColumnList {
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

/// The layout of one of the tables.
TableLayout layout_of(const AcquisitionMapping& mapping, std::string_view prefix,
                      std::size_t file_number, long long first_row) {
  TableLayout layout{.separator = mapping.separator, .first_row = first_row};
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

/// What a table of presses without drags need not have.
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

/// Units, signs and frame.
class Conversion {
 public:
  explicit Conversion(const AcquisitionMapping& mapping)
      : mapping_(mapping), force_(mapping.forces_on_tool ? -mapping.force : mapping.force) {}

  [[nodiscard]] Eigen::Vector3d position(const Eigen::Vector3d& in_file) const {
    const Eigen::Vector3d p = mapping_.length * in_file;
    return mapping_.T_surface_file ? Eigen::Vector3d(*mapping_.T_surface_file * p) : p;
  }
  [[nodiscard]] Eigen::Vector3d direction(const Eigen::Vector3d& in_file) const {
    return mapping_.T_surface_file ? Eigen::Vector3d(mapping_.T_surface_file->linear() * in_file)
                                   : in_file;
  }
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& in_file) const {
    return direction(force_ * in_file);
  }
  [[nodiscard]] double length(double in_file) const { return mapping_.length * in_file; }
  [[nodiscard]] double force(double in_file) const { return force_ * in_file; }
  [[nodiscard]] double time(double in_file) const { return mapping_.time * in_file; }

 private:
  const AcquisitionMapping& mapping_;
  double force_;
};

/// The place of a row, for messages.
struct RowPlace {
  const fs::path& file;
  std::size_t row = 0;  // from 1

  [[noreturn]] void refuse(const std::string& what) const {
    throw FileError(file.string() + ": row " + std::to_string(row) + ": " + what);
  }
};

Eigen::Vector3d checked_normal(const Eigen::Vector3d& normal, const RowPlace& place) {
  if (std::abs(normal.norm() - 1) > kUnitLengthTolerance) {
    place.refuse("its normal nx,ny,nz has length " + to_text(normal.norm()) +
                 "; it must be a unit vector that points out of the object");
  }
  return normal;
}

/// Contacts that are made of rows or touches.
class ContactMaker {
 public:
  explicit ContactMaker(double same_place) : same_place_(same_place) {}

  /// The contact with this id gets a further place.
  void add(long long id, const Eigen::Vector3d& position, const RowPlace& place) {
    const auto [found, added] = index_.emplace(id, made_.size());
    if (added) made_.push_back({id, position});
    Made& made = made_[found->second];
    const double distance = (position - made.first).norm();
    if (!(distance <= same_place_)) {
      place.refuse("contact " + std::to_string(id) + " is " + to_text(distance) +
                   " mm from where it was before; x,y,z is its place on the undeformed surface, "
                   "the same in all its rows up to same_place (" +
                   to_text(same_place_) + " mm)");
    }
    made.way += position - made.first;
    ++made.places;
  }

  /// The contact at a place; its id.
  long long add(const Eigen::Vector3d& position, const RowPlace& place) {
    const Made* nearest = nullptr;
    double least = same_place_;
    for (const Made& made : made_) {
      const double distance = (made.first - position).norm();
      if (distance > least || (nearest != nullptr && distance == least)) continue;
      least = distance;
      nearest = &made;
    }
    const long long id = nearest ? nearest->id : static_cast<long long>(made_.size()) + 1;
    add(id, position, place);
    return id;
  }

  /// \param normal outwards, or the negative force
  void add_normal(long long id, const Eigen::Vector3d& normal) {
    Made& made = made_[index_.at(id)];
    if (made.normals == 0) made.first_normal = normal;
    made.turned += normal - made.first_normal;
    made.lengths += normal.norm();
    ++made.normals;
  }

  /// \throws InvalidInput if the normals of a contact cancel.
  [[nodiscard]] std::vector<Contact> contacts() const {
    std::vector<Contact> result;
    for (const Made& made : made_) {
      const Eigen::Vector3d sum = made.normals * made.first_normal + made.turned;
      constexpr double kCancelled = 0.5;  // sum over the sum of lengths
      if (!(sum.norm() > kCancelled * made.lengths)) {
        throw InvalidInput("contact " + std::to_string(made.id) +
                           ": its normals, or the forces from which they are made, point in "
                           "different directions; give nx,ny,nz, one direction a contact");
      }
      // Equal normals stay as they are in the file.
      const bool as_given =
          made.turned.isZero(0) && std::abs(made.first_normal.norm() - 1) <= kUnitLengthTolerance;
      result.push_back({made.id, made.first + made.way / made.places,
                        as_given ? made.first_normal : Eigen::Vector3d(sum.normalized())});
    }
    return result;
  }

 private:
  struct Made {
    long long id = 0;
    Eigen::Vector3d first;                          // [mm] first place
    Eigen::Vector3d way = Eigen::Vector3d::Zero();  // sum of the places, from the first one
    double places = 0;
    Eigen::Vector3d first_normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();  // sum of the normals, from the first one
    double lengths = 0;                                // sum of their lengths
    double normals = 0;
  };
  double same_place_;
  std::vector<Made> made_;
  std::map<long long, std::size_t> index_;
};

std::vector<Contact> read_contacts(TableReader& row, const Conversion& convert) {
  std::vector<Contact> contacts;
  while (row.next())
    contacts.push_back(
        {row.integer(0), convert.position(row.vector(1)), convert.direction(row.vector(4))});
  return contacts;
}

/// Reads samples whose contacts are in a table or in the same rows.
class SampleRows {
 public:
  SampleRows(const AcquisitionMapping& mapping, const Conversion& convert)
      : mapping_(mapping),
        convert_(convert),
        one_table_(mapping.contacts != ContactSource::table),
        maker_(mapping.same_place) {
    rest_ = columns_.add({"id", "group_id"});
    if (mapping.contacts != ContactSource::place) contact_ = columns_.add({"contact"});
    if (mapping.columns.contains(kNormalForceColumn))
      normal_force_ = columns_.add({kNormalForceColumn});
    else
      force_ = columns_.add({"px", "py", "pz"});
    if (mapping.columns.contains(kDepthColumn))
      depth_ = columns_.add({kDepthColumn});
    else
      tool_ = columns_.add({"ax", "ay", "az", "bx", "by", "bz"});
    marks_ = columns_.add({"on_friction_boundary", "slipped", "range_map", "time"});
    if (one_table_) place_ = columns_.add({"x", "y", "z"});
    if (one_table_ && !mapping.normals_from_forces) normal_ = columns_.add({"nx", "ny", "nz"});
  }

  /// Contacts of a table, which `depth` and `normal_force` refer to.
  void set_contacts(std::vector<Contact> contacts) {
    for (std::size_t i = 0; i < contacts.size(); ++i) known_.emplace(contacts[i].id, i);
    contacts_ = std::move(contacts);
  }

  void read(Tables& tables, const fs::path& file, std::size_t file_number) {
    TableLayout layout = layout_of(mapping_, kSamplesPrefix, file_number,
                                   static_cast<long long>(samples_.size()) + 1);
    if (mapping_.content == RowContent::presses) add_defaults_of_presses(layout);
    const std::unique_ptr<TableReader> row = tables.open(file, columns_.names(), layout);
    for (std::size_t k = 1; row->next(); ++k) samples_.push_back(sample_of(*row, {file, k}));
  }

  [[nodiscard]] Acquisition take() {
    if (one_table_) contacts_ = maker_.contacts();
    return {std::move(contacts_), std::move(samples_), {}};
  }

 private:
  Sample sample_of(const TableReader& row, const RowPlace& place) {
    Sample sample{.id = row.integer(rest_), .group = row.integer(rest_ + 1)};
    if (contact_) sample.contact = row.integer(*contact_);
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    if (one_table_) {
      origin = convert_.position(row.vector(*place_));
      if (normal_) normal = checked_normal(convert_.direction(row.vector(*normal_)), place);
      if (contact_)
        maker_.add(sample.contact, origin, place);
      else
        sample.contact = maker_.add(origin, place);
    } else if (depth_ || normal_force_) {
      const auto known = known_.find(sample.contact);
      if (known == known_.end()) {
        place.refuse("there is no contact " + std::to_string(sample.contact) +
                     "; add the contact or remove the row");
      }
      origin = contacts_[known->second].position;
      normal = contacts_[known->second].normal;
    }
    sample.force = normal_force_
                       ? Eigen::Vector3d(-convert_.force(row.number(*normal_force_)) * normal)
                       : convert_.force(row.vector(*force_));
    if (depth_) {
      sample.a = sample.b = origin - convert_.length(row.number(*depth_)) * normal;
    } else {
      sample.a = convert_.position(row.vector(*tool_));
      sample.b = convert_.position(row.vector(*tool_ + 3));
    }
    if (one_table_)
      maker_.add_normal(sample.contact, normal_ ? normal : Eigen::Vector3d(-sample.force));
    sample.on_friction_boundary = row.flag(marks_);
    sample.slipped = row.flag(marks_ + 1);
    if (std::string name = row.text(marks_ + 2); !name.empty()) sample.range_map = std::move(name);
    sample.time = convert_.time(row.number(marks_ + 3));
    return sample;
  }

  const AcquisitionMapping& mapping_;
  const Conversion& convert_;
  bool one_table_;
  ColumnList columns_;
  std::size_t rest_ = 0, marks_ = 0;
  std::optional<std::size_t> contact_, force_, normal_force_, tool_, depth_, place_, normal_;
  ContactMaker maker_;
  std::vector<Contact> contacts_;
  std::map<long long, std::size_t> known_;
  std::vector<Sample> samples_;
};

/// Reads recordings, and makes contacts and samples of their presses.
class SeriesRows {
 public:
  SeriesRows(const AcquisitionMapping& mapping, const Conversion& convert)
      : mapping_(mapping), convert_(convert), maker_(mapping.same_place) {
    time_ = columns_.add({"time"});
    tip_ = columns_.add({"ax", "ay", "az"});
    if (mapping.columns.contains(kNormalForceColumn))
      normal_force_ = columns_.add({kNormalForceColumn});
    else
      force_ = columns_.add({"px", "py", "pz"});
    if (mapping.contacts == ContactSource::column) contact_ = columns_.add({"contact"});
    if (!mapping.normals_from_forces) normal_ = columns_.add({"nx", "ny", "nz"});
  }

  void read(Tables& tables, const fs::path& file, std::size_t file_number) {
    const std::unique_ptr<TableReader> row =
        tables.open(file, columns_.names(), layout_of(mapping_, kSamplesPrefix, file_number, 1));
    Recording recording;
    long long last = 0;
    for (std::size_t k = 1; row->next(); ++k) {
      const long long contact = contact_ ? row->integer(*contact_) : 0;
      if (!recording.time.empty() && contact != last) {
        finish(recording, last, file);
        recording = {.first_row = k};
      }
      last = contact;
      append(*row, {file, k}, recording);
    }
    finish(recording, last, file);
  }

  [[nodiscard]] Acquisition take() {
    if (samples_.empty()) {
      throw InvalidInput(counts_.presses == 0
                             ? "no press was found: no force exceeds touch_force (" +
                                   to_text(mapping_.series.touch_force) + " N), the largest is " +
                                   to_text(largest_) + " N; check the unit of the forces"
                             : std::to_string(counts_.presses) +
                                   " presses were found, but none is slower than highest_speed (" +
                                   to_text(mapping_.series.highest_speed) +
                                   " mm/s) for sample_time (" +
                                   to_text(mapping_.series.sample_time) +
                                   " s); check the units of lengths and "
                                   "times");
    }
    for (Sample& sample : samples_) sample.time -= earliest_;
    return {maker_.contacts(), std::move(samples_), {}};
  }
  [[nodiscard]] const SeriesCounts& counts() const { return counts_; }

 private:
  struct Recording {
    std::size_t first_row = 1;
    std::vector<double> time = {};
    std::vector<Eigen::Vector3d> tip = {}, force = {}, normal = {};
    std::vector<bool> saturated = {};
  };

  void append(const TableReader& row, const RowPlace& place, Recording& recording) {
    const double limit = mapping_.series.saturation;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    if (normal_) normal = checked_normal(convert_.direction(row.vector(*normal_)), place);
    recording.time.push_back(convert_.time(row.number(time_)));
    recording.tip.push_back(convert_.position(row.vector(tip_)));
    recording.normal.push_back(normal);
    if (normal_force_) {
      const double force = row.number(*normal_force_);
      recording.force.emplace_back(-convert_.force(force) * normal);
      recording.saturated.push_back(mapping_.force * std::abs(force) >= limit);
    } else {
      const Eigen::Vector3d force = row.vector(*force_);
      recording.force.push_back(convert_.force(force));
      recording.saturated.push_back(mapping_.force * force.cwiseAbs().maxCoeff() >= limit);
    }
    largest_ = std::max(largest_, recording.force.back().norm());
  }

  [[nodiscard]] SeriesPresses presses_of(const Recording& recording, const fs::path& file) const {
    const auto count = static_cast<Eigen::Index>(recording.time.size());
    TipSeries series{recording.time, Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count),
                     recording.saturated};
    for (Eigen::Index i = 0; i < count; ++i) {
      series.tip.col(i) = recording.tip[static_cast<std::size_t>(i)];
      series.force.col(i) = recording.force[static_cast<std::size_t>(i)];
    }
    try {
      return find_presses(series, mapping_.series);
    } catch (const InvalidInput& wrong) {
      throw FileError(file.string() + ", recording from row " +
                      std::to_string(recording.first_row) + " on: " + wrong.what());
    }
  }

  void finish(const Recording& recording, long long contact, const fs::path& file) {
    if (recording.time.empty()) return;
    const SeriesPresses found = presses_of(recording, file);
    counts_.presses += found.presses.size();
    counts_.saturated += found.saturated;
    counts_.unpaired += found.unpaired;
    counts_.fast += found.fast;
    counts_.brief += found.brief;
    earliest_ = std::min(earliest_, recording.time.front());
    for (const SeriesPress& press : found.presses) {
      if (press.held.empty()) {
        ++counts_.empty_presses;
        continue;
      }
      const RowPlace place{file, recording.first_row + press.begin};
      long long id = contact;
      if (contact_)
        maker_.add(id, press.touch, place);
      else
        id = maker_.add(press.touch, place);
      if (normal_) maker_.add_normal(id, recording.normal[press.begin]);
      for (const HeldPress& held : press.held) {
        if (!normal_) maker_.add_normal(id, -held.force);
        const auto number = static_cast<long long>(samples_.size()) + 1;
        Sample& sample = samples_.emplace_back();
        sample.id = sample.group = number;
        sample.contact = id;
        sample.force = held.force;
        sample.a = sample.b = held.tip;
        sample.time = held.time;
      }
    }
  }

  const AcquisitionMapping& mapping_;
  const Conversion& convert_;
  ColumnList columns_;
  std::size_t time_ = 0, tip_ = 0;
  std::optional<std::size_t> force_, normal_force_, contact_, normal_;
  ContactMaker maker_;
  std::vector<Sample> samples_;
  SeriesCounts counts_;
  double earliest_ = std::numeric_limits<double>::infinity();
  double largest_ = 0;
};

void check_combination(std::span<const fs::path> files, const AcquisitionMapping& mapping) {
  check_mapping(mapping);
  if (files.empty())
    throw InvalidInput("import_acquisition(): there is no file; give at least one");
  const bool has_depth = mapping.columns.contains(kDepthColumn);
  if (has_depth && mapping.content == RowContent::presses_and_drags)
    throw InvalidInput(
        "AcquisitionMapping::columns: 'depth' is that of a press without a drag; the content must "
        "be presses");
  if (has_depth && mapping.content == RowContent::time_series)
    throw InvalidInput(
        "AcquisitionMapping::columns: a time series has the position of the tip in ax,ay,az, not a "
        "depth");
  if (has_depth && mapping.normals_from_forces)
    throw InvalidInput(
        "AcquisitionMapping::columns: 'depth' is along the normal, so that normals cannot come "
        "from the forces; give nx,ny,nz");
  if (mapping.contacts != ContactSource::table) return;
  if (mapping.content == RowContent::time_series)
    throw InvalidInput(
        "AcquisitionMapping::contacts: the contacts of a time series are made from its touches: "
        "contacts must be place, or column if a column says which contact it is");
  if (files.size() > 2 || (files.size() == 1 && !is_mat(files[0]))) {
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
  const Conversion convert(mapping);
  Tables tables;
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
    return {CheckedAcquisition(read()), counts};
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw FileError(names_of(files) + ": " + error.what());
  }
}

}  // namespace palpate::probing
