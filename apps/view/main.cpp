// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>

#include "shared/command_line.h"
#include "shared/program.h"
#include "shared/wrong_call.h"
#include "show_view.h"
#include "view_call.h"

namespace palpate::view {
namespace {

int run(int argc, char** argv) {
  CLI::App app(
      "Shows a model that one presses on with the mouse, a mesh, range maps, or an acquisition.",
      "palpate-view");
  app.footer(
      "Examples:\n"
      "  palpate-view model/                            press and hold: what the tool feels\n"
      "  palpate-view range/ --compare truth/           a sequence of range maps, and its errors\n"
      "  palpate-view acquisition.db --surface surface.ply --model model/\n"
      "  palpate-view model/ --trajectory tools.csv --screenshot pressed.png --seconds 1.5\n"
      "What keys and mouse do stands in the window, and in docs/window.md.");
  app.set_version_flag("--version", PALPATE_VERSION);
  ViewCall call;
  int verbosity = 0;
  add_options(app, call);
  app.add_flag("-v", verbosity,
               "Print how punctual the haptic loop was, and the pictures drawn per second");
  apps::refuse_empty_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help or version
    spdlog::error("{}", apps::describe_wrong_call(app, e));
    return apps::kProgramWrongCall;
  }
  spdlog::set_level(verbosity == 0 ? spdlog::level::warn : spdlog::level::info);
  const PathKind kind = kind_of(call.path);
  check_call(call, kind, app);
  show_view(call, load_view(call, kind));
  return apps::kProgramDone;
}

}  // namespace
}  // namespace palpate::view

int main(int argc, char** argv) {
  return palpate::apps::run_program("palpate-view", [&] { return palpate::view::run(argc, argv); });
}
