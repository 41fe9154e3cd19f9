// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_csv.h"

#include <algorithm>
#include <array>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include "palpate/error.h"
#include "palpate/output_file.h"
#include "palpate/probing/csv.h"
#include "palpate/require.h"

namespace palpate::probing {
namespace {

constexpr std::array<std::string_view, 7> kContactColumns = {"id", "x", "y", "z", "nx", "ny", "nz"};
constexpr std::array<std::string_view, 16> kSampleColumns = {"id",
                                                             "contact",
                                                             "group_id",
                                                             "px",
                                                             "py",
                                                             "pz",
                                                             "ax",
                                                             "ay",
                                                             "az",
                                                             "bx",
                                                             "by",
                                                             "bz",
                                                             "on_friction_boundary",
                                                             "slipped",
                                                             "range_map",
                                                             "time"};

const std::string kContactsPrefix = "contacts.", kSamplesPrefix = "samples.";

/// The layout of one of the two files.
CsvLayout layout_of(const AcquisitionCsvOptions& options, const std::string& prefix) {
  CsvLayout layout{.separator = options.separator};
  for (const auto& [column, name] : options.names) {
    const bool of_this_file = column.starts_with(prefix);
    if (of_this_file)
      layout.names[column.substr(prefix.size())] = name;
    else
      layout.names.try_emplace(column, name);
  }
  return layout;
}

void check_names(const AcquisitionCsvOptions& options) {
  for (const auto& [column, name] : options.names) {
    if (column == kContactsPrefix + "id" || column == kSamplesPrefix + "id" ||
        std::ranges::find(kContactColumns, column) != kContactColumns.end() ||
        std::ranges::find(kSampleColumns, column) != kSampleColumns.end())
      continue;
    throw InvalidInput("AcquisitionCsvOptions::names: there is no column '" + column +
                       "' to be read; the columns are those of contacts (id,x,y,z,nx,ny,nz) and of "
                       "samples (id,contact,group_id,px,py,pz,ax,ay,az,bx,by,bz,"
                       "on_friction_boundary,slipped,range_map,time)");
  }
}

std::vector<Contact> read_contacts(const std::filesystem::path& path,
                                   const AcquisitionCsvOptions& options) {
  CsvReader row(path, kContactColumns, layout_of(options, kContactsPrefix));
  std::vector<Contact> contacts;
  while (row.next())
    contacts.push_back({row.integer(0), options.length * row.vector(1), row.vector(4)});
  return contacts;
}

std::vector<Sample> read_samples(const std::filesystem::path& path,
                                 const AcquisitionCsvOptions& options) {
  CsvReader row(path, kSampleColumns, layout_of(options, kSamplesPrefix));
  const double force = options.forces_on_tool ? -options.force : options.force;
  std::vector<Sample> samples;
  while (row.next()) {
    std::string range_map = row.text(14);
    samples.push_back(
        {.id = row.integer(0),
         .contact = row.integer(1),
         .group = row.integer(2),
         .force = force * row.vector(3),
         .a = options.length * row.vector(6),
         .b = options.length * row.vector(9),
         .on_friction_boundary = row.flag(12),
         .slipped = row.flag(13),
         .range_map = range_map.empty() ? std::nullopt : std::optional(std::move(range_map)),
         .time = row.number(15)});
  }
  return samples;
}

void write_vector(std::ostream& out, const Eigen::Vector3d& v) {
  for (const double value : v) out << ',' << to_text(value);
}

std::string range_map_cell(const Sample& sample) { return to_cell(sample.range_map.value_or("")); }

void write_contacts(std::ostream& out, const std::vector<Contact>& contacts) {
  write_csv_header(out, kContactColumns);
  for (const Contact& contact : contacts) {
    out << to_text(contact.id);
    write_vector(out, contact.position);
    write_vector(out, contact.normal);
    out << '\n';
  }
}

void write_samples(std::ostream& out, const std::vector<Sample>& samples) {
  write_csv_header(out, kSampleColumns);
  for (const Sample& sample : samples) {
    out << to_text(sample.id) << ',' << to_text(sample.contact) << ',' << to_text(sample.group);
    write_vector(out, sample.force);
    write_vector(out, sample.a);
    write_vector(out, sample.b);
    out << ',' << sample.on_friction_boundary << ',' << sample.slipped << ','
        << range_map_cell(sample) << ',' << to_text(sample.time) << '\n';
  }
}

}  // namespace

double unit_force(std::string_view name) {
  constexpr double kGravity = 9.80665;   // [m/s^2] standard gravity
  constexpr double kPound = 0.45359237;  // [kg]
  constexpr std::array<std::pair<std::string_view, double>, 6> kUnits = {
      {{"N", 1},
       {"mN", 1e-3},
       {"kN", 1e3},
       {"g", 1e-3 * kGravity},
       {"kg", kGravity},
       {"lbf", kPound * kGravity}}};
  for (const auto& [unit, force] : kUnits) {
    if (unit == name) return force;
  }
  throw InvalidInput("unit \"" + std::string(name) +
                     "\" is not known; use N, mN, kN, g, kg or lbf");
}

CheckedAcquisition read_acquisition_csv(const std::filesystem::path& contacts,
                                        const std::filesystem::path& samples,
                                        const AcquisitionCsvOptions& options) {
  require("AcquisitionCsvOptions::length", options.length, above(0).finite(), "mm");
  require("AcquisitionCsvOptions::force", options.force, above(0).finite(), "N");
  check_names(options);
  Acquisition acquisition{read_contacts(contacts, options), read_samples(samples, options), {}};
  try {
    return CheckedAcquisition(std::move(acquisition));
  } catch (const InvalidInput& error) {
    throw FileError(contacts.string() + " and " + samples.string() + ": " + error.what());
  }
}

void write_acquisition_csv(const CheckedAcquisition& acquisition,
                           const std::filesystem::path& contacts,
                           const std::filesystem::path& samples) {
  for (const Sample& sample : acquisition.samples()) static_cast<void>(range_map_cell(sample));
  write_file(contacts, [&](std::ostream& out) { write_contacts(out, acquisition.contacts()); });
  write_file(samples, [&](std::ostream& out) { write_samples(out, acquisition.samples()); });
}

}  // namespace palpate::probing
