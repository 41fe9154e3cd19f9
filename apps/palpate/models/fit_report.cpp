// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/fit_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "palpate/geometry/error_statistics.h"
#include "shared/command_line.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

constexpr std::size_t kNamedContacts = 50;  // largest number of contacts named per reason

/// Reports the contacts without friction of their own, one line per reason.
void tell_friction(const haptics::BuildResult& built) {
  std::map<haptics::FrictionStop, std::vector<long long>> undetermined;
  bool from_others = false, bounded = false;
  for (std::size_t i = 0; i < built.contacts.size(); ++i) {
    const haptics::FrictionFit& friction = built.contacts[i].friction;
    if (friction.stop == haptics::FrictionStop::converged) continue;
    undetermined[friction.stop].push_back(built.contacts[i].id);
    const haptics::FrictionSource source = built.model.contacts[i].friction_source;
    from_others = from_others || source == haptics::FrictionSource::other_contacts;
    bounded = bounded || source == haptics::FrictionSource::lower_bound;
  }
  for (const auto& [stop, contacts] : undetermined) {
    if (contacts.size() == built.contacts.size()) {
      spdlog::warn("no contact determines its friction ({}).", in_words(stop));
    } else {
      spdlog::warn("{} of {} contacts do not determine their friction ({}): {}", contacts.size(),
                   built.contacts.size(), in_words(stop), contacts_in_words(contacts));
    }
  }
  if (built.friction_load) {
    const haptics::FrictionLoadEstimate& found = *built.friction_load;
    spdlog::info(
        "friction depends on the load: coefficients hold at a normal force of {:.3g} N and change "
        "with its power {:.3f} +- {:.3f}.",
        found.load.force, found.load.exponent, found.exponent_error);
  }
  if (from_others) spdlog::warn("some of these use the mean friction of the other contacts.");
  if (haptics::unknown_friction_count(built.model) > 0) {
    spdlog::warn(
        "the friction of the model is unknown: palpate play lets the tool slide without friction, "
        "or with the coefficient of --unknown-friction.");
  }
  if (bounded) spdlog::warn("some of these use a lower bound; their true friction may be larger.");
}

std::string friction_of(const haptics::ContactModel& contact) {
  if (haptics::has_unknown_friction(contact)) return "unknown";
  if (contact.friction_source == haptics::FrictionSource::lower_bound)
    return fmt::format(">= {:.3f}", contact.friction);
  const std::string error =
      contact.friction_error ? fmt::format(" +- {:.3f}", *contact.friction_error) : "";
  return fmt::format("{:.3f}{} (>= {:.3f})", contact.friction, error, contact.friction_lower_bound);
}

Json contradictions_of(const haptics::ContactReport& contact) {
  return contact.friction_contradictions ? Json(*contact.friction_contradictions) : Json();
}

/// Error with the local part relative to that without, at sparse contacts.
double ratio(const haptics::LocalPart& part) { return std::exp(*part.gain); }

void tell_sharing(const haptics::BuildResult& built) {
  if (!built.local_part) return;
  if (built.local_part->outcome == haptics::SharingOutcome::shared) {
    spdlog::info("of the contacts, {}.", sharing_in_words(built));
  } else {
    spdlog::warn("each contact is fitted on its own; {}.", sharing_in_words(built));
  }
}

Json sharing_in_figures(const haptics::BuildResult& built) {
  const haptics::LocalPart& part = *built.local_part;
  return {{"outcome", haptics::to_string(part.outcome)},
          {"dense_samples", part.dense_samples},
          {"dense", part.dense},
          {"sparse", part.sparse},
          {"gain", number_or_null(part.gain)},
          {"gain_error", number_or_null(part.gain_error)}};
}

void tell_pressing(const haptics::BuildResult& built) {
  if (!built.pressing) return;
  const haptics::PressingEstimate& found = *built.pressing;
  const haptics::PressingOffsets& offsets = found.offsets;
  spdlog::info("all contacts were only pressed; the force noise is {:.3g} N ({}).",
               found.force_noise, found.noise_was_estimated ? "estimated" : "as told");
  if (offsets.force_found) {
    const std::string where =
        offsets.along_direction ? "along the pressing direction" : "in the world frame";
    spdlog::info("the force sensor has an offset of ({:.4g}, {:.4g}, {:.4g}) N {}, +- {:.2g} N.",
                 offsets.force.x(), offsets.force.y(), offsets.force.z(), where,
                 offsets.force_error.maxCoeff());
  }
  if (offsets.touch_found) {
    spdlog::info(
        "the touches lie {:.3f} +- {:.3f} mm below the true surface on average, with a standard "
        "deviation of {:.3f} mm.",
        offsets.touch, offsets.touch_error, offsets.touch_spread);
  }
  if (offsets.height_slope != 0) {
    spdlog::info("of a touch's depth below the surface as given, {:.2f} +- {:.2f} is true.",
                 offsets.height_slope, offsets.height_slope_error);
  }
  if (offsets.hysteresis > 0) {
    spdlog::warn(
        "on the way back the forces are {:.1f} +- {:.1f} % less than on the way in, which the "
        "model follows.",
        100 * offsets.hysteresis, 100 * offsets.hysteresis_error);
  }
}

void tell_rate(const haptics::BuildResult& built) {
  if (!built.rate) return;
  const haptics::RateFit& found = *built.rate;
  if (found.terms.empty()) {
    spdlog::warn("the {} samples show no dependence of the forces on the rate.", found.samples);
    return;
  }
  for (std::size_t i = 0; i < found.terms.size(); ++i) {
    spdlog::info(
        "right after a motion, {:.1f} +- {:.1f} % of the force comes on top, which fades in "
        "{:.3g} +- {:.2g} s.",
        100 * found.terms[i].share, 100 * found.errors[i].share, found.terms[i].time,
        found.errors[i].time);
  }
  spdlog::info("with the rate the error is {}, without it {} (RMS).", newtons(found.rms),
               newtons(found.rms_without));
}

Json rate_in_figures(const haptics::RateFit& found) {
  Json terms = Json::array();
  for (std::size_t i = 0; i < found.terms.size(); ++i) {
    terms.push_back({{"share", found.terms[i].share},
                     {"share_error", found.errors[i].share},
                     {"time", found.terms[i].time},
                     {"time_error", found.errors[i].time}});
  }
  return {{"terms", terms}, {"rms", found.rms}, {"rms_without", found.rms_without}};
}

Json pressing_in_figures(const haptics::PressingEstimate& found) {
  Json figures = {{"force_noise", found.force_noise},
                  {"noise_estimated", found.noise_was_estimated}};
  figures.update(offsets_in_figures(found.offsets));
  figures["lateral_ratio"] = found.lateral_ratio;
  figures["lateral_ratio_error"] = found.lateral_ratio_error;
  return figures;
}

geometry::ErrorStatistics rms_of(const haptics::BuildResult& built) {
  std::vector<double> rms;
  for (const haptics::ContactModel& contact : built.model.contacts) rms.push_back(contact.rms);
  return geometry::error_statistics(rms);
}

Json uncertainty_of(const haptics::ContactModel& contact) {
  if (!contact.uncertainty) return {};
  const haptics::ContactUncertainty& own = *contact.uncertainty;
  return {{"force", own.force},
          {"displacement", own.displacement},
          {"across", own.across},
          {"between", own.between}};
}

/// The figures of one contact.
Json contact_figures(const haptics::ContactModel& contact, const haptics::ContactReport& report) {
  const haptics::FitResult& found = report.fit;
  return {{"contact", contact.id},
          {"rms", contact.rms},
          {"bases", contact.field.bases.size()},
          {"friction", haptics::has_unknown_friction(contact) ? Json() : Json(contact.friction)},
          {"friction_error", number_or_null(contact.friction_error)},
          {"friction_lower_bound", contact.friction_lower_bound},
          {"friction_source", haptics::to_string(contact.friction_source)},
          {"friction_stop", haptics::to_string(report.friction.stop)},
          {"friction_contradictions", contradictions_of(report)},
          {"samples", contact.samples},
          {"stop", haptics::to_string(found.stop)},
          {"passive", haptics::to_string(found.certificate.passivity)},
          {"chi2", found.chi2},
          {"noise_floor", found.noise_floor},
          {"outliers", found.outliers},
          {"condition", number_or_null(found.condition)},
          {"shared_local", contact.shared_local},
          {"unmeasured", found.unmeasured},
          {"uncertainty", uncertainty_of(contact)}};
}

}  // namespace

Json offsets_in_figures(const haptics::PressingOffsets& offsets) {
  return {{"force_offset", numbers_in(offsets.force)},
          {"force_offset_error", numbers_in(offsets.force_error)},
          {"along_pressing", offsets.along_direction},
          {"touch_offset", offsets.touch},
          {"touch_offset_error", offsets.touch_error},
          {"touch_offset_spread", offsets.touch_spread},
          {"surface_slope", offsets.height_slope},
          {"surface_slope_error", offsets.height_slope_error},
          {"hysteresis", offsets.hysteresis},
          {"hysteresis_error", offsets.hysteresis_error}};
}

std::string contacts_in_words(const std::vector<long long>& contacts) {
  const std::span first(contacts.data(), std::min(contacts.size(), kNamedContacts));
  return fmt::format("{}{}", fmt::join(first, ", "), first.size() < contacts.size() ? ", ..." : "");
}

std::string sharing_in_words(const haptics::BuildResult& built) {
  const haptics::LocalPart& part = *built.local_part;
  const std::string counts = fmt::format("{} contacts with at least {} pairs, {} with fewer",
                                         part.dense, part.dense_samples, part.sparse);
  switch (part.outcome) {
    case haptics::SharingOutcome::shared: {
      const auto sharing = std::ranges::count_if(
          built.contacts, [](const auto& contact) { return contact.fit.shared_local; });
      return fmt::format(
          "{} share the local part of the dense ones: {}; errors are {:.2f} times "
          "those without it, +- {:.0f} % (tested at dense contacts)",
          sharing, counts, ratio(part), 100 * *part.gain_error);
    }
    case haptics::SharingOutcome::no_gain:
      return fmt::format(
          "none shares a local part: {}; errors would be {:.2f} times those without it, +- {:.0f} "
          "% (tested at dense contacts), which is not a significant gain",
          counts, ratio(part), 100 * *part.gain_error);
    case haptics::SharingOutcome::too_few_dense:
      return fmt::format(
          "none shares a local part: {}; at least {} must be dense, so probe more "
          "there or lower --dense-samples",
          counts, haptics::kFewestDense);
    case haptics::SharingOutcome::none_sparse:
      return fmt::format("none shares a local part: {}; none needs it", counts);
  }
  return {};
}

void tell_build(const haptics::BuildResult& built) {
  spdlog::info("the contacts lie {:.3f} mm from the surface (RMS); {}.", built.distance_rms,
               in_words(built.registration));
  for (const long long id : built.without_samples)
    spdlog::warn("contact {} has no samples and is omitted.", id);
  for (const haptics::ContactMisfit& contact : built.left_out)
    spdlog::warn("contact {} is left out: it {}.", contact.id, contact.reason);
  for (const long long id : built.isolated) {
    spdlog::warn(
        "contact {} is in no triangle of contacts: there are too few around it; probe more "
        "there.",
        id);
  }
  tell_friction(built);
  tell_sharing(built);
  tell_pressing(built);
  tell_rate(built);
  if (!built.pressing && built.model.noise)
    spdlog::info("the noise of the forces is taken as {:.3g} N.", built.model.noise->force);
  if (built.rule_errors) {
    spdlog::info(
        "contacts predicted from those around them: RMS {} by compliances, {} by forces; "
        "the model blends {}.",
        newtons(built.rule_errors->compliances), newtons(built.rule_errors->forces),
        haptics::to_string(built.model.interpolation.rule));
  }
  if (built.surface_ends.cols() > 0) {
    spdlog::info(
        "the surface is given {} more vertices, {} in all: its edges were longer than two thirds "
        "of the distance between contacts. Its shape stays.",
        built.surface_ends.cols(), built.model.surface.vertices.cols());
  }
  if (built.surface_flipped)
    spdlog::warn("the surface's triangles were reversed to agree with the contact normals.");
}

std::string per_contact_in_words(const haptics::BuildResult& built) {
  std::vector<std::string> lines;
  std::vector<double> errors;
  for (std::size_t i = 0; i < built.contacts.size(); ++i) {
    const haptics::ContactModel& contact = built.model.contacts[i];
    const haptics::FitResult& found = built.contacts[i].fit;
    lines.push_back(fmt::format(
        "  contact {}: RMS {} with {} bases from {} pairs, friction {}; {}; {}{}\n", contact.id,
        newtons(contact.rms), contact.field.bases.size(), contact.samples, friction_of(contact),
        in_words(found.stop), in_words(found.certificate.passivity),
        contact.shared_local ? ", shares the local part" : ""));
    errors.push_back(contact.rms);
  }
  return worst_lines(lines, errors);
}

std::string fit_in_words(const haptics::BuildResult& built) {
  const geometry::ErrorStatistics statistics = rms_of(built);
  return fmt::format("{} in {}; RMS of a contact {} in the median, at most {}",
                     counted(built.contacts.size(), "contact"),
                     counted(built.model.triangles.cols(), "triangle"), newtons(statistics.median),
                     newtons(statistics.max));
}

Json fit_figures(const haptics::BuildResult& built, bool with_contacts) {
  Json per_contact = Json::array(), left_out = Json::array();
  if (with_contacts) {
    for (std::size_t i = 0; i < built.contacts.size(); ++i)
      per_contact.push_back(contact_figures(built.model.contacts[i], built.contacts[i]));
  }
  for (const haptics::ContactMisfit& contact : built.left_out)
    left_out.push_back({{"contact", contact.id}, {"reason", contact.reason}});
  const geometry::ErrorStatistics statistics = rms_of(built);
  Json figures = {
      {"contacts", built.contacts.size()},
      {"triangles", built.model.triangles.cols()},
      {"registration", haptics::to_string(built.registration)},
      {"surface_vertices", built.model.surface.vertices.cols()},
      {"added_vertices", built.surface_ends.cols()},
      {"left_out", left_out},
      {"explained", haptics::explained_share(built.contacts)},
      {"rms", {{"median", statistics.median}, {"p90", statistics.p90}, {"max", statistics.max}}},
      {"per_contact", per_contact}};
  if (built.local_part) figures["shared_local"] = sharing_in_figures(built);
  if (built.friction_load) {
    figures["friction_load"] = {{"exponent", built.friction_load->load.exponent},
                                {"exponent_error", built.friction_load->exponent_error},
                                {"force", built.friction_load->load.force}};
  }
  if (built.rate) figures["rate"] = rate_in_figures(*built.rate);
  if (built.model.noise) {
    figures["noise"] = {{"force", built.model.noise->force},
                        {"displacement", built.model.noise->displacement}};
  }
  if (built.rule_errors) {
    figures["blend"] = {{"rule", haptics::to_string(built.model.interpolation.rule)},
                        {"compliances", built.rule_errors->compliances},
                        {"forces", built.rule_errors->forces}};
  }
  if (built.pressing) figures["pressing"] = pressing_in_figures(*built.pressing);
  return figures;
}

}  // namespace palpate::apps
