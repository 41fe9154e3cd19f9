// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/cloud_step_notes.h"

#include <fmt/format.h>

#include "palpate/core/error.h"
#include "palpate/geometry/cloud_selection.h"

namespace palpate::apps {

Eigen::Index known_count(const geometry::PointCloud& cloud) {
  Eigen::Index known = 0;
  for (const auto& point : cloud.points.colwise()) known += point.allFinite() ? 1 : 0;
  return known;
}

void note_step(WorkedCloud& worked, const std::string& name, Eigen::Index known_before,
               const Json& figures, const std::string& words) {
  const Eigen::Index known = known_count(worked.cloud);
  Json note = {{"step", name}, {"known", known}, {"removed", known_before - known}};
  note.update(figures);
  worked.steps.push_back(std::move(note));
  worked.prose += known == known_before ? fmt::format("{}: {}\n", name, words)
                                        : fmt::format("{}: {} of {} points left, {}\n", name, known,
                                                      known_before, words);
}

void keep_only(WorkedCloud& worked, const std::string& name, const std::vector<int>& kept,
               const std::string& words) {
  const Eigen::Index before = known_count(worked.cloud);
  if (kept.empty())
    throw InvalidInput(fmt::format("--{}: none of the {} points is {}, so nothing would be left",
                                   name, before, words));
  worked.cloud = worked.cloud.height > 1 ? geometry::with_only(worked.cloud, kept)
                                         : geometry::selected(worked.cloud, kept);
  worked.found_what.clear();
  note_step(worked, name, before, Json::object(), words);
}

}  // namespace palpate::apps
