// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/report_stiffness.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "palpate/pictures/draw_stiffness.h"

namespace palpate::apps {
namespace {

constexpr std::size_t kFewestForMap = 8;

std::string caption_of(const ReportedStiffness& stiffness) {
  const probing::StiffnessMap& map = stiffness.map;
  std::string text = fmt::format(
      "Stiffness: a normal force of {:.3g} N over the depth to which it presses, interpolated "
      "between {} contacts. Grey: no contact is near. Half of the surface is softer than {:.3g} "
      "N/mm; the stiffest contact has {:.3g} ± {:.2g} N/mm. ",
      stiffness.force, stiffness.contacts.size(), map.soft, map.stiff, map.stiff_deviation);
  if (!map.distinct)
    return text + "This is within three standard deviations, so no contour is drawn.";
  return text +
         fmt::format(
             "The contour encloses {:.0f} mm² that are stiffer than {:.3g} N/mm, midway between "
             "the two. It shows where the object feels stiffer, for whatever reason: a stiff part, "
             "a support, or a thin place. The outline of a deep part is blurred.",
             map.area, map.threshold);
}

}  // namespace

std::optional<ReportedStiffness> reported_stiffness(const probing::CheckedAcquisition& acquisition,
                                                    const geometry::TriangleMesh& surface,
                                                    const probing::PressNoise& noise) {
  const double force = probing::common_press_force(acquisition);
  if (!(force > 0)) return std::nullopt;
  ReportedStiffness result{force, probing::contact_stiffness(acquisition, force, noise), {}};
  if (result.contacts.size() < kFewestForMap) return std::nullopt;
  result.map = probing::stiffness_map(surface, result.contacts);
  return result;
}

Json stiffness_figures(const std::optional<ReportedStiffness>& stiffness) {
  if (!stiffness) return nullptr;
  const probing::StiffnessMap& map = stiffness->map;
  return {{"force", stiffness->force},
          {"contacts", stiffness->contacts.size()},
          {"soft", map.soft},
          {"stiff", map.stiff},
          {"stiff_deviation", map.stiff_deviation},
          {"stiffest", numbers_in(map.stiffest)},
          {"threshold", map.threshold},
          {"distinct", map.distinct},
          {"area", map.area}};
}

void add_stiffness(ReportPage& page, const fs::path& folder, const geometry::TriangleMesh& surface,
                   const std::optional<ReportedStiffness>& stiffness) {
  if (!stiffness) return;
  pictures::StiffnessPicture picture{.stiffness = stiffness->map.stiffness,
                                     .contacts = {},
                                     .contour = stiffness->map.contour,
                                     .title = "Stiffness along the surface",
                                     .subtitle = {}};
  picture.subtitle =
      stiffness->map.distinct
          ? fmt::format("under {:.3g} N; contour at {:.3g} N/mm", stiffness->force,
                        stiffness->map.threshold)
          : fmt::format("under {:.3g} N; no place is distinctly stiffer", stiffness->force);
  picture.contacts.resize(3, static_cast<Eigen::Index>(stiffness->contacts.size()));
  for (Eigen::Index i = 0; i < picture.contacts.cols(); ++i)
    picture.contacts.col(i) = stiffness->contacts[static_cast<std::size_t>(i)].position;
  page.add_heading("Stiffness");
  pictures::draw_stiffness(folder / kStiffnessPicture, surface, picture);
  page.add_picture(kStiffnessPicture, caption_of(*stiffness));
}

}  // namespace palpate::apps
