// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "rendered_scenes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/frame_source.h"

namespace palpate::bench {
namespace {

namespace fs = std::filesystem;

/// The number of frames taken from a sequence, evenly.
constexpr std::size_t kFrames = 4;

struct Kind {
  const char* frames;
  const char* rig;
  const char* training;
  bool raw;
};
constexpr Kind kKinds[] = {{"cam", "rig.yaml", "train_cam", false},
                           {"clean", "rig_ideal.yaml", "train_clean", false},
                           {"raw_cam", "rig_raw.yaml", "train_cam", true},
                           {"raw_clean", "rig_raw_ideal.yaml", "train_clean", true}};

std::vector<fs::path> sets_in(const fs::path& folder) {
  std::vector<fs::path> sets;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (fs::exists(entry.path() / "pattern.yaml")) sets.push_back(entry.path());
  }
  std::sort(sets.begin(), sets.end());
  return sets;
}

sensing::TrainedColors colors_for(const fs::path& set, const std::vector<fs::path>& sets,
                                  const char* training) {
  if (fs::exists(set / training)) return sensing::train_colors_from_folder(set / training);
  for (const fs::path& other : sets) {
    if (fs::exists(other / training)) return sensing::train_colors_from_folder(other / training);
  }
  throw FileError(set.string() + ": neither it nor a set beside it has " + training);
}

/// The larger angle of the surface's normal to the camera's and the projector's ray; 0 where the
/// neighbours belong to other bodies, which decides nothing.
double incidence(const geometry::ImageF& z, const cv::Mat& id, const Eigen::Matrix2Xd& rays,
                 const Eigen::Vector3d& light, int v, int u) {
  const auto point = [&](int row, int column) {
    const Eigen::Vector3d ray = rays.col(row * id.cols + column).homogeneous();
    return Eigen::Vector3d(ray * static_cast<double>(z(row, column)));
  };
  if (v == 0 || u == 0 || v + 1 == id.rows || u + 1 == id.cols) return 0;
  const auto body = [&](int row, int column) { return id.at<unsigned char>(row, column); };
  if (body(v, u - 1) != body(v, u + 1) || body(v - 1, u) != body(v + 1, u)) return 0;
  const Eigen::Vector3d here = point(v, u);
  const Eigen::Vector3d normal =
      (point(v, u + 1) - point(v, u - 1)).cross(point(v + 1, u) - point(v - 1, u)).normalized();
  const double cosine = std::min(std::abs(normal.dot(here.normalized())),
                                 std::abs(normal.dot((here - light).normalized())));
  return std::acos(std::min(1.0, cosine));
}

View rendered_view(const fs::path& set, const fs::path& frame, const sensing::Rig& rig) {
  const std::string name = frame.stem().string();
  View view;
  view.frame = sensing::read_frame(frame);
  view.z = geometry::read_depth_tiff(set / "truth" / (name + ".tiff"));
  const cv::Mat id = sensing::read_frame(set / "truth" / (name + "_id.png"));
  const cv::Mat lit = sensing::read_frame(set / "truth" / (name + "_lit.png"));
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(rig.camera);
  const Eigen::Vector3d light = rig.T_projector_camera.inverse() * Eigen::Vector3d::Zero();
  view.counted.resize(id.rows, id.cols);
  for (int v = 0; v < id.rows; ++v) {
    for (int u = 0; u < id.cols; ++u) {
      view.counted(v, u) = id.at<unsigned char>(v, u) > 0 && lit.at<unsigned char>(v, u) == 255 &&
                           std::isfinite(view.z(v, u)) &&
                           !(incidence(view.z, id, rays, light, v, u) > kMaxIncidence);
    }
  }
  return view;
}

}  // namespace

std::vector<Scene> rendered_scenes(const fs::path& folder) {
  const std::vector<fs::path> sets = sets_in(folder);
  if (sets.empty()) throw FileError(folder.string() + ": has no folder with a pattern.yaml");
  std::vector<Scene> scenes;
  for (const fs::path& set : sets) {
    const bool has_raw = fs::exists(set / "rig_raw.yaml");
    for (const Kind& kind : kKinds) {
      if (kind.raw != has_raw || !fs::exists(set / kind.frames)) continue;
      Scene scene{set.filename().string() + "/" + kind.frames,
                  sensing::read_rig(set / kind.rig),
                  sensing::read_pattern(set / "pattern.yaml"),
                  colors_for(set, sets, kind.training),
                  {}};
      const std::vector<fs::path> files = sensing::list_images(set / kind.frames);
      const std::size_t count = std::min(kFrames, files.size());
      for (std::size_t i = 0; i < count; ++i) {
        scene.views.push_back(rendered_view(set, files[i * files.size() / count], scene.rig));
      }
      scenes.push_back(std::move(scene));
    }
  }
  return scenes;
}

}  // namespace palpate::bench
