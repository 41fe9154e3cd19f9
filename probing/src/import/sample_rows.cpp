// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/sample_rows.h"

#include <memory>
#include <string>
#include <utility>

#include "import/import_columns.h"

namespace palpate::probing {

SampleRows::SampleRows(const AcquisitionMapping& mapping, const ImportConversion& convert)
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

void SampleRows::set_contacts(std::vector<Contact> contacts) {
  for (std::size_t i = 0; i < contacts.size(); ++i) known_.emplace(contacts[i].id, i);
  contacts_ = std::move(contacts);
}

void SampleRows::read(ImportTables& tables, const std::filesystem::path& file,
                      std::size_t file_number) {
  TableLayout layout =
      layout_of(mapping_, kSamplesPrefix, file_number, static_cast<long long>(samples_.size()) + 1);
  if (mapping_.content == RowContent::presses) add_defaults_of_presses(layout);
  const std::unique_ptr<TableReader> row = tables.open(file, columns_.names(), layout);
  for (std::size_t k = 1; row->next(); ++k) samples_.push_back(sample_of(*row, {file, k}));
}

Acquisition SampleRows::take() {
  if (one_table_) contacts_ = maker_.contacts();
  return {std::move(contacts_), std::move(samples_), {}};
}

Sample SampleRows::sample_of(const TableReader& row, const RowPlace& place) {
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
  sample.force = normal_force_ ? convert_.normal_force(row.number(*normal_force_), normal)
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

}  // namespace palpate::probing
