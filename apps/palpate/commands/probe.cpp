// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_store.h"
#include "shared/command_line.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct ProbeCall {
  fs::path contacts, samples, store, output;
};

void report(const Settings& settings, const probing::CheckedAcquisition& acquisition,
            const std::string& written) {
  print(settings,
        {{"contacts", acquisition.contacts().size()},
         {"samples", acquisition.samples().size()},
         {"output", written}},
        fmt::format("{} contacts and {} samples, written to {}", acquisition.contacts().size(),
                    acquisition.samples().size(), written));
}

void import_csv(const Settings& settings, const ProbeCall& call) {
  check_outputs({call.contacts, call.samples}, {call.output});
  const probing::CheckedAcquisition acquisition =
      probing::read_acquisition_csv(call.contacts, call.samples);
  probing::write_acquisition(call.output, acquisition);
  report(settings, acquisition, call.output.string());
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
  CLI::App* probe = app.add_subcommand("probe", "Convert measurements of an object by an arm");
  probe->require_subcommand(1);

  CLI::App* in = probe->add_subcommand("import", "Convert two CSV files to an acquisition store");
  in->add_option("CONTACTS", call->contacts, "id,x,y,z,nx,ny,nz [mm]")->required();
  in->add_option(
        "SAMPLES", call->samples,
        "id,contact,group_id,px,...,bz,on_friction_boundary,slipped,range_map,time [N, mm, s]")
      ->required();
  in->add_option("-o,--output", call->output, "Store to write (acquisition.db)")->required();
  in->footer("Example:\n  palpate probe import contacts.csv samples.csv -o acquisition.db");
  in->callback([call, &settings] { import_csv(settings, *call); });

  CLI::App* out = probe->add_subcommand("export", "Convert an acquisition store to two CSV files");
  out->add_option("ACQUISITION", call->store, "Store to read (acquisition.db)")->required();
  out->add_option("-o,--output", call->output, "Folder for contacts.csv and samples.csv")
      ->required();
  out->footer("Example:\n  palpate probe export acquisition.db -o csv/");
  out->callback([call, &settings] { export_csv(settings, *call); });
}

}  // namespace palpate::apps
