// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "show_view.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>
#include <regex>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "shared/interrupts.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "window.h"

namespace palpate::view {
namespace {

namespace fs = std::filesystem;
using ViewClock = std::chrono::steady_clock;

constexpr double kMovieFrame = 1.0 / 30;  // [s]
constexpr double kTurnOfMovie = 10;       // [s] of a movie of what does not move

double seconds_since(ViewClock::time_point start) {
  return std::chrono::duration<double>(ViewClock::now() - start).count();
}

/// The first of pressed-1.png, pressed-2.png ... that is not there yet.
fs::path next_picture(const std::string& name) {
  for (int number = 1;; ++number) {
    fs::path png = fmt::format("{}-{}.png", name, number);
    if (!apps::is_there(png)) return png;
  }
}

/// A folder that cannot be written to is no reason to end.
void write_wished_picture(Window& window) {
  try {
    const fs::path png = next_picture("palpate-view");
    window.write_picture(png);
    std::cout << "Written to " << png.string() << std::endl;
  } catch (const OutputError& wrong) {
    spdlog::error("{}", wrong.what());
  }
}

void run_window(const ViewCall& call, Window& window, View& view) {
  const ViewClock::time_point start = ViewClock::now();
  long long frames = 0;
  double busy = 0;            // [s] in which something moved
  double busy_processor = 0;  // [s] of all processors meanwhile
  long long busy_frames = 0;
  const apps::InterruptedByThrowing interrupts;
  for (bool open = true; open; ++frames) {
    const bool moving = view.is_moving();
    const ViewClock::time_point frame = ViewClock::now();
    const std::clock_t spent = std::clock();
    open = window.run_frame();
    if (moving && view.is_moving()) {
      busy += seconds_since(frame);
      busy_processor += static_cast<double>(std::clock() - spent) / CLOCKS_PER_SEC;
      ++busy_frames;
    }
    if (window.take_picture_wish()) write_wished_picture(window);
    apps::InterruptedByThrowing::check();
    if (call.seconds && seconds_since(start) >= *call.seconds) break;
  }
  const auto all = static_cast<double>(std::max(1LL, busy_frames));
  spdlog::info(
      "{} pictures in {:.1f} s; while something moved {:.1f} a second, each with {:.1f} ms of "
      "processor time",
      frames, seconds_since(start), busy > 0 ? all / busy : 0.0, 1e3 * busy_processor / all);
}

/// Lets time go by as in a movie.
void advance_to(View& view, double seconds) {
  const auto frames = static_cast<long long>(std::floor(seconds / kMovieFrame));
  for (long long i = 0; i < frames; ++i) view.advance(kMovieFrame);
  view.advance(seconds - static_cast<double>(frames) * kMovieFrame);
}

void write_screenshot(const ViewCall& call, Window& window, View& view) {
  window.draw_frame(0);  // ImGui knows the sizes of words from the second picture on
  advance_to(view, call.seconds.value_or(view.duration()));
  window.draw_frame(0);
  window.write_picture(call.screenshot);
  std::cout << "Written to " << call.screenshot.string() << std::endl;
}

void write_movie(const ViewCall& call, Window& window, View& view) {
  if (view.duration() == 0) view.turn();
  const double length = call.seconds.value_or(view.duration() > 0 ? view.duration() : kTurnOfMovie);
  const auto count = static_cast<int>(std::floor(length / kMovieFrame)) + 1;
  static const std::regex own("[0-9]{6,}\\.png");
  write_folder(call.movie, apps::own_entries(call.movie, "000000.png", own),
               [&](const fs::path& folder) {
                 apps::Progress progress("drawing");
                 window.draw_frame(0);
                 for (int i = 0; i < count; ++i) {
                   window.draw_frame(i == 0 ? 0 : kMovieFrame);
                   window.write_picture(folder / fmt::format("{:06}.png", i));
                   progress.show(i + 1, count);
                 }
               });
  std::cout << fmt::format(
                   "{0} pictures written to {1}; a video of them:\n"
                   "  ffmpeg -framerate 30 -i {1}/%06d.png -pix_fmt yuv420p movie.mp4",
                   count, call.movie.string())
            << std::endl;
}

}  // namespace

void show_view(const ViewCall& call, const std::function<std::unique_ptr<View>()>& make_view) {
  Window window({.title = "Palpate - " + call.path.filename().string(),
                 .width = call.width,
                 .height = call.height,
                 .visible = !call.is_still()});
  const std::unique_ptr<View> view = make_view();
  window.show(*view);
  if (!call.screenshot.empty()) {
    write_screenshot(call, window, *view);
  } else if (!call.movie.empty()) {
    write_movie(call, window, *view);
  } else {
    run_window(call, window, *view);
  }
  view->close();
}

}  // namespace palpate::view
