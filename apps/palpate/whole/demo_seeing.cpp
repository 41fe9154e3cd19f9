// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/demo.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/pictures/draw_mesh.h"
#include "palpate/pictures/draw_range_map.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"
#include "shared/depth_score.h"
#include "shared/map_camera.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// A frame of the bundled data, its rig, and `truth`, the common prefix of its truth images.
struct DemoFrame {
  std::string name;
  fs::path image, rig, truth;
};

Json see(const DemoFrame& frame, const sensing::Pattern& pattern,
         const sensing::TrainedColors& colors, const fs::path& output) {
  const sensing::Decoder decoder(sensing::read_rig(frame.rig), pattern, colors);
  const cv::Mat image = sensing::read_frame(frame.image);
  const auto start = std::chrono::steady_clock::now();
  const sensing::DecodeResult decoded = decoder.decode(image);
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - start;
  const geometry::RangeMap& range = decoded.range;

  const geometry::TriangleMesh mesh = geometry::mesh_range_map(range).mesh;
  geometry::write_depth_tiff(output / "range" / (frame.name + ".tiff"), range.z);
  geometry::write_mesh(output / "meshes" / (frame.name + ".ply"), mesh);
  pictures::draw_range_map(output / "pictures" / (frame.name + "_range.png"), range,
                           "Depth of " + frame.name);

  const geometry::ImageF truth = geometry::read_depth_tiff(frame.truth.string() + ".tiff");
  const geometry::PixelMask lit = read_mask(frame.truth.string() + "_lit.png", truth);
  // Shading shows errors that are small beside the object.
  const geometry::RangeMapScore score = geometry::score_range_map(range.z, truth, lit);
  pictures::draw_mesh(output / "pictures" / (frame.name + "_mesh.png"), mesh,
                      fmt::format("Mesh of {}, not smoothed: median error {:.2f} mm", frame.name,
                                  score.error.median),
                      pictures::MeshPart::object);
  Json figures = {{"frame", frame.name}};
  figures.update(score_figures(score));
  figures["triangles"] = mesh.triangles.cols();
  figures["verdict"] = sensing::to_string(sensing::judge(decoded.evidence).verdict);
  figures["ms"] = elapsed.count();
  return figures;
}

/// Meshes a depth image of another camera, whose truth is unknown.
void mesh_depth_camera(const fs::path& data, const fs::path& output) {
  const geometry::Camera camera{
      .width = 640, .height = 480, .fx = 476.007, .fy = 476.007, .cx = 313.683, .cy = 242.755};
  constexpr double kMillimetresPerUnit = 0.125;
  const geometry::TriangleMesh hand =
      geometry::mesh_range_map(
          sensing::read_depth_image(data / "depth_camera/hand.png", kMillimetresPerUnit, camera))
          .mesh;
  geometry::write_mesh(output / "meshes/hand.ply", hand);
  pictures::draw_mesh(output / "pictures/hand_mesh.png", hand,
                      "A hand in front of a torso, from a real depth camera, not smoothed",
                      pictures::MeshPart::object);
}

/// px, of each of the four images.
constexpr int kPaneWidth = 640;
constexpr int kPaneHeight = 480;

/// Draws an image into the middle of `pane`, a view of the pixels to fill, as large as it fits.
void fit_into(const cv::Mat& pane, const cv::Mat& image) {
  const double scale = std::min(static_cast<double>(pane.cols) / image.cols,
                                static_cast<double>(pane.rows) / image.rows);
  const cv::Size size(static_cast<int>(scale * image.cols), static_cast<int>(scale * image.rows));
  const cv::Rect place({(pane.cols - size.width) / 2, (pane.rows - size.height) / 2}, size);
  cv::resize(image, pane(place), size, 0, 0, cv::INTER_AREA);
}

}  // namespace

Json demo_seeing(const fs::path& data, const fs::path& output) {
  const sensing::TrainedColors colors = sensing::train_colors_from_folder(data / "training");
  sensing::write_trained_colors(output / "colors.yaml", colors);
  const sensing::Pattern pattern = sensing::read_pattern(data / "pattern.yaml");
  std::vector<DemoFrame> frames;
  for (const std::string name : {"plane", "duck", "flag_a", "flag_b"}) {
    frames.push_back(
        {name, data / "frames" / (name + ".png"), data / "rig.yaml", data / "truth" / name});
  }
  frames.push_back({"duck_verging", data / "verging/frame.png", data / "verging/rig.yaml",
                    data / "verging/truth"});

  Json figures = Json::array();
  Progress progress("seeing");
  for (const DemoFrame& frame : frames) {
    figures.push_back(see(frame, pattern, colors, output));
    progress.show(figures.size(), frames.size());
  }
  mesh_depth_camera(data, output);
  return figures;
}

void demo_overview(const fs::path& data, const fs::path& output) {
  const std::array<fs::path, 4> images = {
      data / "frames/duck.png", output / "pictures/duck_mesh.png", output / "sheet/contacts.png",
      output / "sheet/contact.png"};
  cv::Mat overview(2 * kPaneHeight, 2 * kPaneWidth, CV_8UC3, cv::Scalar::all(255));
  for (int i = 0; i < 4; ++i) {
    const cv::Rect pane(i % 2 * kPaneWidth, i / 2 * kPaneHeight, kPaneWidth, kPaneHeight);
    fit_into(overview(pane), sensing::read_frame(images.at(static_cast<std::size_t>(i))));
  }
  sensing::write_png(output / "pictures/overview.png", overview);
}

}  // namespace palpate::apps
