// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/quantile.h"
#include "palpate/documents/document.h"
#include "palpate/geometry/cloud_normals.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/ball_placement.h"
#include "palpate/probing/placement_tables.h"
#include "palpate/probing/touch_placement.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/plausible.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

using Eigen::Vector3d;

struct PlacementCall {
  fs::path touches, surface, start, ball, output;
  MapCamera camera;
  probing::TouchPlacementOptions options;
  double ball_radius = 0;
};

/// The words for one measurement and for several.
struct MeasurementWords {
  const char* one;
  const char* many;
};
constexpr MeasurementWords kTouches{"touch", "touches"}, kBalls{"pose", "poses"};

std::string coordinates_text(const Vector3d& v, int decimals) {
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", v.x(), decimals, v.y(), decimals, v.z(),
                     decimals);
}

/// A surface, or points, in the frame of the camera.
geometry::TriangleMesh read_view(const fs::path& path, const MapCamera& camera) {
  check_is_depths(path);
  if (is_range_map(path) || is_image(path))
    return geometry::mesh_range_map(load_range_map(path, camera)).mesh;
  if (path.extension() == ".pcd") return {.vertices = geometry::read_points(path), .triangles = {}};
  return geometry::read_mesh_file(path).mesh;
}

std::optional<geometry::SeenBall> ball_in(const fs::path& path, const PlacementCall& call) {
  const geometry::TriangleMesh seen = read_view(path, call.camera);
  if (seen.triangles.cols() > 0)
    return geometry::find_ball(seen.vertices, vertex_normals(seen), call.ball_radius);
  const geometry::CloudNormals cloud =
      geometry::cloud_normals(seen.vertices, {.viewpoints = Vector3d::Zero()});
  return geometry::find_ball(seen.vertices, cloud.normals, call.ball_radius);
}

Eigen::Isometry3d read_start(const fs::path& path) {
  if (path.extension() != ".json" && !documents::is_yaml(path)) return read_pose(path);
  const probing::ArmSetup setup =
      probing::parse_arm_setup(documents::read_json_text(path), path.string());
  if (!setup.knows_pose) throw FileError(path.string() + ": has no 'pose' to start from");
  return setup.prober.T_world_base;
}

/// Warns of measurements that were left out.
void tell_left_out_measurements(const probing::ArmPlacement& placement,
                                const MeasurementWords& words, Json& warnings) {
  for (std::size_t i = 0; i < placement.residuals.size(); ++i) {
    const probing::PlacementResidual& residual = placement.residuals[i];
    if (residual.used || std::isnan(residual.distance)) continue;
    const std::string which = fmt::format("{} {}", words.one, i + 1);
    if (residual.at_border) {
      warn(warnings, "at_border", which + " is at the border of the surface, and is left out");
    } else {
      warn(warnings, "outlier",
           fmt::format("{} contradicts the others by {:.2f} mm, and is left out", which,
                       residual.distance));
    }
  }
  for (const std::string& doubt : placement.doubts) warn(warnings, "doubt", doubt);
}

std::string advice_of(const probing::ArmPlacement& placement, const MeasurementWords& words) {
  if (!placement.advice) return {};
  const probing::PlacementAdvice& advice = *placement.advice;
  return fmt::format(
      "The weakest direction is {} ({:.3f} mm): one more {} with the tip near {} mm in the frame "
      "of the arm, or {} mm in that of the camera, would reduce it to {:.3f} mm",
      advice.direction, advice.before, words.one, coordinates_text(advice.tip_base, 0),
      coordinates_text(advice.tip_camera, 0), advice.after);
}

void refuse_undetermined(const probing::ArmPlacement& placement, const MeasurementWords& words,
                         const std::string& source) {
  if (placement.determined) return;
  const std::string advice = advice_of(placement, words);
  throw SolverError(source + ": the pose of the arm is not determined: " + placement.reason +
                    (advice.empty() ? "" : ". " + advice));
}

/// \throws InvalidInput if the setup would be YAML, whose comments would be lost.
/// \throws FileError if there is a file that is not a setup.
void check_setup(const fs::path& path) {
  if (documents::is_yaml(path)) {
    throw InvalidInput("--output is " + path.string() +
                       "; the setup is written as JSON, so its name must end in .json");
  }
  if (fs::exists(path))
    static_cast<void>(probing::parse_arm_setup(documents::read_json_text(path), path.string()));
}

void write_setup(const fs::path& path, const Eigen::Isometry3d& pose) {
  const std::string before = fs::exists(path) ? documents::read_json_text(path) : "{}";
  const std::string text = probing::with_pose(before, path.string(), pose);
  write_file(path, [&](std::ostream& out) { out << text; });
}

void report(const Settings& settings, const PlacementCall& call,
            const probing::ArmPlacement& placement, const MeasurementWords& words, Json warnings,
            Json more, const std::string& more_prose) {
  Json residuals = Json::array();
  for (const probing::PlacementResidual& residual : placement.residuals)
    residuals.push_back({{"distance", number_or_null(residual.distance)}, {"used", residual.used}});
  const Vector3d turn = placement.turn_deviation() / kDegree;
  const Vector3d shift = placement.shift_deviation();
  Json figures = {{"file", call.output.string()},
                  {"pose", rows_in(placement.T_camera_base.matrix())},
                  {"centre", numbers_in(placement.centre)},
                  {"shift_deviation", numbers_in(shift)},
                  {"R_deviation_deg", numbers_in(turn)},
                  {"pose_covariance", rows_in(placement.covariance)},
                  {"rms", placement.rms},
                  {"used", placement.used},
                  {"residuals", std::move(residuals)}};
  figures.update(more);
  if (placement.advice) {
    figures["further"] = {{"tip_arm", numbers_in(placement.advice->tip_base)},
                          {"tip_camera", numbers_in(placement.advice->tip_camera)},
                          {"direction", placement.advice->direction},
                          {"deviation_before", placement.advice->before},
                          {"deviation_after", placement.advice->after}};
  } else {
    figures["further"] = nullptr;
  }
  figures["warnings"] = std::move(warnings);
  std::string prose = "pose of the arm's base in the frame of the camera [mm]:\n";
  for (int row = 0; row < 3; ++row) {
    const auto numbers = placement.T_camera_base.matrix().row(row);
    prose += fmt::format("  {:10.6f} {:10.6f} {:10.6f} {:11.4f}\n", numbers[0], numbers[1],
                         numbers[2], numbers[3]);
  }
  prose += fmt::format(
      "standard deviations: shift {} mm at {} mm of the camera, turn {} degrees\n"
      "{} of {} {} used, {:.3f} mm from where they should be (RMS)\n",
      coordinates_text(shift, 3), coordinates_text(placement.centre, 0), coordinates_text(turn, 4),
      placement.used, placement.residuals.size(), words.many, placement.rms);
  prose += more_prose;
  if (const std::string advice = advice_of(placement, words); !advice.empty())
    prose += advice + "\n";
  print(settings, figures, prose + "Written to " + call.output.string());
}

void calibrate_by_touches(const Settings& settings, PlacementCall call) {
  check_outputs({call.touches, call.surface, call.camera.rig}, {call.output});
  check_setup(call.output);
  if (!call.start.empty()) call.options.T_camera_base_start = read_start(call.start);
  const Eigen::Matrix3Xd tips = probing::read_touches(call.touches);
  const geometry::TriangleMesh surface = read_view(call.surface, call.camera);
  if (surface.triangles.cols() == 0)
    throw InvalidInput(call.surface.string() + ": has no triangles; touches need a surface");
  const probing::ArmPlacement placement = probing::place_by_touches(tips, surface, call.options);
  Json warnings = Json::array();
  tell_left_out_measurements(placement, kTouches, warnings);
  refuse_undetermined(placement, kTouches, call.touches.string());
  write_setup(call.output, placement.T_camera_base);
  report(settings, call, placement, kTouches, std::move(warnings), Json::object(), "");
}

/// Range maps of a shaded ball are wrong in proportion to 1 over its radius in pixels: 0.2 mm at
/// 1600 pixels, 0.1 mm at 8000 (docs/place-an-arm.md).
void tell_small_ball(const std::vector<probing::HeldBall>& balls, Json& warnings) {
  constexpr int kLargeBall = 5000;  // pixels
  std::vector<int> points;
  for (const probing::HeldBall& ball : balls)
    if (ball.seen) points.push_back(ball.seen->points);
  if (points.empty()) return;
  const int median = palpate::median(points);
  if (median >= kLargeBall) return;
  warn(
      warnings, "small_ball",
      fmt::format("the ball is seen with {} points (median); below {}, its shading can displace it "
                  "by more than 0.1 mm, which the standard deviations do not contain: take a "
                  "larger ball, or bring it nearer to the camera",
                  median, kLargeBall));
}

void calibrate_by_ball(const Settings& settings, const PlacementCall& call) {
  check_outputs({call.ball, call.camera.rig}, {call.output});
  check_setup(call.output);
  const std::vector<probing::SeenPose> poses = probing::read_seen_poses(call.ball);
  std::vector<probing::HeldBall> balls;
  Json warnings = Json::array();
  {
    Progress progress("finding the ball");
    for (const probing::SeenPose& pose : poses) {
      const fs::path path = call.ball.parent_path() / pose.seen;
      balls.push_back(
          {.tip = pose.tip, .R_base_tip = pose.R_base_tip, .seen = ball_in(path, call)});
      if (!balls.back().seen) {
        warn(warnings, "no_ball",
             fmt::format("{}: no ball with a radius of {:.6g} mm is seen", path.string(),
                         call.ball_radius));
      }
      progress.show(balls.size(), poses.size());
    }
  }
  const probing::BallPlacement placement = probing::place_by_ball(balls, call.ball_radius);
  tell_left_out_measurements(placement, kBalls, warnings);
  tell_small_ball(balls, warnings);
  refuse_undetermined(placement, kBalls, call.ball.string());
  write_setup(call.output, placement.T_camera_base);
  Json more = {{"ball_offset", numbers_in(placement.offset)}, {"ball_offset_deviation", nullptr}};
  std::string prose;
  if (placement.offset_deviation) {
    more["ball_offset_deviation"] = numbers_in(*placement.offset_deviation);
    prose = fmt::format("the ball's centre is {} +- {} mm from the tip, in axes of the tip\n",
                        coordinates_text(placement.offset, 3),
                        coordinates_text(*placement.offset_deviation, 3));
  }
  report(settings, call, placement, kBalls, std::move(warnings), std::move(more), prose);
}

}  // namespace

void add_calibrate_arm(CLI::App& calibrate, const Settings& settings) {
  auto call = std::make_shared<PlacementCall>();
  CLI::App* arm = calibrate.add_subcommand(
      "arm", "Find the pose of an arm's base in the camera's frame, from touches or a held ball");
  CLI::Option* touches = arm->add_option(
      "--touches", call->touches,
      "Positions of the tip while it touches the surface, in the frame of the base (CSV with x, y, "
      "z [mm])");
  CLI::Option* surface =
      arm->add_option("--surface", call->surface,
                      "What is touched, in the frame of the camera: a range map or a mesh")
          ->needs(touches);
  const std::vector<CLI::Option*> fields = add_fields(*arm, fields_of(call->options));
  for (CLI::Option* field : fields) field->needs(touches);
  CLI::Option* tip_radius = fields.front();
  arm->add_option(
         "--start", call->start,
         "Rough pose to start from: a setup with `pose` (JSON or YAML), or the 12 or 16 numbers of "
         "a matrix; without it, all poses are searched")
      ->needs(touches);
  CLI::Option* ball = arm->add_option(
      "--ball", call->ball,
      "Poses of the arm with the range map (or mesh, or points) of the ball at each, relative to "
      "this table (CSV with range_map, x, y, z [mm]; for a tip that turns also qx, qy, qz, qw)");
  ball->excludes(touches);
  CLI::Option* radius = add_number(*arm, "--ball-radius", call->ball_radius, above(0).finite(),
                                   "Radius of the ball [mm]")
                            ->needs(ball);
  add_camera_options(*arm, call->camera);
  add_required(*arm, "-o,--output", call->output,
               "Setup of the arm (arm.json) to write; one that exists keeps its other members");
  arm->footer(
      "Examples:\n"
      "  palpate calibrate arm --touches touches.csv --surface range/000000.tiff --tip-radius 3 "
      "--start rough.txt -o arm.json\n"
      "  palpate calibrate arm --ball poses.csv --ball-radius 15 -o arm.json");
  arm->callback([=, &settings] {
    if (touches->count() > 0) {
      if (surface->count() == 0 || tip_radius->count() == 0) {
        throw InvalidInput(
            "calibrate arm: --touches needs --surface and --tip-radius (0 if the positions are "
            "those of the touched points)");
      }
      calibrate_by_touches(settings, *call);
    } else if (ball->count() > 0 && radius->count() > 0) {
      calibrate_by_ball(settings, *call);
    } else {
      throw InvalidInput(
          "calibrate arm: pass --touches with --surface and --tip-radius, or --ball with "
          "--ball-radius");
    }
  });
}

}  // namespace palpate::apps
