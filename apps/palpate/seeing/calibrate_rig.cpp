// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/pictures/draw_residuals.h"
#include "palpate/sensing/board_print.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/rig_view_files.h"
#include "seeing/printed_board.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

struct RigCall {
  std::vector<fs::path> folders;
  PrintedBoard board;
  std::string projector_size;
  sensing::ImageSize projector;
  sensing::RigCalibrationOptions options;
  fs::path output, picture, draw, draw_board;
};

void draw_board(const Settings& settings, const RigCall& call) {
  if (call.draw_board.extension() != ".svg") {
    throw InvalidInput(call.draw_board.string() +
                       ": boards are SVG drawings; choose a name that ends in .svg");
  }
  sensing::write_board_print(call.draw_board, call.board.printed);
  const double width = (call.board.printed.columns + 3) * call.board.printed.square;
  const double height = (call.board.printed.rows + 3) * call.board.printed.square;
  print(settings, {{"file", call.draw_board.string()}, {"print_size", {width, height}}},
        fmt::format("Board written to {}: {:.0f} x {:.0f} mm with its margin. Print it at 100 %, "
                    "glue it onto something flat, and measure the squares",
                    call.draw_board.string(), width, height));
}

void draw_patterns(const Settings& settings, const RigCall& call) {
  const sensing::Board still = sensing::projected_board(call.projector, call.board.printed);
  int images = 0;
  // The views of the camera have the same names, so fill in only what is empty.
  write_folder(call.draw, {}, [&](const fs::path& folder) {
    images = sensing::write_projector_images(folder, call.projector, call.board.printed);
  });
  print(settings,
        {{"folder", call.draw.string()},
         {"gray_code_images", images},
         {"projected_board", {still.columns, still.rows}}},
        fmt::format("{} Gray code images and projected.png, a board of {} x {} inner corners, "
                    "written to {}",
                    images, still.columns, still.rows, call.draw.string()));
}

Json lens_figures(const geometry::Camera& lens, const sensing::CameraDeviation& deviation,
                  double rms) {
  return {{"rms", rms},
          {"fx", lens.fx},
          {"fy", lens.fy},
          {"cx", lens.cx},
          {"cy", lens.cy},
          {"distortion", std::vector<double>(lens.distortion.begin(), lens.distortion.begin() + 5)},
          {"deviation",
           {{"fx", deviation.fx},
            {"fy", deviation.fy},
            {"cx", deviation.cx},
            {"cy", deviation.cy},
            {"distortion", deviation.distortion}}}};
}

std::string lens_prose(const char* name, const geometry::Camera& lens,
                       const sensing::CameraDeviation& deviation, int terms) {
  std::string text = fmt::format(
      "{}: fx {:.1f} +- {:.1f}, fy {:.1f} +- {:.1f}, cx {:.1f} +- {:.1f}, cy {:.1f} +- {:.1f} px",
      name, lens.fx, deviation.fx, lens.fy, deviation.fy, lens.cx, deviation.cx, lens.cy,
      deviation.cy);
  constexpr std::array<const char*, 5> kNames = {"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < static_cast<std::size_t>(terms); ++i)
    text += fmt::format(", {} {:.4f} +- {:.4f}", kNames.at(i), lens.distortion.at(i),
                        deviation.distortion.at(i));
  return text + "\n";
}

void report(const Settings& settings, const RigCall& call,
            const sensing::RigCalibration& calibration) {
  const sensing::Rig& rig = calibration.rig;
  const Eigen::Vector3d t = rig.T_projector_camera.translation();
  const Eigen::Vector3d t_deviation = calibration.translation_deviation;
  const Eigen::Vector3d turn = calibration.rotation_deviation / kDegree;
  Json views = Json::array();
  Json rejected = Json::array();
  std::string prose;
  for (const sensing::ViewResiduals& view : calibration.views) {
    views.push_back({{"view", view.name},
                     {"camera_rms", view.camera_rms},
                     {"projector_rms", view.projector_rms}});
    prose += fmt::format(
        "{}: {} corners, camera {:.3f} px; {} lit points, projector {:.3f} px RMS\n", view.name,
        view.camera.cols(), view.camera_rms, view.projector.cols(), view.projector_rms);
  }
  for (const sensing::RejectedView& view : calibration.rejected) {
    rejected.push_back({{"view", view.name}, {"reason", view.reason}});
    spdlog::warn("{}: not used: {}", view.name, view.reason);
  }
  for (const std::string& advice : calibration.advice) spdlog::warn("{}", advice);
  prose +=
      fmt::format("all {} views: camera {:.3f} px, projector {:.3f} px, stereo {:.3f} px RMS\n",
                  calibration.views.size(), calibration.camera_rms, calibration.projector_rms,
                  calibration.stereo_rms);
  const int terms = call.options.distortion_terms;
  prose += lens_prose("camera", rig.camera, calibration.camera_deviation, terms);
  prose += lens_prose("projector", rig.projector, calibration.projector_deviation, terms);
  prose += fmt::format(
      "t: {:.2f} +- {:.2f}, {:.2f} +- {:.2f}, {:.2f} +- {:.2f} mm; standard deviation of R: "
      "{:.3f}, {:.3f}, {:.3f} degrees\n",
      t.x(), t_deviation.x(), t.y(), t_deviation.y(), t.z(), t_deviation.z(), turn.x(), turn.y(),
      turn.z());
  print(
      settings,
      {{"file", call.output.string()},
       {"stereo_rms", calibration.stereo_rms},
       {"camera", lens_figures(rig.camera, calibration.camera_deviation, calibration.camera_rms)},
       {"projector",
        lens_figures(rig.projector, calibration.projector_deviation, calibration.projector_rms)},
       {"t", numbers_in(t)},
       {"t_deviation", numbers_in(t_deviation)},
       {"R_deviation_deg", numbers_in(turn)},
       {"depth_deviation", calibration.depth_deviation},
       {"advice", calibration.advice},
       {"views", views},
       {"rejected", rejected}},
      prose +
          fmt::format("depths: {:.4f} % standard deviation by the rig (median at the distances of "
                      "the boards)\n",
                      100 * calibration.depth_deviation) +
          "Written to " + call.output.string());
}

void draw_picture(const fs::path& png, const sensing::RigCalibration& calibration) {
  const geometry::Camera& camera = calibration.rig.camera;
  const geometry::Camera& projector = calibration.rig.projector;
  pictures::ResidualImage seen{"camera", camera.width, camera.height, {}};
  pictures::ResidualImage shown{"projector", projector.width, projector.height, {}};
  for (const sensing::ViewResiduals& view : calibration.views) {
    seen.views.push_back({view.name, view.camera, view.camera_residual});
    shown.views.push_back({view.name, view.projector, view.projector_residual});
  }
  pictures::draw_residuals(png, {seen, shown}, "Residuals of the calibration");
}

void calibrate_rig(const Settings& settings, const RigCall& call) {
  check_outputs(call.folders, {call.output, call.picture});
  check_pictures({call.picture});
  sensing::check_rig_calibration(call.options);
  const sensing::RigViewFiles files = sensing::read_rig_views(
      call.folders, call.board.printed, call.projector, {}, shown_as("reading views"));
  const sensing::RigCalibration calibration =
      sensing::calibrate_rig(files.views, files.camera, call.projector, call.options);
  tell_doubts(
      fmt::format("{}, with squares of {:.6g} mm", call.output.string(), call.board.printed.square),
      sensing::rig_doubts(calibration.rig));
  sensing::write_rig(call.output, calibration.rig);
  if (!call.picture.empty()) draw_picture(call.picture, calibration);
  report(settings, call, calibration);
}

void run_calibrate_rig(const Settings& settings, RigCall call) {
  call.board.parse();
  if (!call.draw_board.empty()) {
    if (call.board.text.empty() || !(call.board.printed.square > 0))
      throw InvalidInput("calibrate rig: --draw-board needs --board and --square.");
    draw_board(settings, call);
    return;
  }
  if (call.projector_size.empty())
    throw InvalidInput("calibrate rig: --projector-size is missing, such as 1024x768.");
  std::tie(call.projector.width, call.projector.height) =
      parse_pair(call.projector_size, "--projector-size");
  if (!call.draw.empty()) {
    draw_patterns(settings, call);
    return;
  }
  if (call.folders.empty() || call.board.text.empty() || !(call.board.printed.square > 0) ||
      call.output.empty()) {
    throw InvalidInput(
        "calibrate rig: pass folders of views, --board, --square and -o; or --draw to write the "
        "images to project.");
  }
  calibrate_rig(settings, call);
}

}  // namespace

void add_calibrate_rig(CLI::App& calibrate, const Settings& settings) {
  auto call = std::make_shared<RigCall>();
  CLI::App* rig =
      calibrate.add_subcommand("rig", "Calibrate camera, projector and pose from views of a board");
  rig->add_option("FOLDER", call->folders,
                  "Folders of images, one per pose of the board, or a folder of such folders");
  add_board_options(*rig, call->board);
  rig->add_option("--projector-size", call->projector_size,
                  "Projector size [px], such as 1024x768");
  add_fields(*rig, fields_of(call->options));
  rig->add_option("-o,--output", call->output, "Rig file to write (rig.yaml)");
  rig->add_option("--picture", call->picture, "Also draw the residuals (PNG)");
  rig->add_option("--draw", call->draw, "Only write the images to project, into this new folder");
  rig->add_option("--draw-board", call->draw_board,
                  "Only write the board in true size, to be printed (SVG)");
  rig->footer(
      "Each pose is a folder with the camera images of the board under the projected images of "
      "--draw:\nthe Gray code sequence in its order (PNG, TIFF or JPEG). If the projector can show "
      "only one still\nimage, project projected.png onto the same plane beside the printed board; "
      "each pose then consists of\ntwo images, board.png and projected.png. Take at least ten "
      "poses, tilted by 20 to 45 degrees about\nboth axes of the board.\n"
      "Example:\n  palpate calibrate rig --draw-board board.svg --board charuco:8x11 --square 20 "
      "--marker 15\n"
      "  palpate calibrate rig --draw show/ --projector-size 1024x768\n"
      "  palpate calibrate rig poses/ --board 7x9 --square 25 --projector-size 1024x768 -o "
      "rig.yaml --picture residuals.png");
  rig->callback([call, &settings] { run_calibrate_rig(settings, *call); });
}

}  // namespace palpate::apps
