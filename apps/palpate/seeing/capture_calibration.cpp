// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/rig_view_files.h"
#include "seeing/capture.h"
#include "seeing/capture_stage.h"
#include "seeing/printed_board.h"
#include "shared/call_checks.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

/// From this number of poses on, the rig is calibrated after each, to see what is still uncertain.
constexpr std::size_t kFirstCalibration = 4;
/// A calibration ignores poses with fewer corners or lit points.
constexpr Eigen::Index kLeastPoints = 8;
/// This number of poses is enough if nothing is uncertain.
constexpr std::size_t kEnoughPoses = 10;

/// Poses that determine a rig, until its calibration itself gives advice.
constexpr std::array<const char*, 12> kPoses{
    "facing the camera, in the middle of the image",
    "its left side nearer to the camera, by about 30 degrees",
    "its right side nearer to the camera, by about 30 degrees",
    "its upper side nearer to the camera, by about 30 degrees",
    "its lower side nearer to the camera, by about 30 degrees",
    "nearer, so that it fills the image, tilted by 20 degrees",
    "farther away, tilted by 30 degrees the other way",
    "in the upper left corner of the image, tilted by 20 degrees",
    "in the upper right corner of the image, tilted by 20 degrees",
    "in the lower left corner of the image, tilted by 20 degrees",
    "in the lower right corner of the image, tilted by 20 degrees",
    "turned in its plane by 45 degrees, tilted by 40 degrees"};

struct CalibrationCall {
  StageCall stage;
  PrintedBoard board;
  std::optional<std::size_t> poses;
};

/// The poses so far, and the calibration of the rig from them.
class Poses {
 public:
  Poses(const sensing::Board& printed, const sensing::ImageSize& panel)
      : printed_(printed), panel_(panel) {}

  /// Adds the poses of a folder.
  /// \throws InvalidInput if the board is not found in one, or images are missing.
  void add(const fs::path& folder) {
    const sensing::RigViewFiles files = sensing::read_rig_views({folder}, printed_, panel_);
    for (const sensing::RigView& view : files.views) check(view);
    camera_ = files.camera;
    views_.insert(views_.end(), files.views.begin(), files.views.end());
    calibrate();
  }
  [[nodiscard]] std::size_t count() const { return views_.size(); }
  [[nodiscard]] const sensing::RigView& last() const { return views_.back(); }
  /// The calibration from the poses so far; empty if they do not determine it.
  [[nodiscard]] const std::optional<sensing::RigCalibration>& rig() const { return rig_; }

  /// Instruction for the next pose of the board.
  [[nodiscard]] std::string next() const {
    if (rig_ && !rig_->advice.empty()) return "Next pose: " + rig_->advice.front() + ".";
    if (rig_ && count() >= kEnoughPoses) return "The poses are enough; one more does no harm.";
    return fmt::format("Pose {}: hold the board {}.", count() + 1,
                       kPoses.at(count() % kPoses.size()));
  }

 private:
  /// \throws InvalidInput if a pose has too few points.
  static void check(const sensing::RigView& view) {
    const auto corners = view.board.cols();
    const auto lit = view.projector.cols();
    if (corners >= kLeastPoints && lit >= kLeastPoints) return;
    throw InvalidInput(fmt::format(
        "{}: {}", view.name,
        corners < kLeastPoints
            ? std::string("the board was not found; it must be flat, sharp and as --board says, "
                          "and a chessboard must be in the image as a whole")
            : std::string("the projector does not light the board, or its image is too dark")));
  }

  void calibrate() {
    rig_.reset();
    if (count() < kFirstCalibration) return;
    try {
      rig_ = sensing::calibrate_rig(views_, camera_, panel_);
    } catch (const Error& undetermined) {
      spdlog::info("{}", undetermined.what());
    }
  }

  sensing::Board printed_;
  sensing::ImageSize panel_;
  sensing::ImageSize camera_;
  std::vector<sensing::RigView> views_;
  std::optional<sensing::RigCalibration> rig_;
};

/// Takes all images of a pose.
/// \return false if the board cannot be used as it is held.
bool take_pose(Stage& stage, const std::vector<fs::path>& shown, const fs::path& folder,
               Poses& poses) {
  std::vector<cv::Mat> images;
  for (const fs::path& image : shown) images.push_back(stage.take(image));
  write_folder(folder, {}, [&](const fs::path& inside) {
    for (std::size_t i = 0; i < shown.size(); ++i)
      sensing::write_png(inside / (shown[i].stem().string() + ".png"), images[i]);
  });
  try {
    poses.add(folder);
  } catch (const InvalidInput& unusable) {
    fs::remove_all(folder);
    spdlog::warn("{}. This pose is dropped; hold the board otherwise", unusable.what());
    return false;
  }
  std::string words = fmt::format("{} corners and {} lit points were found\n",
                                  poses.last().board.cols(), poses.last().projector.cols());
  if (poses.rig()) {
    words += fmt::format(
        "{} poses: residuals {:.3f} px (camera), {:.3f} px (projector); depths "
        "+- {:.4f} % by the rig\n",
        poses.count(), poses.rig()->camera_rms, poses.rig()->projector_rms,
        100 * poses.rig()->depth_deviation);
  }
  std::fputs(words.c_str(), stderr);
  return true;
}

/// The first name of a pose that is not taken.
fs::path next_folder(const fs::path& output) {
  for (int i = 0; true; ++i) {
    fs::path folder = output / fmt::format("pose_{:02}", i);
    if (!is_there(folder)) return folder;
  }
}

void take_poses(const Settings& settings, CalibrationCall call) {
  call.board.parse();
  const StageCall& setup = call.stage;
  const std::vector<fs::path> shown =
      images_to_show(setup.show, {"graycode_"}, {},
                     "palpate calibrate rig --draw show/ --projector-size 1024x768");
  const cv::Mat first = sensing::read_frame(shown.front());
  const sensing::ImageSize panel{first.cols, first.rows};
  check_outputs({setup.show}, {setup.output});
  Poses poses(call.board.printed, panel);
  if (is_there(next_folder(setup.output).parent_path() / "pose_00")) poses.add(setup.output);
  Stage stage(setup);
  while (!call.poses || poses.count() < *call.poses) {
    if (!operator_is_ready(poses.next() + " Keep it still.")) break;
    static_cast<void>(take_pose(stage, shown, next_folder(setup.output), poses));
  }
  stage.warn_of_clipping();
  if (poses.count() == 0) throw Error("no pose was taken");
  const std::string next =
      fmt::format("palpate calibrate rig {} {} --projector-size {}x{} -o rig.yaml",
                  setup.output.string(), call.board.options(), panel.width, panel.height);
  print(settings,
        {{"folder", setup.output.string()},
         {"camera", camera_figures(stage.camera().state())},
         {"images", poses.count() * shown.size()},
         {"poses", poses.count()},
         {"clipped", stage.most_clipped()}},
        fmt::format("{} poses in {}\nNext: {}", poses.count(), setup.output.string(), next));
}

}  // namespace

void add_capture_calibration(CLI::App& capture, const Settings& settings) {
  auto call = std::make_shared<CalibrationCall>();
  CLI::App* command =
      capture.add_subcommand("calibration", "Take poses of a board for calibrate rig");
  add_stage_options(*command, call->stage, "graycode_00.png, ... (palpate calibrate rig --draw)");
  add_board_options(*command, call->board);
  for (const char* needed : {"--board", "--square"}) command->get_option(needed)->required();
  add_number(*command, "--poses", call->poses, at_least(1), "End after this number of poses");
  command->footer(
      "Says how to hold the board, shows the Gray code, and takes one image of each, into pose_00, "
      "pose_01 and so on. A pose in which the board is not found is dropped at once. From the "
      "fourth pose on the rig is calibrated after each, and what is still uncertain decides the "
      "next pose. Poses that the folder already holds count as well.\n"
      "Example:\n  palpate capture calibration aravis:Basler-21857625 --show show/ --board 7x9 "
      "--square 25 -o poses/\n"
      "  palpate capture calibration aravis:Basler-21857625 --show show/ --board charuco:8x11 "
      "--square 20 --marker 15 -o poses/");
  command->callback([call, &settings] { take_poses(settings, *call); });
}

}  // namespace palpate::apps
