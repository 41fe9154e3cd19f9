// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_csv.h"

#include <array>
#include <ostream>
#include <string>
#include <vector>

#include "import/import_columns.h"
#include "palpate/core/output_file.h"
#include "palpate/probing/acquisition_import.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {
namespace {

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

CheckedAcquisition read_acquisition_csv(const std::filesystem::path& contacts,
                                        const std::filesystem::path& samples) {
  const std::array files = {contacts, samples};
  return import_acquisition(files).acquisition;
}

void write_acquisition_csv(const CheckedAcquisition& acquisition,
                           const std::filesystem::path& contacts,
                           const std::filesystem::path& samples) {
  for (const Sample& sample : acquisition.samples()) static_cast<void>(range_map_cell(sample));
  write_file(contacts, [&](std::ostream& out) { write_contacts(out, acquisition.contacts()); });
  write_file(samples, [&](std::ostream& out) { write_samples(out, acquisition.samples()); });
}

}  // namespace palpate::probing
