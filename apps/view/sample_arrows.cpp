// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "sample_arrows.h"

#include <cmath>
#include <map>

#include "palpate/haptics/blended_field.h"

namespace palpate::view {

std::vector<SampleArrow> sample_arrows(const probing::CheckedAcquisition& acquisition,
                                       const haptics::Model* model) {
  std::optional<haptics::BlendedField> field;
  std::map<long long, Eigen::Vector3d> places;  // of the model's contacts, by id
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (model != nullptr) {
    field.emplace(*model);
    rotation = model->T_surface_acquisition.linear();
    for (const haptics::ContactModel& contact : model->contacts)
      places[contact.id] = contact.position;
  }
  std::vector<SampleArrow> arrows;
  for (std::size_t c = 0; c < acquisition.contacts().size(); ++c) {
    const probing::Contact& contact = acquisition.contacts()[c];
    const haptics::ForceSamples pairs = haptics::realign(contact, acquisition.samples_of(c));
    const auto place = places.find(contact.id);
    std::optional<haptics::Blend> blend;
    if (place != places.end()) blend = field->blend(place->second);
    for (Eigen::Index i = 0; i < pairs.forces.cols(); ++i) {
      const Eigen::Vector3d displacement = pairs.displacements.col(i);
      SampleArrow arrow{.contact = c,
                        .tool = contact.position + displacement,
                        .force = pairs.forces.col(i),
                        .kind = pairs.kinds[static_cast<std::size_t>(i)]};
      if (blend) {
        const Eigen::Vector3d force = field->force(*blend, rotation * displacement);
        arrow.residual = (force - rotation * arrow.force).norm();
      }
      arrows.push_back(arrow);
    }
  }
  return arrows;
}

std::optional<double> residual_rms(const std::vector<SampleArrow>& arrows) {
  double sum = 0;
  long count = 0;
  for (const SampleArrow& arrow : arrows) {
    if (!arrow.residual) continue;
    sum += *arrow.residual * *arrow.residual;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(sum / static_cast<double>(count));
}

}  // namespace palpate::view
