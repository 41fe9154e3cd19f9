// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "models/fit_report.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/reason_image.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/words.h"
#include "surfaces/describe_mesh.h"
#include "whole/describe_text.h"
#include "whole/project_record.h"

namespace palpate::apps {
namespace {

struct InfoCall {
  fs::path path;
  geometry::ReadOptions meshes;
};

/// "700.0 mm", or with four digits if it is small or huge.
std::string depth_in_words(double depth) {
  return depth >= 10 && depth < 1e9 ? fmt::format("{:.1f} mm", depth)
                                    : fmt::format("{:.4g} mm", depth);
}

Description describe_range_map(const fs::path& path) {
  const geometry::ImageF z = geometry::read_depth_tiff(path);
  const geometry::ErrorStatistics depth =
      geometry::error_statistics({z.data(), z.data() + z.size()});
  return {{{"kind", "range map"},
           {"width", z.cols()},
           {"height", z.rows()},
           {"pixels", depth.count},
           {"median", depth.median},
           {"max", depth.max}},
          fmt::format("range map, {} x {} px; ", z.cols(), z.rows()) +
              (depth.count == 0
                   ? std::string("no pixel has a depth, which is finite and above 0")
                   : fmt::format(
                         "depth known at {} ({:.1f} %), median {}, farthest {}", depth.count,
                         100.0 * static_cast<double>(depth.count) / static_cast<double>(z.size()),
                         depth_in_words(depth.median), depth_in_words(depth.max)))};
}

Description describe_sigma(const fs::path& path) {
  const geometry::ImageF sigma = geometry::read_depth_tiff(path);
  const geometry::ErrorStatistics statistics =
      geometry::error_statistics({sigma.data(), sigma.data() + sigma.size()});
  return {{{"kind", "predicted deviations"},
           {"width", sigma.cols()},
           {"height", sigma.rows()},
           {"pixels", statistics.count},
           {"median", statistics.median},
           {"max", statistics.max}},
          fmt::format("standard deviations predicted for depths{}, {} x {} px; known at {}, median "
                      "{:.4f} mm, largest {:.4f} mm",
                      is_noise(path) ? " by noise alone" : "", sigma.cols(), sigma.rows(),
                      statistics.count, statistics.median, statistics.max)};
}

Description describe_reasons(const fs::path& path) {
  const sensing::ReasonImage reasons = sensing::read_reasons(path);
  Json pixels;
  std::string prose;
  for (int code = 0; code < sensing::kReasonCount; ++code) {
    const auto reason = static_cast<sensing::Reason>(code);
    pixels[std::string(sensing::name(reason))] = sensing::count(reasons, reason);
    prose +=
        fmt::format("\n  {} {}: {}", code, sensing::name(reason), sensing::count(reasons, reason));
  }
  return {{{"kind", "reasons"},
           {"width", reasons.cols()},
           {"height", reasons.rows()},
           {"pixels", pixels}},
          fmt::format("why pixels have no depth, {} x {} px; code, reason, pixels:{}",
                      reasons.cols(), reasons.rows(), prose)};
}

/// An image that is a depth image if it comes from a depth camera.
Description describe_depth_image(const cv::Mat_<std::uint16_t>& image) {
  std::vector<double> units;
  for (const std::uint16_t value : image) {
    if (value > 0) units.push_back(value);
  }
  const geometry::ErrorStatistics known = geometry::error_statistics(units);
  return {
      {{"kind", "image"},
       {"width", image.cols},
       {"height", image.rows},
       {"channels", 1},
       {"bits", 16},
       {"pixels", known.count},
       {"median_units", known.median},
       {"max_units", known.max}},
      fmt::format("image, {} x {} px, 16-bit single-channel; as a depth image: depth known at {} "
                  "({:.1f} %), median {:.0f} units, farthest {:.0f} units",
                  image.cols, image.rows, known.count,
                  100.0 * static_cast<double>(known.count) / static_cast<double>(image.total()),
                  known.median, known.max)};
}

Description describe_image(const fs::path& path) {
  const cv::Mat image = sensing::read_frame(path);
  if (image.type() == CV_16UC1) return describe_depth_image(image);
  const int bits = image.depth() == CV_8U ? 8 : 16;
  return {{{"kind", "image"},
           {"width", image.cols},
           {"height", image.rows},
           {"channels", image.channels()},
           {"bits", bits}},
          fmt::format("image, {} x {} px, {} of {} bits", image.cols, image.rows,
                      counted(image.channels(), "channel"), bits)};
}

Description describe_acquisition(const fs::path& path) {
  const probing::CheckedAcquisition acquisition = probing::read_acquisition(path);
  const auto slipped = std::count_if(acquisition.samples().begin(), acquisition.samples().end(),
                                     [](const auto& s) { return s.slipped; });
  const auto boundary = std::count_if(acquisition.samples().begin(), acquisition.samples().end(),
                                      [](const auto& s) { return s.on_friction_boundary; });
  const auto seen = std::count_if(acquisition.samples().begin(), acquisition.samples().end(),
                                  [](const auto& s) { return s.range_map.has_value(); });
  return {{{"kind", "acquisition"},
           {"contacts", acquisition.contacts().size()},
           {"samples", acquisition.samples().size()},
           {"slipped", slipped},
           {"on_friction_boundary", boundary},
           {"range_maps", seen}},
          fmt::format("acquisition, {}, {}; {} slipped, {} are at the limit of friction{}",
                      counted(acquisition.contacts().size(), "contact"),
                      counted(acquisition.samples().size(), "sample"), slipped, boundary,
                      seen > 0 ? fmt::format(", {} name a range map", seen) : "")};
}

std::string friction_in_words(const std::vector<double>& known, int without_own, int bounds) {
  if (known.empty()) return "unknown; palpate play takes 0, or --unknown-friction";
  return fmt::format(
      "median coefficient {:.3f}; at {} contacts the measurements do not determine it; at {} of "
      "these they give a lower bound, which is used",
      geometry::error_statistics(known).median, without_own, bounds);
}

// Describes how friction depends on the load, and forces on the rate, a line for each.
std::string laws_in_words(const haptics::Model& model) {
  std::string prose;
  if (model.friction_force > 0) {
    prose += fmt::format("  friction depends on the load: coefficients are those at {:.3g} N\n",
                         model.friction_force);
  }
  for (const haptics::RateTerm& term : model.rate) {
    prose += fmt::format(
        "  rate: {:.1f} % of the force comes on top after a motion, and fades in {:.3g} s\n",
        100 * term.share, term.time);
  }
  return prose;
}

// Describes the acquisition to which a model was fitted, a line for each fact.
std::string samples_in_words(const haptics::Model& model) {
  std::string prose;
  if (model.samples_fingerprint)
    prose += fmt::format("\n  fitted to samples of the fingerprint {}", *model.samples_fingerprint);
  if (model.pressing_offsets) {
    const haptics::PressingOffsets& offsets = *model.pressing_offsets;
    prose += fmt::format(
        "\n  contacts were only pressed; taken off the samples: a force of ({:.4g}, {:.4g}, "
        "{:.4g}) N, touches {:.3g} mm below the surface, and {:.3g} % less force on the way back",
        offsets.force.x(), offsets.force.y(), offsets.force.z(), offsets.touch,
        100 * offsets.hysteresis);
  }
  return prose;
}

Description describe_model(const fs::path& path) {
  const haptics::Model model = haptics::read_model(path);
  std::vector<double> bases, rms, friction;
  int without_friction = 0, bounds = 0;
  for (const haptics::ContactModel& contact : model.contacts) {
    bases.push_back(static_cast<double>(contact.field.bases.size()));
    rms.push_back(contact.rms);
    if (!haptics::has_unknown_friction(contact)) friction.push_back(contact.friction);
    without_friction += contact.friction_source == haptics::FrictionSource::samples ? 0 : 1;
    bounds += contact.friction_source == haptics::FrictionSource::lower_bound ? 1 : 0;
  }
  const geometry::ErrorStatistics base_counts = geometry::error_statistics(bases),
                                  errors = geometry::error_statistics(rms);
  const std::optional<double> coefficient =
      friction.empty() ? std::nullopt : std::optional(geometry::error_statistics(friction).median);
  const bool is_text = is_there(path / "field.json");
  const std::uintmax_t bytes = fs::file_size(path / (is_text ? "field.json" : "field.cbor"));
  const Json made(model.made);
  Json fingerprint, offsets;
  if (model.samples_fingerprint) fingerprint = *model.samples_fingerprint;
  if (model.pressing_offsets) offsets = offsets_in_figures(*model.pressing_offsets);
  const char* triangulation = geometry::to_string(model.triangulation);
  std::string prose = fmt::format(
      "model, {} in {}, on a surface of {} vertices\n"
      "  bases of a contact: {:.0f} in the median, at most {:.0f}\n"
      "  RMS of a contact's fit: {} in the median, {} at most\n"
      "  friction coefficient: {}\n{}  measured with a ball of {}\n"
      "  {}: {} bytes, {:.0f} a contact",
      counted(model.contacts.size(), "contact"), counted(model.triangles.cols(), "triangle"),
      model.surface.vertices.cols(), base_counts.median, base_counts.max, newtons(errors.median),
      newtons(errors.max), friction_in_words(friction, without_friction, bounds),
      laws_in_words(model),
      model.probe_radius ? fmt::format("{:g} mm radius", *model.probe_radius)
                         : std::string("unknown radius"),
      is_text ? "field.json" : "field.cbor", bytes,
      static_cast<double>(bytes) / static_cast<double>(model.contacts.size()));
  if (model.response) {
    prose += fmt::format(
        "\n  the surface follows the tool as in {} recorded shapes, {:.2f} mm RMS from them",
        model.response->shape_contacts.size(), model.response->rms);
  }
  prose += samples_in_words(model) + fmt::format("\n  triangulation: {}", triangulation);
  for (const auto& [key, value] : model.made) prose += fmt::format("\n  {}: {}", key, value);
  return {{{"kind", "model"},
           {"contacts", model.contacts.size()},
           {"triangles", model.triangles.cols()},
           {"surface_vertices", model.surface.vertices.cols()},
           {"bases", {{"median", base_counts.median}, {"max", base_counts.max}}},
           {"rms", {{"median", errors.median}, {"max", errors.max}}},
           {"friction", number_or_null(coefficient)},
           {"unknown_friction", haptics::unknown_friction_count(model)},
           {"without_own_friction", without_friction},
           {"friction_lower_bounds", bounds},
           {"probe_radius", number_or_null(model.probe_radius)},
           {"triangulation", triangulation},
           {"samples_fingerprint", fingerprint},
           {"pressing_offsets", offsets},
           {"rate_terms", model.rate.size()},
           {"shapes", model.response ? model.response->shape_contacts.size() : 0},
           {"encoding", is_text ? "json" : "cbor"},
           {"bytes", bytes},
           {"made", made}},
          prose};
}

/// Describes the content of a folder of range maps and images; kinds that are missing are omitted.
std::string folder_in_words(long maps, long sigmas, long reasons, long depth_images, long images) {
  std::vector<std::string> words;
  if (maps + sigmas + reasons > 0) {
    words.push_back(fmt::format("{} ({} with deviations, {} with reasons)",
                                counted(maps, "range map"), sigmas, reasons));
  }
  if (depth_images > 0) words.push_back(counted(depth_images, "depth image") + " (16-bit PNG)");
  if (images > 0) words.push_back(counted(images, "image"));
  std::string prose = fmt::format("{}", fmt::join(words, " and "));
  if (depth_images > 0) {
    prose +=
        "; commands that read depth images need --scale, the mm of a step of their values, and "
        "--camera or --intrinsics";
  }
  return prose;
}

Description describe_folder(const fs::path& path) {
  std::error_code ignored;
  if (fs::exists(path / "field.json", ignored) || fs::exists(path / "field.cbor", ignored))
    return describe_model(path);
  if (is_there(path / "capture.jsonl")) return describe_record(path / "capture.jsonl");
  if (fs::exists(path / "sensor.yaml", ignored) && fs::is_directory(path / "frames", ignored)) {
    const std::size_t frames = list_frames({path / "frames"}).size();
    return {{{"kind", "simulation"}, {"frames", frames}},
            "simulation of " + counted(frames, "frame") + ", with the true range maps"};
  }
  int images_there = 0, meshes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    const std::string extension = entry.path().extension().string();
    images_there += is_image(entry.path()) ? 1 : 0;
    meshes += extension == ".ply" || extension == ".obj" || extension == ".stl" ? 1 : 0;
  }
  if (images_there == 0 && meshes > 0) {
    return {{{"kind", "meshes"}, {"meshes", meshes}},
            "folder of " + counted(meshes, "mesh", "meshes") + "; pass one to see what it holds"};
  }
  const std::vector<fs::path> files = list_frames({path});
  const auto all_sigmas = std::count_if(files.begin(), files.end(), is_sigma);
  const auto sigmas = all_sigmas - std::count_if(files.begin(), files.end(), is_noise);
  const auto reasons = std::count_if(files.begin(), files.end(), is_reasons);
  const auto maps = std::count_if(files.begin(), files.end(), is_range_map) - all_sigmas - reasons;
  const auto depth_images = std::count_if(files.begin(), files.end(), is_depth_image);
  const auto images = static_cast<long>(files.size()) - maps - all_sigmas - reasons - depth_images;
  return {{{"kind", "folder"},
           {"range_maps", maps},
           {"deviations", sigmas},
           {"reasons", reasons},
           {"depth_images", depth_images},
           {"images", images}},
          "folder of " + folder_in_words(maps, sigmas, reasons, depth_images, images)};
}

Description describe(const fs::path& path, const geometry::ReadOptions& options) {
  if (is_folder(path)) return describe_folder(path);
  const std::string extension = path.extension().string();
  if (is_sigma(path)) return describe_sigma(path);
  if (is_reasons(path)) return describe_reasons(path);
  if (is_range_map(path)) return describe_range_map(path);
  if (extension == ".db") return describe_acquisition(path);
  if (extension == ".yaml" || extension == ".yml") return describe_yaml(path);
  if (path.filename() == "decode.jsonl" || path.filename() == "capture.jsonl")
    return describe_record(path);
  if (extension == kProjectRecordEnding) return describe_project_record(path);
  if (extension == ".csv") return describe_csv(path);
  if (path.filename() == "field.json" || path.filename() == "field.cbor")
    return describe_model(path.parent_path());
  if (extension == ".json") return describe_yaml(path);
  if (is_image(path)) return describe_image(path);
  return describe_mesh(path, options);
}

}  // namespace

void add_info(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<InfoCall>();
  CLI::App* command = app.add_subcommand("info", "Describe a file or a folder");
  add_required(*command, "FILE", call->path, "Any file or folder that Palpate reads or writes");
  add_unit_option(*command, call->meshes);
  command->footer("Examples:\n  palpate info model/\n  cat scan.ply | palpate info /dev/stdin");
  command->callback([call, &settings] {
    const Description description = describe(call->path, call->meshes);
    print(settings, description.figures, call->path.string() + ": " + description.prose);
  });
}

}  // namespace palpate::apps
