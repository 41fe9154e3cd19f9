// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>

#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/model_io.h"
#include "shared/command_line.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct ExportCall {
  fs::path model, output;
  bool ply = false, obj = false, json = false, cbor = false;
};

void export_model(const Settings& settings, const ExportCall& call) {
  const std::string ending = call.ply ? ".ply" : call.obj ? ".obj" : call.json ? ".json" : ".cbor";
  const fs::path output = call.output.empty() ? fs::path("model" + ending) : call.output;
  check_outputs({call.model}, {output});
  if (output.extension() != ending) {
    throw InvalidInput(output.string() + ": the output file of this format must end in " + ending +
                       ".");
  }
  const haptics::Model model = haptics::read_model(call.model);
  if (call.json) {
    haptics::write_field_document(output, model, haptics::ModelEncoding::json);
  } else if (call.cbor) {
    haptics::write_field_document(output, model, haptics::ModelEncoding::cbor);
  } else {
    geometry::write_mesh(output, model.surface);
  }
  print(settings, {{"file", output.string()}}, "Written to " + output.string());
}

}  // namespace

void add_export(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ExportCall>();
  CLI::App* command = app.add_subcommand("export", "Export the surface or the fields of a model");
  command->add_option("MODEL", call->model, "Model folder")->required();
  CLI::Option_group* format = command->add_option_group("format", "What to write");
  format->add_flag("--ply", call->ply, "The undeformed surface as PLY");
  format->add_flag("--obj", call->obj, "The undeformed surface as OBJ");
  format->add_flag("--json", call->json, "Contacts, fields and friction as one JSON document");
  format->add_flag("--cbor", call->cbor, "The same document in CBOR");
  format->require_option(1);
  command->add_option("-o,--output", call->output,
                      "File to write (default: model.ply, model.obj, ...)");
  command->footer(
      "Here --json selects the format of the file; this command prints no JSON.\n"
      "Example:\n  palpate export model/ --obj -o model.obj");
  command->callback([call, &settings] { export_model(settings, *call); });
}

}  // namespace palpate::apps
