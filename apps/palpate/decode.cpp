// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>

#include "command_line.h"
#include "inputs.h"
#include "palpate/error.h"
#include "palpate/geometry/comparison.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/output_file.h"
#include "palpate/pictures/draw_range_map.h"
#include "palpate/probing/csv.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "progress.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

struct DecodeCall {
  std::vector<fs::path> frames;
  fs::path rig, pattern, colors, output;
  std::string meshes;
  std::vector<double> anchor;
  bool pictures = false;
};

/// What one frame came to; `error` is empty when it worked.
struct Outcome {
  std::string error;
  long pixels = 0;
  double median_depth = 0;
  double milliseconds = 0;
};

fs::path numbered(const fs::path& folder, std::size_t number, const std::string& extension) {
  return folder / fmt::format("{:06}{}", number, extension);
}

sensing::DecodeResult decode_frame(const sensing::Decoder& decoder, const cv::Mat& frame,
                                   const fs::path& path) {
  try {
    return decoder.decode(frame);
  } catch (const InvalidInput& wrong) {
    throw InvalidInput(path.string() + ": " + wrong.what());
  }
}

/// "1234 reconstructed, 56 unlit, ..."
std::string counts(const sensing::ReasonImage& reasons) {
  std::string text;
  for (int code = 0; code < sensing::kReasonCount; ++code) {
    const auto reason = static_cast<sensing::Reason>(code);
    text += fmt::format("{}{} {}", code > 0 ? ", " : "", sensing::count(reasons, reason),
                        sensing::name(reason));
  }
  return text;
}

Outcome decode_one(const sensing::Decoder& decoder, const DecodeCall& call, std::size_t number) {
  const cv::Mat frame = sensing::read_frame(call.frames[number]);
  const auto start = std::chrono::steady_clock::now();
  const sensing::DecodeResult result = decode_frame(decoder, frame, call.frames[number]);
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - start;

  spdlog::info("{}: {} stripe edges, {} regions ({} without an offset); pixels: {}",
               call.frames[number].string(), result.transitions, result.regions,
               result.unresolved_regions, counts(result.reasons));
  geometry::write_depth_tiff(numbered(call.output, number, ".tiff"), result.range.z);
  if (sensing::count(result.reasons, sensing::Reason::reconstructed) == 0) {
    spdlog::warn("{}: nothing could be reconstructed.", call.frames[number].string());
  } else if (!call.meshes.empty()) {
    const geometry::RangeMapMesh surface = geometry::mesh_range_map(result.range);
    if (surface.mesh.triangles.cols() > 0) {
      geometry::write_mesh(numbered(call.output, number, "." + call.meshes), surface.mesh);
    }
  }
  std::vector<double> depths(result.range.z.data(), result.range.z.data() + result.range.z.size());
  const geometry::ErrorStatistics statistics = geometry::error_statistics(std::move(depths));
  return {.error = {},
          .pixels = statistics.count,
          .median_depth = statistics.median,
          .milliseconds = elapsed.count()};
}

std::vector<Outcome> decode_all(const sensing::Decoder& decoder, const DecodeCall& call) {
  std::vector<Outcome> outcomes(call.frames.size());
  Progress progress("decoding");
  std::atomic<int> done = 0;
  tbb::parallel_for(std::size_t{0}, outcomes.size(), [&](std::size_t i) {
    try {
      outcomes[i] = decode_one(decoder, call, i);
    } catch (const InvalidInput& e) {
      outcomes[i].error = e.what();  // a broken frame does not stop the others
    }
    progress.show(++done, static_cast<int>(outcomes.size()));
  });
  return outcomes;
}

/// Which frame became which range map; a broken frame became none.
void write_frame_list(const DecodeCall& call, const std::vector<Outcome>& outcomes) {
  write_file(call.output / "frames.csv", [&](std::ostream& out) {
    out << "range_map,frame\n";
    for (std::size_t i = 0; i < call.frames.size(); ++i) {
      if (!outcomes[i].error.empty()) continue;
      out << numbered({}, i, ".tiff").string() << ','
          << probing::to_cell(call.frames[i].filename().string()) << '\n';
    }
  });
}

void report(const Settings& settings, const DecodeCall& call,
            const std::vector<Outcome>& outcomes) {
  nlohmann::ordered_json per_frame = nlohmann::ordered_json::array();
  std::vector<double> milliseconds;
  std::string prose;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    const std::string name = call.frames[i].filename().string();
    if (!outcome.error.empty()) {
      per_frame.push_back({{"frame", name}, {"error", outcome.error}});
      spdlog::error("{}", outcome.error);
      continue;
    }
    const fs::path map = numbered(call.output, i, ".tiff");
    milliseconds.push_back(outcome.milliseconds);
    per_frame.push_back({{"frame", name},
                         {"range_map", map.string()},
                         {"pixels", outcome.pixels},
                         {"median_depth", outcome.median_depth},
                         {"ms", outcome.milliseconds}});
    prose += fmt::format("{} -> {}: {} pixels, median depth {:.1f} mm, {:.0f} ms\n", name,
                         map.string(), outcome.pixels, outcome.median_depth, outcome.milliseconds);
  }
  const double median_ms = geometry::error_statistics(milliseconds).median;
  const nlohmann::ordered_json figures = {{"frames", outcomes.size()},
                                          {"decoded", milliseconds.size()},
                                          {"ms_per_frame", median_ms},
                                          {"per_frame", per_frame}};
  print(settings, figures,
        prose + fmt::format("{} of {} frames decoded, {:.0f} ms a frame (median).",
                            milliseconds.size(), outcomes.size(), median_ms));
}

void decode(const Settings& settings, DecodeCall call) {
  call.frames = list_frames(call.frames);
  for (const fs::path& frame : call.frames) {
    // Range maps and pictures could bear the names of frames.
    check_outputs({fs::absolute(frame).parent_path()}, {call.output});
  }
  const sensing::Rig rig = sensing::read_rig(call.rig);
  const sensing::Pattern pattern = sensing::read_pattern(call.pattern);
  sensing::TrainedColors colors;
  if (!call.colors.empty()) colors = sensing::read_trained_colors(call.colors);
  sensing::DecodeOptions options;
  if (!call.anchor.empty())
    options.anchor = sensing::Anchor{call.anchor[0], call.anchor[1], call.anchor[2]};
  const sensing::Decoder decoder(rig, pattern, colors, options);

  const std::vector<Outcome> outcomes = decode_all(decoder, call);
  const auto broken = std::count_if(outcomes.begin(), outcomes.end(),
                                    [](const Outcome& o) { return !o.error.empty(); });
  if (broken == static_cast<long>(outcomes.size())) throw FileError(outcomes.front().error);
  // A rig that lies there already is kept as it was written.
  if (fs::weakly_canonical(call.rig) != fs::weakly_canonical(call.output / "rig.yaml")) {
    sensing::write_rig(call.output / "rig.yaml", rig);
  }
  write_frame_list(call, outcomes);
  if (call.pictures) {
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      if (outcomes[i].pixels == 0) continue;
      pictures::draw_range_map(
          numbered(call.output, i, ".png"),
          load_range_map(numbered(call.output, i, ".tiff"), call.output / "rig.yaml"),
          call.frames[i].filename().string());
    }
  }
  report(settings, call, outcomes);
  if (broken > 0)
    throw Error(fmt::format("{} of {} frames could not be decoded; the others were.", broken,
                            outcomes.size()));
}

}  // namespace

void add_decode(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<DecodeCall>();
  CLI::App* command = app.add_subcommand("decode", "Camera frames become range maps, one each");
  command->add_option("FRAMES", call->frames, "Images, or folders of images")->required();
  command->add_option("--rig", call->rig, "Camera and projector (rig.yaml)")->required();
  command->add_option("--pattern", call->pattern, "What the projector shows (pattern.yaml)")
      ->required();
  command->add_option("--colors", call->colors,
                      "Trained colours (colors.yaml), for a pattern with stripes");
  command
      ->add_option("--anchor", call->anchor,
                   "u,v,z: for a pattern without stripes, a pixel [px] whose depth [mm] is known")
      ->expected(3)
      ->delimiter(',');
  command->add_option("-o,--output", call->output, "Folder for the range maps")->required();
  command->add_option("--meshes", call->meshes, "Also write each as a mesh")
      ->check(CLI::IsMember({"ply", "obj", "stl"}));
  command->add_flag("--pictures", call->pictures, "Also draw each in false colour (PNG)");
  command->footer(
      "Frames are numbered in the order of their names: 000000.tiff is the first; frames.csv lists "
      "them.\n"
      "Example:\n  palpate decode frames/ --rig rig.yaml --pattern pattern.yaml --colors "
      "colors.yaml -o range/ --meshes ply");
  command->callback([call, &settings] { decode(settings, *call); });
}

}  // namespace palpate::apps
