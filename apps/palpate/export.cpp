// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "command_line.h"
#include "inputs.h"
#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/model_io.h"
#include "palpate/output_file.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct ExportCall {
  fs::path model, output;
  bool ply = false, obj = false, json = false;
};

/// The model's document as it lies in its folder, from CBOR if need be.
nlohmann::ordered_json read_document(const fs::path& model) {
  if (std::ifstream text(model / "field.json", std::ios::binary); text)
    return nlohmann::ordered_json::parse(text);
  std::ifstream binary(model / "field.cbor", std::ios::binary);
  return nlohmann::ordered_json::from_cbor(binary);
}

void export_model(const Settings& settings, const ExportCall& call) {
  const std::string ending = call.ply ? ".ply" : call.obj ? ".obj" : ".json";
  const fs::path output = call.output.empty() ? fs::path("model" + ending) : call.output;
  check_outputs({call.model}, {output});
  if (output.extension() != ending) {
    throw InvalidInput(output.string() + ": the name of this export has to end in " + ending + ".");
  }
  const haptics::Model model = haptics::read_model(call.model);
  if (call.json) {
    write_file(output,
               [&](std::ostream& out) { out << read_document(call.model).dump(1) << '\n'; });
  } else {
    geometry::write_mesh(output, model.surface);
  }
  print(settings, {{"file", output.string()}}, "Written to " + output.string());
}

}  // namespace

void add_export(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ExportCall>();
  CLI::App* command =
      app.add_subcommand("export", "A model's surface, or its fields, for other tools");
  command->add_option("MODEL", call->model, "Model folder")->required();
  CLI::Option_group* format = command->add_option_group("format", "What to write");
  format->add_flag("--ply", call->ply, "The undeformed surface as PLY");
  format->add_flag("--obj", call->obj, "The undeformed surface as OBJ");
  format->add_flag("--json", call->json, "Contacts, fields and friction as one JSON document");
  format->require_option(1);
  command->add_option("-o,--output", call->output,
                      "File to write (default: model.ply, model.obj or model.json)");
  command->footer("Example:\n  palpate export model/ --obj -o model.obj");
  command->callback([call, &settings] { export_model(settings, *call); });
}

}  // namespace palpate::apps
