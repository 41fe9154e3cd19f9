// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_import.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/table_reader.h"
#include "probing/probe.h"
#include "shared/call_checks.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"
#include "shared/plausible.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

struct ProbeCall {
  std::vector<fs::path> data;
  fs::path mapping, store, output, surface;
  /// Options for single fields, which change those of the mapping file.
  std::vector<std::function<void(probing::AcquisitionMapping&)>> changes;
  probing::AcquisitionMapping given;  ///< the same for fields of its list
  std::vector<CLI::Option*> fields;   ///< in the order of the list
  probing::ContactSurfaceOptions of_contacts;
};

/// `more`: further figures, if there are any.
void report(const Settings& settings, const probing::CheckedAcquisition& acquisition,
            const std::string& written, const Json& more = {}, const std::string& also = {}) {
  Json figures = {{"contacts", acquisition.contacts().size()},
                  {"samples", acquisition.samples().size()}};
  if (!more.is_null()) figures.update(more);
  figures["output"] = written;
  print(settings, figures,
        fmt::format("{} and {}, written to {}{}", counted(acquisition.contacts().size(), "contact"),
                    counted(acquisition.samples().size(), "sample"), written, also));
}

/// "px=Fx" gives the column px the name Fx.
void take_name(const std::string& pair, probing::AcquisitionMapping& mapping) {
  const std::size_t equals = pair.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InvalidInput("--map: is " + pair + "; it must be pairs such as px=Fx,py=Fy");
  mapping.columns[CLI::detail::trim_copy(pair.substr(0, equals))] =
      CLI::detail::trim_copy(pair.substr(equals + 1));
}

/// Adds an option that sets a field of the mapping to `read` of the given value.
template <typename Field, typename Read>
void add_change(CLI::App& command, const std::shared_ptr<ProbeCall>& call, const std::string& name,
                Field probing::AcquisitionMapping::*field, Read read, const std::string& help) {
  command.add_option_function<std::string>(
      name,
      [call, field, read](const std::string& given) {
        const Field value = read(given);
        call->changes.emplace_back(
            [field, value](probing::AcquisitionMapping& mapping) { mapping.*field = value; });
      },
      help);
}

char read_separator(const std::string& text) {
  try {
    return probing::separator_from(text);
  } catch (const InvalidInput& wrong) {
    throw InvalidInput(std::string("--separator: ") + wrong.what());
  }
}

/// The mapping file, or none, with the changes of single options.
probing::AcquisitionMapping mapping_of(const ProbeCall& call) {
  probing::AcquisitionMapping mapping;
  if (!call.mapping.empty()) mapping = probing::read_mapping(call.mapping);
  for (const auto& change : call.changes) change(mapping);
  probing::AcquisitionMapping given = call.given;
  const std::vector<FieldText> texts = texts_of(fields_of(given));
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (call.fields[i]->count() > 0) assign(fields_of(mapping), texts[i].name, texts[i].text);
  }
  return mapping;
}

std::string files_in_words(const std::vector<fs::path>& files) {
  std::string names;
  for (const fs::path& file : files) names += (names.empty() ? "" : " and ") + file.string();
  return names;
}

/// Returns true if forces can replace the missing columns of normals.
bool can_turn_forces_into_normals(const probing::MissingColumn& missing,
                                  const probing::AcquisitionMapping& mapping) {
  return missing.name == "nx" && !mapping.normals_from_forces && !mapping.columns.contains("nx") &&
         !mapping.columns.contains("depth") && !mapping.columns.contains("normal_force") &&
         mapping.contacts != probing::ContactSource::table;
}

probing::ImportedAcquisition read_data(const ProbeCall& call) {
  probing::AcquisitionMapping mapping = mapping_of(call);
  try {
    try {
      return probing::import_acquisition(call.data, mapping);
    } catch (const probing::MissingColumn& missing) {
      if (!can_turn_forces_into_normals(missing, mapping)) throw;
      mapping.normals_from_forces = true;
    }
    probing::ImportedAcquisition imported = probing::import_acquisition(call.data, mapping);
    spdlog::warn(
        "{}: has no normals (nx,ny,nz): that of each contact is taken opposite to its mean force, "
        "as with 'normals: forces'.",
        files_in_words(call.data));
    return imported;
  } catch (const probing::MissingColumn& missing) {
    const std::string column =
        missing.name == "id" ? "contacts.id=NAME or samples.id" : missing.name;
    throw FileError(std::string(missing.what()) +
                    ". If the column has another name, give it: --map " + column + "=NAME");
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(error.with_names([&](const std::string& name) -> std::string {
      if (name == "AcquisitionMapping::columns") return call.mapping.empty() ? "--map" : "columns";
      return call.mapping.empty() ? field_option(name)
                                  : "--mapping: " + name.substr(name.rfind(':') + 1);
    }));
  }
}

/// Reports the parts of a recording that are left out.
void tell_series(const probing::SeriesCounts& series) {
  spdlog::info("{} presses were found; {} moments in contact were too fast for a sample.",
               series.presses, series.fast);
  if (series.empty_presses > 0)
    spdlog::warn(
        "{} of {} presses are left out: the tip was never slow enough in them, or slid before.",
        series.empty_presses, series.presses);
  if (series.slides > 0)
    spdlog::warn(
        "in {} of {} presses, the tip slid along the surface; what followed the slide is left out.",
        series.slides, series.presses);
  if (series.drags > 0)
    spdlog::info("{} samples have a drag: the force was turned while the tip held.", series.drags);
  if (series.drags_without_base > 0)
    spdlog::warn("{} drags are left out: no press before them had their normal force.",
                 series.drags_without_base);
  if (std::isfinite(series.touch_depth))
    spdlog::info(
        "touches were moved back to zero force by {:.3f} mm, which is known to {:.3f} mm "
        "(medians).",
        series.touch_depth, series.touch_deviation);
  if (series.not_extrapolated > 0)
    spdlog::warn(
        "{} touches lie below the surface, where the force passed touch_force: the presses do not "
        "tell where it was zero.",
        series.not_extrapolated);
  if (series.saturated > 0)
    spdlog::warn("{} moments are left out: the sensor was at its limit.", series.saturated);
  if (series.unpaired > 0)
    spdlog::warn("{} moments are left out: with the delay of the forces they have none.",
                 series.unpaired);
  if (series.brief > 0)
    spdlog::info("{} slow pieces are left out: they are shorter than sample_time.", series.brief);
}

void import_data(const Settings& settings, const ProbeCall& call) {
  std::vector<fs::path> inputs = call.data;
  if (!call.mapping.empty()) inputs.push_back(call.mapping);
  check_outputs(inputs, {call.output, call.surface});
  probing::check_acquisition_output(call.output);
  const probing::ImportedAcquisition imported = read_data(call);
  if (imported.series.presses > 0) tell_series(imported.series);
  Json warnings = Json::array();
  check_plausible(files_in_words(call.data), imported.acquisition, warnings);
  std::optional<geometry::MeshFile> surface;
  if (!call.surface.empty()) {
    surface.emplace().mesh =
        surface_of_contacts(imported.acquisition, files_in_words(call.data) + ": --surface-out",
                            warnings, call.of_contacts);
    surface->comments = {"made of the contacts alone, flat between them"};
  }
  probing::write_acquisition(call.output, imported.acquisition);
  Json figures = {{"warnings", warnings}};
  std::string of_surface;
  if (surface) {
    geometry::write_mesh_file(call.surface, *surface);
    figures["surface"] = call.surface.string();
    of_surface = fmt::format("\nA surface of the contacts, flat between them, written to {}",
                             call.surface.string());
  }
  report(settings, imported.acquisition, call.output.string(), figures, of_surface);
}

void export_csv(const Settings& settings, const ProbeCall& call) {
  const fs::path contacts = call.output / "contacts.csv", samples = call.output / "samples.csv";
  check_outputs({call.store}, {contacts, samples});
  for (const fs::path& table : {contacts, samples}) {
    if (is_there(table))
      throw InvalidInput(table.string() +
                         ": is there already; measurements are not overwritten. Choose another "
                         "folder, or remove it first.");
  }
  const probing::CheckedAcquisition acquisition = probing::read_acquisition(call.store);
  probing::write_acquisition_csv(acquisition, contacts, samples);
  report(settings, acquisition, call.output.string());
}

}  // namespace

void add_probe(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ProbeCall>();
  CLI::App* probe = app.add_subcommand(
      "probe", "Plan and take measurements of an object with an arm; convert measurements");
  probe->require_subcommand(1);
  add_probe_truth(*probe, settings);
  add_probe_plan(*probe, settings);
  add_probe_run(*probe, settings);
  add_probe_status(*probe, settings);
  add_probe_report(*probe, settings);

  CLI::App* in = probe->add_subcommand(
      "import", "Convert measurements in CSV, TSV or MAT files to a database for palpate fit");
  add_required(*in, "DATA", call->data,
               "contacts (id,x,y,z,nx,ny,nz [mm]) and samples (id,contact,group_id,px,...,bz,"
               "on_friction_boundary,slipped,range_map,time [N, mm, s]); with a mapping, also one "
               "table or MAT file that holds both, or recordings");
  add_required(*in, "-o,--output", call->output, "Database to write (acquisition.db)");
  in->add_option(
      "--mapping", call->mapping,
      "Mapping file (YAML; docs/measurements.md) that describes your files: columns, units, signs, "
      "frame, and how rows become contacts; the options below change single fields of it");
  CLI::Option* surface = in->add_option(
      "--surface-out", call->surface,
      "Also write a mesh made of the contacts, flat between them, for objects without a scan "
      "(PLY, OBJ or STL)");
  constexpr std::array<std::string_view, 1> kOfSurface{"longest_edge"};
  add_fields(*in, fields_of(call->of_contacts), kOfSurface).front()->needs(surface);
  in->add_option_function<std::vector<std::string>>(
        "--map",
        [call](const std::vector<std::string>& pairs) {
          call->changes.emplace_back([pairs](probing::AcquisitionMapping& mapping) {
            for (const std::string& pair : pairs) take_name(pair, mapping);
          });
        },
        "Names of columns in your files, such as px=Fx,py=Fy,pz=Fz or, with the opposite sign, "
        "pz=-Fz; contacts.id and samples.id are the columns id of one file. For a column that your "
        "files do not have, give a number for all rows (slipped=0), row_number, file_number, or "
        "nothing for empty cells (range_map=)")
      ->delimiter(',')
      ->allow_extra_args(false);
  using Mapping = probing::AcquisitionMapping;
  add_change(*in, call, "--separator", &Mapping::separator, read_separator,
             "Character between cells, or tab (default: the most frequent of , ; and "
             "tab in the first line)");
  add_change(*in, call, "--length-unit", &Mapping::length, geometry::unit_length,
             "Unit of all positions: um, mm, cm, m or in (default: mm)");
  add_change(*in, call, "--force-unit", &Mapping::force, probing::unit_force,
             "Unit of all forces: N, mN, kN, g, kg or lbf (default: N)");
  add_change(*in, call, "--time-unit", &Mapping::time, probing::unit_time,
             "Unit of all times: s, ms, us or min (default: s)");
  call->fields = add_fields(*in, fields_of(call->given));
  in->footer(
      "docs/measurements.md describes the columns. Measurements that contradict their meaning, "
      "such as forces with the wrong sign, are rejected. Suspicious ones cause a warning.\n"
      "Examples:\n  palpate probe import contacts.csv samples.csv -o acquisition.db\n"
      "  palpate probe import points.csv presses.csv --map px=Fx,py=Fy,pz=Fz,slipped=0 "
      "--length-unit m --force-unit g -o acquisition.db\n"
      "  palpate probe import --mapping lab.yaml experiment.mat -o acquisition.db --surface-out "
      "surface.ply");
  in->callback([call, &settings] { import_data(settings, *call); });

  CLI::App* out =
      probe->add_subcommand("export", "Convert a database of measurements to two CSV files");
  add_required(*out, "ACQUISITION", call->store, "Database to read (acquisition.db)");
  add_required(*out, "-o,--output", call->output,
               "Folder for contacts.csv and samples.csv, in which neither is yet");
  out->footer("Example:\n  palpate probe export acquisition.db -o csv/");
  out->callback([call, &settings] { export_csv(settings, *call); });
}

}  // namespace palpate::apps
