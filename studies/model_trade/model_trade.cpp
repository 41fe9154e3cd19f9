// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Compares the modes of fitting, numbers of bases, and other models that could be fitted to the
// same data: prints the tables of docs/trade-model.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "measure.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"
#include "peers.h"
#include "pressing.h"
#include "shapes.h"
#include "sharing.h"
#include "stated_errors.h"
#include "strip_acquisition.h"

namespace palpate::bench {
namespace {

using haptics::FitMode;

// Noise-free pairs a contact.
constexpr int kTruths = 200;

struct DataSet {
  std::string name;
  std::vector<ContactData> contacts;
};

void add_contacts(DataSet& set, const support::Strip& strip, unsigned seed) {
  const support::StripProbing probing{.seed = seed};
  const probing::Acquisition acquisition = support::strip_acquisition(strip, probing);
  const std::vector<Eigen::Vector2d> places = support::strip_places(probing);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const haptics::ForceSamples samples =
        haptics::realign(acquisition.contacts[i], acquisition.samples);
    ContactData contact{samples.displacements, samples.forces, {}, {}};
    contact.truth_displacements.resize(3, kTruths);
    contact.truth_forces.resize(3, kTruths);
    Eigen::Index column = 0;
    for (const auto& truth : support::strip_truths(strip, {places[i]}, kTruths)) {
      contact.truth_displacements.col(column) = truth.displacement;
      contact.truth_forces.col(column++) = truth.force;
    }
    set.contacts.push_back(std::move(contact));
  }
}

/// Two objects each, different in what they are made of: none is the bundled one.
DataSet sheets(bool block) {
  DataSet set{block ? "sheet with block" : "sheet", {}};
  for (const unsigned seed : {1U, 2U}) {
    const double way = seed == 1 ? -1 : 1;
    support::Strip strip{
        .tension = 0.8 + 0.1 * way, .axial = 42 - 5 * way, .compliance = 0.25 + 0.04 * way};
    if (block) {
      strip.block = 1.5;
      strip.depth = 15 + way;
      strip.block_low += Eigen::Vector2d(-12, 9) * way;
      strip.block_high += Eigen::Vector2d(-12, 9) * way;
    }
    add_contacts(set, strip, seed);
  }
  return set;
}

Predictor predictor(const haptics::ForceField& field) {
  constexpr std::size_t kIsotropic = 5, kRidge = 6;  // numbers of a base in the file
  std::size_t numbers = 0;
  for (const haptics::Multiquadric& base : field.bases) {
    numbers += haptics::is_ridge(base) ? kRidge : kIsotropic;
  }
  return {
      [field](const Eigen::Vector3d& displacement) { return haptics::force(field, displacement); },
      numbers};
}

Method ours(const std::string& name, FitMode mode, std::optional<int> bases) {
  return {
      bases ? fmt::format("{}, {} bases", name, *bases) : name, [=](const ContactData& data) {
        haptics::FitOptions options{.mode = mode};
        if (bases) options.max_bases = *bases;
        return predictor(haptics::fit_force_field(data.displacements, data.forces, options).field);
      }};
}

std::vector<Method> methods() {
  std::vector<Method> result;
  for (const int bases : {1, 2, 4, 6, 8}) {
    result.push_back(ours("convex", FitMode::convex, bases));
  }
  result.push_back(ours("convex, as many as it takes (default)", FitMode::convex, {}));
  for (const int bases : {4, 6}) result.push_back(ours("local", FitMode::local, bases));
  result.push_back(ours("certified", FitMode::certified, 6));
  for (const int nodes : {8, 16, 32}) {
    result.push_back(
        {fmt::format("grid lookup, {} nodes an axis", nodes), [=](const ContactData& data) {
           return grid_lookup(data.displacements, data.forces, nodes);
         }});
  }
  result.push_back({"isotropic bases with weights >= 0, of 8000", [](const ContactData& data) {
                      return isotropic_only(data.displacements, data.forces);
                    }});
  result.push_back({"exact radial bases", [](const ContactData& data) {
                      return exact_rbf(data.displacements, data.forces);
                    }});
  result.push_back({"Gaussian processes", [](const ContactData& data) {
                      return gaussian_process(data.displacements, data.forces);
                    }});
  return result;
}

void run(const std::filesystem::path& csv) {
  std::string table =
      "set,method,truth_rms,truth_rms_p90,training_rms,not_passive_percent,"
      "loop_energy,bytes,fit_ms,force_us\n";
  for (const DataSet& set : {sheets(false), sheets(true)}) {
    fmt::print(
        "\n| {} | truth: median [N] | 90 % [N] | samples: median [N] | not passive [%] | loop "
        "[N mm] | bytes | fit [ms] | force [us] |\n|---|---|---|---|---|---|---|---|---|\n",
        set.name);
    for (const Method& method : methods()) {
      const Figures f = measure(method, set.contacts);
      const double bytes = f.numbers * sizeof(double);
      fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:.3f} | {:.0f} | {:.1f} | {:.3f} |\n",
                 method.name, f.truth_rms, f.truth_rms_p90, f.training_rms, f.not_passive,
                 f.loop_energy, bytes, f.fit_ms, f.force_us);
      table += fmt::format("{},\"{}\",{:.5f},{:.5f},{:.5f},{:.2f},{:.4f},{:.0f},{:.2f},{:.4f}\n",
                           set.name, method.name, f.truth_rms, f.truth_rms_p90, f.training_rms,
                           f.not_passive, f.loop_energy, bytes, f.fit_ms, f.force_us);
      std::cout << std::flush;
    }
  }
  write_file(csv, [&](std::ostream& out) { out << table; });
}

}  // namespace
}  // namespace palpate::bench

int main(int count, char** arguments) try {
  CLI::App app("Measures what fitting force fields costs and buys; prints Markdown");
  std::filesystem::path csv = "trade-model.csv";
  app.add_option("-o,--output", csv, "The same figures as CSV");
  unsigned sharing = 0;
  app.add_option(
      "--sharing", sharing,
      "Instead: the value of a local part that contacts share, on this number of objects "
      "of each kind");
  bool pressing = false;
  bool stated = false;
  app.add_flag("--stated-errors", stated,
               "In place of all that: whether models state their errors rightly");
  bool shapes = false;
  app.add_flag("--shapes", shapes,
               "In place of all that: how far displayed surfaces are from the true ones");
  std::string kind;
  std::optional<unsigned> seed;
  app.add_flag("--pressing", pressing,
               "In place of all that: models of objects that were only pressed");
  app.add_option("--kind", kind,
                 "With --pressing or --stated-errors: only the sets whose name contains this");
  app.add_option("--seed", seed,
                 "With --pressing (default: 1) or --stated-errors (201): others of the same kinds");
  CLI11_PARSE(app, count, arguments);
  if (pressing) {
    palpate::bench::measure_pressing(kind, seed.value_or(1));
  } else if (stated) {
    palpate::bench::measure_stated_errors(kind, seed.value_or(201));
  } else if (shapes) {
    palpate::bench::measure_shapes();
  } else if (sharing > 0) {
    palpate::bench::measure_sharing(sharing);
  } else {
    palpate::bench::run(csv);
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
