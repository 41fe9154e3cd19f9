// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands/probe.h"
#include "palpate/error.h"
#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/csv.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/plausible.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

struct ProbeCall {
  fs::path contacts, samples, store, output;
  probing::AcquisitionCsvOptions csv;
};

/// `warnings`: null if the command looks for none.
void report(const Settings& settings, const probing::CheckedAcquisition& acquisition,
            const std::string& written, const Json& warnings = {}) {
  Json figures = {{"contacts", acquisition.contacts().size()},
                  {"samples", acquisition.samples().size()}};
  if (!warnings.is_null()) figures["warnings"] = warnings;
  figures["output"] = written;
  print(settings, figures,
        fmt::format("{} contacts and {} samples, written to {}", acquisition.contacts().size(),
                    acquisition.samples().size(), written));
}

/// "px=Fx" gives the column px the name Fx.
void take_name(const std::string& pair, probing::AcquisitionCsvOptions& csv) {
  const std::size_t equals = pair.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InvalidInput("--map: is " + pair + "; it must be pairs such as px=Fx,py=Fy");
  csv.names[CLI::detail::trim_copy(pair.substr(0, equals))] =
      CLI::detail::trim_copy(pair.substr(equals + 1));
}

char separator_of(const std::string& text) {
  if (text == "tab" || text == "\\t") return '\t';
  if (text.size() != 1 || text == "\"")
    throw InvalidInput("--separator: is " + text + "; it must be one character, or tab");
  return text.front();
}

probing::CheckedAcquisition read_csv(const ProbeCall& call) {
  try {
    return probing::read_acquisition_csv(call.contacts, call.samples, call.csv);
  } catch (const probing::MissingColumn& missing) {
    const std::string column =
        missing.name == "id" ? "contacts.id=NAME or samples.id" : missing.name;
    throw FileError(std::string(missing.what()) +
                    ". If the column has another name, give it: --map " + column + "=NAME");
  } catch (const InvalidInput& error) {
    throw InvalidInput(
        with_option_names(error.what(), {{"AcquisitionCsvOptions::names", "--map"}}));
  }
}

void import_csv(const Settings& settings, const ProbeCall& call) {
  check_outputs({call.contacts, call.samples}, {call.output});
  const probing::CheckedAcquisition acquisition = read_csv(call);
  Json warnings = Json::array();
  check_plausible(call.contacts.string() + " and " + call.samples.string(), acquisition, warnings);
  probing::write_acquisition(call.output, acquisition);
  report(settings, acquisition, call.output.string(), warnings);
}

void export_csv(const Settings& settings, const ProbeCall& call) {
  const fs::path contacts = call.output / "contacts.csv", samples = call.output / "samples.csv";
  check_outputs({call.store}, {contacts, samples});
  const probing::CheckedAcquisition acquisition = probing::read_acquisition(call.store);
  probing::write_acquisition_csv(acquisition, contacts, samples);
  report(settings, acquisition, call.output.string());
}

}  // namespace

void add_probe(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ProbeCall>();
  CLI::App* probe = app.add_subcommand(
      "probe", "Plan and take measurements of an object by an arm; convert them");
  probe->require_subcommand(1);
  add_probe_truth(*probe, settings);
  add_probe_plan(*probe, settings);
  add_probe_run(*probe, settings);
  add_probe_report(*probe, settings);

  CLI::App* in =
      probe->add_subcommand("import", "Convert two CSV files to a database for palpate fit");
  in->add_option("CONTACTS", call->contacts, "id,x,y,z,nx,ny,nz [mm]")->required();
  in->add_option(
        "SAMPLES", call->samples,
        "id,contact,group_id,px,...,bz,on_friction_boundary,slipped,range_map,time [N, mm, s]")
      ->required();
  in->add_option("-o,--output", call->output, "Database to write (acquisition.db)")->required();
  in->add_option_function<std::vector<std::string>>(
        "--map",
        [call](const std::vector<std::string>& pairs) {
          for (const std::string& pair : pairs) take_name(pair, call->csv);
        },
        "Names of columns in your files, such as px=Fx,py=Fy,pz=Fz; "
        "contacts.id and samples.id name the ids of one file. For a column that your files do not "
        "have, give "
        "a number for all rows (slipped=0), or nothing for empty cells (range_map=)")
      ->delimiter(',')
      ->allow_extra_args(false);
  in->add_option_function<std::string>(
      "--separator", [call](const std::string& text) { call->csv.separator = separator_of(text); },
      "Character between cells, or tab (default: the most frequent of , ; and tab in the first "
      "line)");
  in->add_option_function<std::string>(
      "--length-unit",
      [call](const std::string& name) { call->csv.length = geometry::unit_length(name); },
      "Unit of all positions: um, mm, cm, m or in (default: mm)");
  in->add_option_function<std::string>(
      "--force-unit",
      [call](const std::string& name) { call->csv.force = probing::unit_force(name); },
      "Unit of all forces: N, mN, kN, g, kg or lbf (default: N)");
  in->add_option_function<std::string>(
        "--force-on", [call](const std::string& on) { call->csv.forces_on_tool = on == "tool"; },
        "What the forces act on: object, or tool if they are those that the tool feels, which "
        "changes their signs (default: object)")
      ->check(one_of({"object", "tool"}));
  in->footer(
      "docs/measurements.md describes the columns. Measurements that contradict their meaning, "
      "such as forces with the wrong sign, are rejected. Suspicious ones cause a warning.\n"
      "Examples:\n  palpate probe import contacts.csv samples.csv -o acquisition.db\n"
      "  palpate probe import points.csv presses.csv --map px=Fx,py=Fy,pz=Fz,slipped=0 "
      "--length-unit m --force-unit g -o acquisition.db");
  in->callback([call, &settings] { import_csv(settings, *call); });

  CLI::App* out = probe->add_subcommand("export", "Convert such a database to two CSV files");
  out->add_option("ACQUISITION", call->store, "Database to read (acquisition.db)")->required();
  out->add_option("-o,--output", call->output, "Folder for contacts.csv and samples.csv")
      ->required();
  out->footer("Example:\n  palpate probe export acquisition.db -o csv/");
  out->callback([call, &settings] { export_csv(settings, *call); });
}

}  // namespace palpate::apps
