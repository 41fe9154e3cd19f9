// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/left_out_contact.h"

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "build/interpolated_as.h"
#include "build/without_contact.h"
#include "palpate/core/error.h"

namespace palpate::haptics {

namespace {

std::span<const geometry::SurfacePoint> checked(const Model& model,
                                                std::span<const geometry::SurfacePoint> points) {
  if (points.size() == model.contacts.size()) return points;
  throw InvalidInput("LeftOutModels: the model has " + std::to_string(model.contacts.size()) +
                     " contacts, but there are " + std::to_string(points.size()) + " points");
}

}  // namespace

LeftOutModels::LeftOutModels(const Model& model, std::span<const geometry::SurfacePoint> points)
    : model_(model),
      triangulations_(model.surface, checked(model, points), {.method = model.triangulation}) {}

Model LeftOutModels::without(std::size_t contact) const {
  return interpolated_as(without_contact(model_, triangulations_, contact), model_.interpolation);
}

std::vector<bool> border_contacts(const Model& model) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : model.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) ++uses[std::minmax({t[k], t[(k + 1) % 3]})];
  }
  std::vector<bool> border(model.contacts.size(), false);
  for (const auto& [edge, count] : uses) {
    if (count > 1) continue;
    border[static_cast<std::size_t>(edge.first)] = true;
    border[static_cast<std::size_t>(edge.second)] = true;
  }
  return border;
}

}  // namespace palpate::haptics
