// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <queue>
#include <string>
#include <thread>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "panel_window.h"
#include "shared/command_line.h"
#include "shared/program.h"
#include "shared/wrong_call.h"

namespace palpate::project {
namespace {

struct ProjectCall {
  std::string image;
  std::string monitor;
  bool follow = false;
  bool list = false;
};

void print_monitors() {
  int number = 0;
  for (const Monitor& monitor : list_monitors()) {
    fmt::print("{}: {}, {} x {} px at {}, {}\n", ++number, monitor.name, monitor.size.width,
               monitor.size.height, monitor.x, monitor.y);
  }
}

/// \throws InvalidInput with the name of the file.
void show_file(PanelWindow& window, const std::string& file) {
  const cv::Mat image = sensing::read_frame(file);
  try {
    window.show(image);
  } catch (const InvalidInput& error) {
    throw InvalidInput(file + ": " + error.what());
  }
}

/// The lines of standard input, as they come.
class Lines {
 public:
  /// The thread is left alone at the end, because it may be waiting for a line.
  static std::shared_ptr<Lines> start() {
    auto lines = std::make_shared<Lines>();
    std::thread([lines] {
      for (std::string line; std::getline(std::cin, line);) {
        const std::lock_guard lock(lines->mutex_);
        lines->waiting_.push(line);
        PanelWindow::wake();
      }
      lines->ended_ = true;
      PanelWindow::wake();
    }).detach();
    return lines;
  }
  std::optional<std::string> next() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    std::string line = std::move(waiting_.front());
    waiting_.pop();
    return line;
  }
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  std::mutex mutex_;
  std::queue<std::string> waiting_;
  std::atomic<bool> ended_ = false;
};

void say(const std::string& answer) { std::cout << answer << std::endl; }

void follow(PanelWindow& window) {
  const sensing::ImageSize& size = window.monitor().size;
  say(fmt::format("open {} {} {}", size.width, size.height, window.monitor().name));
  const std::shared_ptr<Lines> lines = Lines::start();
  while (window.wait()) {
    const bool is_last = lines->ended();
    while (const auto file = lines->next()) {
      try {
        show_file(window, *file);
        say("shown");
      } catch (const InvalidInput& error) {
        say(std::string("refused: ") + error.what());
      }
    }
    if (is_last) return;
  }
}

int run(int argc, char** argv) {
  CLI::App app("Shows an image on a projector, pixel for pixel, until Escape is pressed.",
               "palpate-project");
  app.footer(
      "The monitor is not switched: it must have the size of the image.\n"
      "With --follow the program first says \"open WIDTH HEIGHT NAME\" and then, for each file "
      "name that it reads, \"shown\" when the image is on the screen, or \"refused: \" and why.\n"
      "Examples:\n"
      "  palpate-project --list\n"
      "  palpate-project pattern/pattern.png --monitor 2\n"
      "  ls show/*.png | palpate-project --follow");
  app.set_version_flag("--version", PALPATE_VERSION);
  ProjectCall call;
  CLI::Option* image = app.add_option("IMAGE", call.image, "Image to show (PNG, TIFF, BMP)");
  app.add_option("--monitor", call.monitor,
                 "Number of the monitor, from 1, or its name (default: the last one)");
  app.add_flag("--follow", call.follow, "Show the files that standard input names, one a line")
      ->excludes(image);
  app.add_flag("--list", call.list, "List the monitors")->excludes(image);
  apps::refuse_empty_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help or version
    spdlog::error("{}", apps::describe_wrong_call(app, e));
    return apps::kProgramWrongCall;
  }
  if (call.list) {
    print_monitors();
    return apps::kProgramDone;
  }
  if (call.image.empty() && !call.follow)
    throw InvalidInput("give an image, --follow or --list; --help shows examples.");
  PanelWindow window(call.monitor);
  if (call.follow) {
    follow(window);
    return apps::kProgramDone;
  }
  show_file(window, call.image);
  while (window.wait()) {
  }
  return apps::kProgramDone;
}

}  // namespace
}  // namespace palpate::project

int main(int argc, char** argv) {
  return palpate::apps::run_program("palpate-project",
                                    [&] { return palpate::project::run(argc, argv); });
}
