// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/model_page.h"
#include "commands/play_friction.h"
#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playable.h"
#include "palpate/output_file.h"
#include "shared/command_line.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct ExportCall {
  fs::path model, output;
  std::string title;
  std::optional<double> friction;
  bool ply = false, obj = false, json = false, cbor = false, html = false;
};

std::string ending_of(const ExportCall& call) {
  if (call.ply) return ".ply";
  if (call.obj) return ".obj";
  if (call.json) return ".json";
  return call.cbor ? ".cbor" : ".html";
}

std::string name_of(const fs::path& model) {
  const fs::path whole = fs::weakly_canonical(model);
  return whole.filename().empty() ? whole.parent_path().filename().string()
                                  : whole.filename().string();
}

void write_page(const fs::path& output, haptics::Model model, const ExportCall& call) {
  haptics::check_playable(model);
  const double played =
      checked_friction(call.model, haptics::unknown_friction_count(model), call.friction);
  for (haptics::ContactModel& contact : model.contacts) {
    if (has_unknown_friction(contact)) contact.friction = played;
  }
  const std::string page = model_page(model, call.title.empty() ? name_of(call.model) : call.title);
  write_file(output, [&](std::ostream& file) { file << page; });
}

void export_model(const Settings& settings, const ExportCall& call) {
  const std::string ending = ending_of(call);
  const fs::path output = call.output.empty() ? fs::path("model" + ending) : call.output;
  check_outputs({call.model}, {output});
  if (output.extension() != ending) {
    throw InvalidInput(output.string() + ": the output file of this format must end in " + ending +
                       ".");
  }
  if (!call.html) {
    if (!call.title.empty()) throw InvalidInput("--title: is that of a page (--html)");
    if (call.friction) throw InvalidInput("--friction: is that of a page (--html)");
  }
  const haptics::Model model = haptics::read_model(call.model);
  if (call.json) {
    haptics::write_field_document(output, model, haptics::ModelEncoding::json);
  } else if (call.cbor) {
    haptics::write_field_document(output, model, haptics::ModelEncoding::cbor);
  } else if (call.html) {
    write_page(output, model, call);
  } else {
    geometry::write_mesh(output, model.surface);
  }
  print(settings, {{"file", output.string()}}, "Written to " + output.string());
}

}  // namespace

void add_export(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<ExportCall>();
  CLI::App* command = app.add_subcommand(
      "export", "Export the surface or the fields of a model, or a page to press on it");
  command->add_option("MODEL", call->model, "Model folder")->required();
  CLI::Option_group* format = command->add_option_group("format", "What to write");
  format->add_flag("--ply", call->ply, "The undeformed surface as PLY");
  format->add_flag("--obj", call->obj, "The undeformed surface as OBJ");
  format->add_flag("--json", call->json, "Contacts, fields and friction as one JSON document");
  format->add_flag("--cbor", call->cbor, "The same document in CBOR");
  format->add_flag(
      "--html", call->html,
      "A page in which one presses and drags on the object: one file, for any browser");
  format->require_option(1);
  add_friction_option(*command, call->friction);
  command->add_option("--title", call->title, "Title of the page (default: name of the folder)");
  command->add_option("-o,--output", call->output,
                      "File to write (default: model.ply, model.obj, ...)");
  command->footer(
      "Here --json selects the format of the file; this command prints no JSON.\n"
      "Example:\n  palpate export model/ --obj -o model.obj\n"
      "  palpate export model/ --html -o model.html");
  command->callback([call, &settings] { export_model(settings, *call); });
}

}  // namespace palpate::apps
