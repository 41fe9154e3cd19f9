// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>

#include "palpate/documents/document.h"
#include "palpate/documents/document_fields.h"
#include "palpate/documents/document_node.h"
#include "palpate/haptics/rotation.h"
#include "palpate/haptics/trajectory_file.h"
#include "scene/scene_members.h"

namespace palpate::haptics {
namespace {

using documents::DocumentNode;

const std::vector<std::string> kTool{"name", "trajectory"};
constexpr std::array<const char*, 3> kRules = {"independent", "fade", "refuse"};
constexpr int kMostFadeTicks = 1'000'000;
constexpr double kPoseOfFile = 1e-6;  // of the entries of R^T R

// Names become names of files and cells of CSV files.
std::string name_of(const DocumentNode& node, std::set<std::string>& names) {
  const std::string& name = node.at("name").text();
  const bool fits = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  if (!fits) node.at("name").refuse("letters, digits, _ and -");
  if (!names.insert(name).second) node.at("name").refuse("a name that no other has");
  return name;
}

PosePath path_of(const DocumentNode& node, SceneFile& scene, const std::filesystem::path& folder) {
  const auto pose = node.find("pose"), path = node.find("path");
  if (pose && path) pose->refuse("either 'pose' or 'path'");
  if (path) {
    scene.sources.push_back(folder / path->text());
    return read_pose_path(scene.sources.back());
  }
  PosePoint point;
  if (pose) {
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows;
    pose->read(std::span(rows.data(), static_cast<std::size_t>(rows.size())),
               "the 12 numbers of a 3 x 4 matrix, row by row");
    point.T_world_object.matrix().topRows<3>() = rows;
    if (!is_rotation(point.T_world_object.linear(), kPoseOfFile)) {
      pose->refuse("a rigid motion: its first three columns orthogonal to 1e-6 and right-handed");
    }
  }
  return PosePath({point});
}

SceneFile scene_of(const DocumentNode& root, const std::filesystem::path& folder) {
  SceneFile scene;
  root.expect_only(kSceneMembers);
  if (const auto rule = root.find("near_tools"))
    scene.options.near_tools = static_cast<NearTools>(rule->choice(kRules));
  if (const auto closest = root.find("closest_tools"))
    scene.options.closest_tools = closest->number_at_least_zero();
  if (const auto ticks = root.find("fade_ticks"))
    scene.options.fade_ticks = ticks->integer_between(1, kMostFadeTicks);
  if (const auto rate = root.find("rate")) scene.motion.rate = rate->number_above_zero();
  scene.options.tick = 1 / scene.motion.rate;

  std::set<std::string> object_names, tool_names;
  const std::vector<DocumentNode> objects = root.at("objects").items(),
                                  tools = root.at("tools").items();
  if (objects.empty()) root.at("objects").refuse("at least one object");
  if (tools.empty()) root.at("tools").refuse("at least one tool");
  for (std::size_t i = 0; i < objects.size(); ++i) {
    objects[i].expect_only(kObjectMembers);
    scene.objects.push_back(name_of(objects[i], object_names));
    scene.models.push_back(folder / objects[i].at("model").text());
    scene.motion.objects.push_back(path_of(objects[i], scene, folder));
    scene.playback.emplace_back();
    if (const auto playback = objects[i].find("playback"))
      documents::read_fields(*playback, fields_of(scene.playback.back()));
  }
  for (std::size_t i = 0; i < tools.size(); ++i) {
    tools[i].expect_only(kTool);
    scene.tools.push_back(name_of(tools[i], tool_names));
    const auto trajectory = tools[i].find("trajectory");
    scene.trajectories.push_back(trajectory ? folder / trajectory->text()
                                            : std::filesystem::path());
    if (trajectory) {
      scene.sources.push_back(scene.trajectories.back());
      scene.motion.tools.emplace_back(read_trajectory_file(scene.sources.back()));
    } else {
      scene.motion.tools.emplace_back(std::vector<TrajectoryPoint>(1));
    }
  }
  return scene;
}

}  // namespace

SceneFile read_scene(const std::filesystem::path& path) {
  const documents::Document document = documents::read_document(path);
  return documents::in_file(path.string(), [&] {
    SceneFile scene = scene_of(DocumentNode(document), path.parent_path());
    scene.sources.push_back(path);
    static_cast<void>(tick_count(scene.motion));
    return scene;
  });
}

Scene make_scene(const SceneFile& file,
                 const std::function<Model(const std::filesystem::path& folder)>& read_folder) {
  std::vector<SceneObject> objects;
  for (std::size_t i = 0; i < file.objects.size(); ++i) {
    const auto is_same = [&](std::size_t j) {
      return file.models[j].lexically_normal() == file.models[i].lexically_normal() &&
             file.playback[j] == file.playback[i];
    };
    std::size_t same = 0;
    while (same < i && !is_same(same)) ++same;
    const std::shared_ptr<const Playback> playback =
        same < i ? objects[same].playback
                 : std::make_shared<const Playback>(read_folder(file.models[i]), file.playback[i]);
    objects.push_back({file.objects[i], playback});
  }
  return Scene(std::move(objects), file.options);
}

}  // namespace palpate::haptics
