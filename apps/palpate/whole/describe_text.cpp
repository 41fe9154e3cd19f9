// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/describe_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/response.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "palpate/sensing/virtual_sensor.h"
#include "seeing/capture_files.h"
#include "seeing/decode_record.h"
#include "shared/project_file.h"
#include "shared/run_record.h"
#include "shared/words.h"
#include "whole/project_record.h"
#include "whole/run_steps.h"

namespace palpate::apps {
namespace {

Description describe_camera(const fs::path& path) {
  const sensing::CameraFile file = sensing::read_camera_file(path);
  const geometry::Camera& camera = file.camera;
  const auto terms = std::ranges::count_if(camera.distortion, [](double k) { return k != 0; });
  return {{{"kind", "camera"}, {"camera_size", {camera.width, camera.height}}},
          fmt::format("camera, {} x {} px, focal lengths {:.1f} and {:.1f} px, principal point "
                      "{:.1f}, {:.1f} px, {}, in the format of {}{}",
                      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                      terms == 0 ? "no lens distortion" : "with lens distortion",
                      sensing::name(file.format),
                      file.mm_per_unit ? fmt::format("; one unit of its depth images is {:g} mm",
                                                     *file.mm_per_unit)
                                       : "")};
}

Description describe_rig(const fs::path& path) {
  const sensing::Rig rig = sensing::read_rig(path);
  const double baseline = rig.T_projector_camera.translation().norm();
  return {
      {{"kind", "rig"},
       {"camera_size", {rig.camera.width, rig.camera.height}},
       {"projector_size", {rig.projector.width, rig.projector.height}},
       {"baseline", baseline}},
      fmt::format("rig, camera {} x {} px, projector {} x {} px, {:.1f} mm apart", rig.camera.width,
                  rig.camera.height, rig.projector.width, rig.projector.height, baseline)};
}

Description describe_pattern(const fs::path& path) {
  const sensing::Pattern pattern = sensing::read_pattern(path);
  const char* const axis = pattern.axis == sensing::Axis::x ? "x" : "y";
  if (pattern.multishot) {
    const std::size_t shifts = pattern.multishot->shifts.size();
    const int bits = pattern.multishot->code_bits;
    return {
        {{"kind", "pattern"},
         {"shifts", shifts},
         {"code_bits", bits},
         {"period_px", pattern.period}},
        fmt::format("pattern for a static scene, {} images: {} shifted sinusoids of "
                    "{} px along {}, then {} of a Gray code",
                    shifts + static_cast<std::size_t>(bits), shifts, pattern.period, axis, bits)};
  }
  return {{{"kind", "pattern"},
           {"colors", pattern.colors.size()},
           {"stripes", pattern.stripes.size()},
           {"period_px", pattern.period}},
          fmt::format("pattern, {} stripes of {} colours, a sinusoid of {} px along {}",
                      pattern.stripes.size(), pattern.colors.size(), pattern.period, axis)};
}

Description describe_colors(const fs::path& path) {
  const sensing::TrainedColors trained = sensing::read_trained_colors(path);
  return {{{"kind", "trained colors"}, {"colors", trained.colors.size()}},
          fmt::format("trained colours, {} of them", trained.colors.size())};
}

Description describe_sensor(const fs::path& path) {
  const sensing::VirtualSensor sensor = sensing::read_virtual_sensor(path);
  return {{{"kind", "virtual sensor"},
           {"bits", sensor.bits},
           {"full_well", sensor.full_well},
           {"read_noise", sensor.read_noise},
           {"camera_blur_px", sensor.camera_blur_px}},
          fmt::format("virtual sensor, {} bit, {} electrons at full scale, read noise {}, blur of "
                      "{} px",
                      sensor.bits, sensor.full_well, sensor.read_noise, sensor.camera_blur_px)};
}

Description describe_response(const fs::path& path) {
  const sensing::Response response = sensing::read_response(path);
  std::vector<double> gammas;
  std::string prose;
  for (const sensing::ResponseCurve& curve : response.channels) {
    gammas.push_back(curve.gamma);
    prose += fmt::format("{} {:.3f}", prose.empty() ? "" : ",", curve.gamma);
  }
  return {{{"kind", "response"}, {"channels", response.channels.size()}, {"gamma", gammas}},
          fmt::format("response of projector and camera, {}, exponents{}",
                      counted(response.channels.size(), "channel"), prose)};
}

Description describe_recording(const fs::path& path) {
  const RunRecord record =
      read_run_record(path, "Give the capture.jsonl that palpate capture has written");
  std::uint64_t taken = 0;
  double seconds = 0;
  std::string camera;
  try {
    camera = record.head.at("camera").at("name");
    for (const Json& frame : record.items) {
      taken = std::max(taken, frame.at("number").get<std::uint64_t>() + 1);
      seconds = std::max(seconds, frame.at("time_s").get<double>());
    }
  } catch (const nlohmann::json::exception& error) {
    throw FileError(fmt::format("{}: this is not a record of palpate capture ({}).", path.string(),
                                error.what()));
  }
  const std::size_t frames = record.items.size();
  const std::uint64_t lost = taken > frames ? taken - frames : 0;
  return {{{"kind", "recording"}, {"frames", frames}, {"frames_lost", lost}, {"seconds", seconds}},
          fmt::format("recording of {} frames in {:.3f} s by {}; {} were lost", frames, seconds,
                      camera, lost == 0 ? "none" : std::to_string(lost))};
}

/// Returns true if the text of a YAML file has a section of a project.
bool is_project(const std::string& text) {
  return std::ranges::any_of(project_steps(), [&](const ProjectStep& step) {
    return text.starts_with(step.name + ":") || text.find("\n" + step.name + ":") != text.npos;
  });
}

Description describe_project(const fs::path& path) {
  std::vector<std::string> names;
  for (const ProjectSection& section : read_project(path).sections) names.push_back(section.name);
  return {{{"kind", "project"}, {"steps", names}},
          fmt::format("project of {} steps: {}; 'palpate run --dry-run' says which are to be done",
                      names.size(), fmt::join(names, ", "))};
}

}  // namespace

Description describe_record(const fs::path& path) {
  if (path.filename() == kCaptureRecord) return describe_recording(path);
  const std::size_t frames = count_finished_frames(path);
  return {{{"kind", "record of decode"}, {"frames", frames}},
          fmt::format("frames that palpate decode has finished in this folder: {}", frames)};
}

Description describe_yaml(const fs::path& path) {
  const std::string text = read_input_file(path);
  if (text.find("projector_matrix") != std::string::npos) return describe_rig(path);
  if (text.find("period_px") != std::string::npos) return describe_pattern(path);
  if (text.find("gamma_deviation") != std::string::npos) return describe_response(path);
  if (text.find("variance") != std::string::npos) return describe_colors(path);
  if (text.find("read_noise") != std::string::npos) return describe_sensor(path);
  if (is_project(text)) return describe_project(path);
  if (sensing::is_camera_file(path)) return describe_camera(path);
  throw FileError(
      path.string() +
      ": neither a rig (projector_matrix), nor a camera (of Palpate, OpenCV, ROS, RealSense or "
      "Open3D), nor a pattern (period_px), nor trained colours (variance), nor a response "
      "(gamma_deviation), nor a virtual sensor (read_noise), nor a project (sections such as "
      "decode, fit).");
}

Description describe_csv(const fs::path& path) {
  const std::string text = read_input_file(path);
  const std::string header = text.substr(0, text.find_first_of("\r\n"));
  if (text.empty()) throw FileError(path.string() + ": is empty.");
  const auto lines =
      std::count(text.begin(), text.end(), '\n') + (text.empty() || text.back() == '\n' ? 0 : 1);
  const std::pair<const char*, const char*> kinds[] = {{"id,x,y,z,nx,ny,nz", "contacts"},
                                                       {"id,contact,group_id", "samples"},
                                                       {"cx,cy,cz,dx,dy,dz,fx,fy,fz", "queries"},
                                                       {"t,x,y,z,cx,cy,cz,fx,fy,fz,state", "trace"},
                                                       {"t,x,y,z", "trajectory"}};
  for (const auto& [start, kind] : kinds) {
    if (header.starts_with(start)) {
      return {{{"kind", kind}, {"rows", lines - 1}},
              fmt::format("{}, {} rows: {}", kind, lines - 1, header)};
    }
  }
  return {{{"kind", "table"}, {"rows", lines - 1}},
          fmt::format("a table unknown to Palpate, {} rows: {}", lines - 1, header)};
}

Description describe_project_record(const fs::path& path) {
  std::vector<std::string> done, begun;
  const ProjectRecord record(path);
  for (const auto& [name, step] : record.steps())
    (step.state == StepState::done ? done : begun).push_back(name);
  std::string prose = fmt::format("record of palpate run; done: {}", fmt::join(done, ", "));
  if (!begun.empty()) prose += fmt::format("; begun: {}", fmt::join(begun, ", "));
  return {{{"kind", "record of run"}, {"steps", done}}, prose};
}

}  // namespace palpate::apps
