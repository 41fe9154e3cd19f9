// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "commands/fit_record.h"
#include "commands/probe_campaign.h"
#include "palpate/error.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/model_io.h"
#include "palpate/output_file.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/plausibility.h"
#include "palpate/probing/rate_dependence.h"
#include "palpate/require.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/fingerprint.h"
#include "shared/inputs.h"
#include "shared/model_pictures.h"
#include "shared/plausible.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct FitCall {
  fs::path acquisition, surface, output, pictures;
  haptics::FitOptions fit;
  haptics::BlendRule blend_rule = haptics::BlendRule::compliances;
  geometry::ContactTriangulationMethod triangulation =
      geometry::ContactTriangulationMethod::delaunay;
  std::optional<haptics::ModelEncoding> encoding;
  std::optional<double> budget_us;
  geometry::ReadOptions meshes;
  bool shared_local = false;
  int dense_samples = haptics::LocalGlobalOptions{}.dense_samples;
  bool resume = false;
  double max_distance = haptics::BuildOptions{}.max_distance;
  int max_left_out = haptics::BuildOptions{}.max_left_out;
};

constexpr std::size_t kNamed = 50;  // largest number of contacts named per reason

std::string named(const std::vector<long long>& contacts) {
  const std::span first(contacts.data(), std::min(contacts.size(), kNamed));
  return fmt::format("{}{}", fmt::join(first, ", "), first.size() < contacts.size() ? ", ..." : "");
}

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
                   built.contacts.size(), in_words(stop), named(contacts));
    }
  }
  if (from_others) spdlog::warn("some of these use the mean friction of the other contacts.");
  if (bounded) spdlog::warn("some of these use a lower bound; their true friction may be larger.");
}

std::string friction_of(const haptics::ContactModel& contact) {
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

/// Describes whether contacts share a local part, or why not; for messages and for the model.
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
          "none shares a local part: {}; errors would be {:.2f} times those "
          "without it, +- {:.0f} % (tested at dense contacts), which is not a "
          "significant gain",
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

void tell(const haptics::BuildResult& built) {
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
  if (built.surface_flipped)
    spdlog::warn("the surface's triangles were reversed to agree with the contact normals.");
}

void draw(const FitCall& call, const haptics::Model& model,
          const probing::CheckedAcquisition& acquisition) {
  draw_model_contacts(call.pictures / "contacts.png", model,
                      "Contacts, their cells and triangulation");
  const auto worst = std::max_element(model.contacts.begin(), model.contacts.end(),
                                      [](const auto& a, const auto& b) { return a.rms < b.rms; });
  draw_contact_field(call.pictures / fmt::format("contact_{}.png", worst->id), model, acquisition,
                     static_cast<std::size_t>(worst - model.contacts.begin()));
}

/// The record beside the model: `OUTPUT.fits`.
fs::path record_file(const fs::path& output) {
  fs::path file = fs::absolute(output).lexically_normal();
  if (!file.has_filename()) file = file.parent_path();
  return file += ".fits";
}

/// All data and options that the fits depend on.
Json settings_of(const FitCall& call) {
  return {{"ACQUISITION", fingerprint(call.acquisition)},
          {"SURFACE", fingerprint(call.surface)},
          {"--unit", call.meshes.unit ? Json(*call.meshes.unit) : Json()},
          {"--accuracy", call.fit.accuracy},
          {"--passive", haptics::to_string(call.fit.mode)},
          {"--force-noise", call.fit.noise.force},
          {"--max-distance", call.max_distance},
          {"--leave-out", call.max_left_out},
          {"--max-bases", call.fit.max_bases ? Json(*call.fit.max_bases) : Json()},
          {"--shared-local", call.shared_local},
          {"--dense-samples", call.shared_local ? Json(call.dense_samples) : Json()},
          {"version of palpate", PALPATE_VERSION}};
}

// A rendered force blends the fields of three contacts.
constexpr int kBlended = 3;

void limit_to_budget(FitCall& call) {
  if (!call.budget_us) return;
  const double bases = *call.budget_us / (kBlended * haptics::kEvaluationCost);
  if (!(bases >= 1)) {
    throw InvalidInput(
        fmt::format("--budget is {} us; one base for each of the {} contacts of a "
                    "blend already takes {:.2f} us; pass at least that",
                    *call.budget_us, kBlended, kBlended * haptics::kEvaluationCost));
  }
  const int most = static_cast<int>(std::min(bases, 1000.0));
  call.fit.max_bases =
      std::min(most, call.fit.max_bases.value_or(call.fit.mode == haptics::FitMode::convex
                                                     ? haptics::kMaxConvexBases
                                                     : haptics::kMaxLocalBases));
}

haptics::BuildResult build(const probing::CheckedAcquisition& acquisition,
                           const geometry::TriangleMesh& surface, const FitCall& call,
                           FitRecord& record) {
  std::optional<Progress> bar;  // its scope ends before anything is printed
  haptics::BuildStage shown{};
  const auto show = [&](haptics::BuildStage stage, int done, int total) {
    if (!bar || stage != shown)
      bar.emplace(stage == haptics::BuildStage::friction ? "finding friction" : "fitting");
    shown = stage;
    bar->show(done, total);
  };
  // Friction needs a noise above zero, so zero is replaced by its default.
  haptics::FrictionOptions friction;
  if (call.fit.noise.force > 0) friction.force_noise = call.fit.noise.force;
  try {
    return haptics::build_model(
        acquisition, surface,
        {.fit = call.fit,
         .friction = friction,
         .max_distance = call.max_distance,
         .max_left_out = call.max_left_out,
         .blend_rule = call.blend_rule,
         .triangulation = call.triangulation,
         .dense_samples = call.shared_local ? std::optional(call.dense_samples) : std::nullopt,
         .progress = show,
         .known_fit = [&](long long contact) { return record.find(contact); },
         .keep_fit = [&](long long contact,
                         const haptics::FitResult& result) { record.add(contact, result); }});
  } catch (const InvalidInput& error) {
    throw InvalidInput(
        with_option_names(error.what(), {{"build_model(): ", call.acquisition.string() + ": "},
                                         {"BuildOptions::max_distance", "--max-distance"},
                                         {"BuildOptions::max_left_out = ", "--leave-out "}}));
  }
}

/// Warns of what was not measured, so that the model only assumes it.
void tell_gaps(const probing::CheckedAcquisition& acquisition, Json& warnings) {
  const std::vector<long long> contacts = probing::probed_in_one_direction(acquisition);
  if (contacts.empty()) return;
  const bool all = contacts.size() == acquisition.contacts().size();
  warn(
      warnings, "one_direction",
      fmt::format("at {}, all forces have one direction: the stiffness across it was not measured. "
                  "Forces of the model against a drag there are an assumption, and so is its "
                  "friction. Only presses in that direction can be relied on; drag the tool in at "
                  "least four directions to measure the others",
                  all ? "all contacts"
                      : fmt::format("{} of {} contacts ({})", contacts.size(),
                                    acquisition.contacts().size(), named(contacts))));
}

/// Warns of fits that are complete, but say little of the measurements.
void tell_doubts(const haptics::BuildResult& built, Json& warnings) {
  constexpr double kLeastExplained = 0.9;  // share of the squared forces
  // Of the samples: the rate of wrong marks that the fit of friction allows for.
  constexpr double kMostContradicting = 0.05;
  const double explained = haptics::explained_share(built.contacts);
  if (explained < kLeastExplained) {
    warn(warnings, "poorly_explained",
         fmt::format("the model explains only {:.0f} % of the measured forces (squared): errors "
                     "are {:.0f} % of the forces. Check the groups, signs and units of the "
                     "measurements",
                     100 * explained, 100 * std::sqrt(1 - explained)));
  }
  int contradictions = 0, trials = 0;
  for (const haptics::ContactReport& contact : built.contacts) {
    if (!contact.friction_contradictions) continue;
    contradictions += *contact.friction_contradictions;
    trials += contact.friction_trials;
  }
  if (contradictions > kMostContradicting * trials) {
    warn(warnings, "friction_contradicted",
         fmt::format("the friction that was found contradicts {} of {} samples: they held outside "
                     "of the friction cone, or are marked as slipped inside it. Check the column "
                     "slipped",
                     contradictions, trials));
  }
}

/// Warns of measurements that a quasi-static model does not show.
void tell_rates(const fs::path& acquisition, Json& warnings) {
  const std::optional<probing::CampaignStore> campaign = probing::CampaignStore::find(acquisition);
  if (!campaign) return;
  const std::string source = acquisition.string();
  const probing::ContactPlan plan = probing::parse_plan(campaign->description().plan, source);
  const probing::CampaignOptions options =
      probing::parse_campaign_options(campaign->description().strategy, source);
  const std::string more =
      beyond_statics(probing::rate_dependence(campaign->trials(plan.contacts), options.program));
  if (!more.empty()) warn(warnings, "rate_dependent", source + ": " + more);
}

/// A run that fails because of its fits keeps none: another one would find the same.
haptics::BuildResult build_or_forget(const probing::CheckedAcquisition& acquisition,
                                     const geometry::TriangleMesh& surface, const FitCall& call,
                                     FitRecord& record) {
  try {
    return build(acquisition, surface, call, record);
  } catch (const SolverError&) {
    record.remove();
    throw;
  }
}

void fit(const Settings& settings, FitCall call) {
  limit_to_budget(call);
  const fs::path record_path = record_file(call.output);
  check_outputs({call.acquisition, call.surface}, {call.output, call.pictures, record_path});
  check_output_folder({call.acquisition, call.surface}, call.output);
  check_replaceable(call.output, haptics::model_entries());
  Json warnings = Json::array();
  const probing::CheckedAcquisition acquisition =
      read_plausible_acquisition(call.acquisition, warnings);
  tell_rates(call.acquisition, warnings);
  const geometry::TriangleMesh surface = geometry::read_mesh(call.surface, call.meshes);
  FitRecord record(record_path, settings_of(call));
  if (call.resume) record.resume();
  record.begin();
  const std::size_t kept = record.size();
  haptics::BuildResult built = build_or_forget(acquisition, surface, call, record);
  built.model.made["program"] = "palpate " PALPATE_VERSION;
  built.model.made["acquisition"] = call.acquisition.filename().string();
  built.model.made["surface"] = call.surface.filename().string();
  if (built.local_part) built.model.made["local part"] = sharing_in_words(built);
  haptics::write_model(call.output, built.model, call.encoding);
  record.remove();
  tell(built);
  tell_gaps(acquisition, warnings);
  tell_doubts(built, warnings);
  if (!call.pictures.empty()) draw(call, built.model, acquisition);

  Json per_contact = Json::array();
  std::vector<double> rms;
  std::string prose;
  for (std::size_t i = 0; i < built.contacts.size(); ++i) {
    const haptics::ContactModel& contact = built.model.contacts[i];
    const haptics::FitResult& found = built.contacts[i].fit;
    rms.push_back(contact.rms);
    const auto bases = contact.field.bases.size();
    if (settings.json) {
      per_contact.push_back({{"contact", contact.id},
                             {"rms", contact.rms},
                             {"bases", bases},
                             {"friction", contact.friction},
                             {"friction_error", number_or_null(contact.friction_error)},
                             {"friction_lower_bound", contact.friction_lower_bound},
                             {"friction_source", haptics::to_string(contact.friction_source)},
                             {"friction_stop", haptics::to_string(built.contacts[i].friction.stop)},
                             {"friction_contradictions", contradictions_of(built.contacts[i])},
                             {"samples", contact.samples},
                             {"stop", haptics::to_string(found.stop)},
                             {"passive", haptics::to_string(found.certificate.passivity)},
                             {"chi2", found.chi2},
                             {"noise_floor", found.noise_floor},
                             {"outliers", found.outliers},
                             {"condition", number_or_null(found.condition)},
                             {"shared_local", contact.shared_local}});
    } else {
      prose += fmt::format(
          "  contact {}: RMS {:.4f} N with {} bases from {} pairs, friction {}; {}; {}{}\n",
          contact.id, contact.rms, bases, contact.samples, friction_of(contact),
          in_words(found.stop), in_words(found.certificate.passivity),
          contact.shared_local ? ", shares the local part" : "");
    }
  }
  const geometry::ErrorStatistics statistics = geometry::error_statistics(rms);
  Json left_out = Json::array();
  for (const haptics::ContactMisfit& contact : built.left_out)
    left_out.push_back({{"contact", contact.id}, {"reason", contact.reason}});
  Json figures = {
      {"contacts", built.contacts.size()},
      {"kept", kept},
      {"triangles", built.model.triangles.cols()},
      {"registration", haptics::to_string(built.registration)},
      {"left_out", left_out},
      {"explained", haptics::explained_share(built.contacts)},
      {"rms", {{"median", statistics.median}, {"p90", statistics.p90}, {"max", statistics.max}}},
      {"per_contact", per_contact},
      {"warnings", warnings},
      {"file", call.output.string()}};
  if (built.local_part) figures["shared_local"] = sharing_in_figures(built);
  print(settings, figures,
        prose + fmt::format("{} contacts in {} triangles; RMS of a contact {:.4f} N in the median, "
                            "at most {:.4f} N. Written to {}",
                            built.contacts.size(), built.model.triangles.cols(), statistics.median,
                            statistics.max, call.output.string()));
}

}  // namespace

void add_fit(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<FitCall>();
  CLI::App* command = app.add_subcommand("fit", "Fit a model to measurements and a surface");
  command->add_option("ACQUISITION", call->acquisition, "Measurements (acquisition.db)")
      ->required();
  command->add_option("SURFACE", call->surface, "Undeformed surface (mesh)")->required();
  add_unit_option(*command, call->meshes);
  command->add_option("-o,--output", call->output, "Model folder to write")->required();
  command
      ->add_option("--accuracy", call->fit.accuracy,
                   "Stop fitting a contact at this RMS [N]; 0: as accurate as the noise of the "
                   "measurements allows")
      ->capture_default_str();
  add_choice<haptics::FitMode>(
      *command, "--passive", call->fit.mode,
      {{"convex", haptics::FitMode::convex},
       {"certified", haptics::FitMode::certified},
       {"local", haptics::FitMode::local}},
      "How a field is made passive: convex, everywhere by construction (default); certified, "
      "proven within the reach of the measurements; local, only near zero");
  add_choice<geometry::ContactTriangulationMethod>(
      *command, "--triangulation", call->triangulation,
      {{"delaunay", geometry::ContactTriangulationMethod::delaunay},
       {"voronoi_dual", geometry::ContactTriangulationMethod::voronoi_dual}},
      "How contacts are triangulated: delaunay, the geodesic Delaunay triangulation (default); "
      "voronoi_dual, the dual of the geodesic Voronoi cells, which may leave out contacts on thin "
      "parts and near the border. Use it if delaunay fails");
  command
      ->add_option("--max-distance", call->max_distance,
                   "Reject a contact that is farther from the surface [mm], after all contacts "
                   "were moved onto it by one small rigid motion")
      ->check(within(at_least(0)))
      ->capture_default_str();
  command
      ->add_option("--leave-out", call->max_left_out,
                   "Leave out up to this many contacts that are too far from the surface, or whose "
                   "normal points into it, instead of rejecting the measurements")
      ->check(within(at_least(0)))
      ->capture_default_str();
  command->add_option("--max-bases", call->fit.max_bases, "Largest number of bases of a field");
  command->add_option(
      "--budget", call->budget_us,
      fmt::format(
          "Time to evaluate one force [us]. It limits the number of bases per field, assuming that "
          "each base costs {} us and that three fields are blended. Locating the contact and "
          "blending take a few us more, and a slipping contact evaluates many forces per step: "
          "measure a step with palpate play",
          haptics::kEvaluationCost));
  command
      ->add_option(
          "--force-noise", call->fit.noise.force,
          "Standard deviation of each component of the measured forces [N], for fields and "
          "friction")
      ->capture_default_str();
  CLI::Option* shared = command->add_flag(
      "--shared-local", call->shared_local,
      "Learn the local deformation around the tool from contacts with many samples, and fit "
      "contacts with few samples as this local part plus a compliance of their own. Used only if a "
      "test shows a gain (thesis 6.2.1.2); the result is reported");
  command
      ->add_option("--dense-samples", call->dense_samples,
                   "Smallest number of pairs of displacement and force for a contact to count as "
                   "having many samples")
      ->needs(shared)
      ->check(within(at_least(haptics::kFewestDenseSamples)))
      ->capture_default_str();
  command->add_flag_callback(
      "--cbor", [call] { call->encoding = haptics::ModelEncoding::cbor; },
      fmt::format("Write the document in CBOR, field.cbor; this is the default above {} contacts",
                  haptics::kMaxJsonContacts));
  command->add_flag_callback(
      "--blend-forces", [call] { call->blend_rule = haptics::BlendRule::forces; },
      "Compute the force between contacts by blending their forces at the same displacement "
      "(thesis "
      "5.3.2) instead of at "
      "displacements that match the compliance of the place");
  command->add_option("--pictures", call->pictures,
                      "Folder for pictures: the contacts, and the contact with the worst fit");
  command->add_flag("--resume", call->resume,
                    "Keep the fits that an earlier run with the same measurements, surface and "
                    "settings finished");
  command->footer(
      "Finished fits are kept in a file beside the model (model.fits for -o model/) until the "
      "model "
      "is written, also after Ctrl-C. With --resume the result is the same as without an "
      "interruption.\nExample:\n  palpate fit acquisition.db surface.ply -o model/");
  command->callback([call, &settings] { fit(settings, *call); });
}

}  // namespace palpate::apps
