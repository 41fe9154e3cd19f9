// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/series_rows.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "import/import_columns.h"
#include "import/press_samples.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {

SeriesRows::SeriesRows(const AcquisitionMapping& mapping, const ImportConversion& convert)
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

void SeriesRows::read(ImportTables& tables, const std::filesystem::path& file,
                      std::size_t file_number) {
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

Acquisition SeriesRows::take() {
  if (samples_.empty() && counts_.presses == 0) {
    throw InvalidInput("no press was found: no force exceeds touch_force (" +
                       to_text(mapping_.series.touch_force) + " N), the largest is " +
                       to_text(largest_) + " N; check the unit of the forces");
  }
  if (samples_.empty() && counts_.slides == counts_.presses) {
    throw InvalidInput(std::to_string(counts_.presses) +
                       " presses were found, but in each of them the tip slid along the surface "
                       "before it was held; lift it between two contacts, or see slide_length (" +
                       to_text(mapping_.series.slide_length) + " mm)");
  }
  if (samples_.empty()) {
    throw InvalidInput(std::to_string(counts_.presses) +
                       " presses were found, but none is slower than highest_speed (" +
                       to_text(mapping_.series.highest_speed) + " mm/s) for sample_time (" +
                       to_text(mapping_.series.sample_time) +
                       " s); check the units of lengths and times");
  }
  for (Sample& sample : samples_) sample.time -= earliest_;
  return {maker_.contacts(), std::move(samples_), {}};
}

void SeriesRows::append(const TableReader& row, const RowPlace& place, Recording& recording) {
  const double limit = mapping_.series.saturation;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  if (normal_) normal = checked_normal(convert_.direction(row.vector(*normal_)), place);
  recording.time.push_back(convert_.time(row.number(time_)));
  recording.tip.push_back(convert_.position(row.vector(tip_)));
  recording.normal.push_back(normal);
  if (normal_force_) {
    const double force = row.number(*normal_force_);
    recording.force.push_back(convert_.normal_force(force, normal));
    recording.saturated.push_back(mapping_.force * std::abs(force) >= limit);
  } else {
    const Eigen::Vector3d force = row.vector(*force_);
    recording.force.push_back(convert_.force(force));
    recording.saturated.push_back(mapping_.force * force.cwiseAbs().maxCoeff() >= limit);
  }
  largest_ = std::max(largest_, recording.force.back().norm());
}

SeriesPresses SeriesRows::presses_of(const Recording& recording,
                                     const std::filesystem::path& file) const {
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
    throw FileError(file.string() + ", recording from row " + std::to_string(recording.first_row) +
                    " on: " + wrong.what());
  }
}

void SeriesRows::finish(const Recording& recording, long long contact,
                        const std::filesystem::path& file) {
  if (recording.time.empty()) return;
  const SeriesPresses found = presses_of(recording, file);
  counts_.presses += found.presses.size();
  counts_.saturated += found.saturated;
  counts_.unpaired += found.unpaired;
  counts_.fast += found.fast;
  counts_.brief += found.brief;
  earliest_ = std::min(earliest_, recording.time.front());
  for (const SeriesPress& press : found.presses)
    add_press(press, recording, contact, {file, recording.first_row + press.begin});
}

void SeriesRows::add_press(const SeriesPress& press, const Recording& recording, long long contact,
                           const RowPlace& place) {
  if (press.slid) ++counts_.slides;
  PressSamples found = samples_of_press(press, mapping_.series.touch_force);
  counts_.drags_without_base += found.drags_without_base;
  if (found.samples.empty()) {
    ++counts_.empty_presses;
    return;
  }
  if (std::isfinite(press.depth_deviation)) {
    depths_.push_back(press.depth);
    deviations_.push_back(press.depth_deviation);
  } else {
    ++counts_.not_extrapolated;
  }
  long long id = contact;
  if (contact_)
    maker_.add(id, press.touch, place);
  else
    id = maker_.add(press.touch, place);
  if (normal_) maker_.add_normal(id, recording.normal[press.begin]);
  for (std::size_t i = 0; i < found.samples.size(); ++i) {
    Sample& sample = samples_.emplace_back(std::move(found.samples[i]));
    if (found.dragged[i] && !sample.slipped) ++counts_.drags;
    // Drags turn the force, but not the normal.
    if (!normal_ && !found.dragged[i]) maker_.add_normal(id, -sample.force);
    sample.id = sample.group = static_cast<long long>(samples_.size());
    sample.contact = id;
  }
}

SeriesCounts SeriesRows::counts() const {
  SeriesCounts counts = counts_;
  if (!depths_.empty()) {
    counts.touch_depth = median(depths_);
    counts.touch_deviation = median(deviations_);
  }
  return counts;
}

}  // namespace palpate::probing
