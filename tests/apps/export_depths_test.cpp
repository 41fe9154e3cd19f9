// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate export --png` and `--npy`: depths of range maps for other programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/depth_image.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

class ExportDepths : public ::testing::Test {
 protected:
  /// A folder of range maps: a slope in places.
  void write_range(const std::array<double, 8>& distortion = {}) {
    camera.distortion = distortion;
    sensing::write_camera(scratch / "range/rig.yaml", camera);
    for (int i = 0; i < 3; ++i) {
      z[i] = geometry::ImageF::NullaryExpr(
          camera.height, camera.width, [&](Eigen::Index row, Eigen::Index col) {
            return 600 + 10.0F * static_cast<float>(i) + 0.6237F * static_cast<float>(col - row);
          });
      z[i].block(3, 5, 4, 6).setConstant(std::nanf(""));
      geometry::write_depth_tiff(scratch / ("range/00000" + std::to_string(i) + ".tiff"), z[i]);
    }
  }
  [[nodiscard]] CommandResult exported(const std::string& input, const std::string& output,
                                       const Words& options) const {
    Words call{"export", scratch / input, "-o", scratch / output};
    call.insert(call.end(), options.begin(), options.end());
    return run_palpate(call);
  }
  /// Expects that all depths are read back within half a unit by the camera beside them.
  void expect_depths(const std::string& png, const geometry::ImageF& expected, double unit) const {
    const sensing::CameraFile file =
        sensing::read_camera_file(fs::path(scratch / png).parent_path() / "camera_intrinsic.json");
    EXPECT_EQ(file.mm_per_unit, unit);
    EXPECT_EQ(file.camera.fx, camera.fx);
    const geometry::RangeMap read =
        sensing::read_depth_image(scratch / png, file.mm_per_unit.value(), file.camera);
    EXPECT_TRUE((read.z.isNaN() == expected.isNaN()).all());
    EXPECT_LE((read.z - expected).isNaN().select(0, read.z - expected).abs().maxCoeff(),
              unit / 2 + 1e-4);
  }

  ScratchFolder scratch;
  geometry::Camera camera{
      .width = 32, .height = 24, .fx = 40.5, .fy = 41, .cx = 15.25, .cy = 11.75};
  std::array<geometry::ImageF, 3> z;
};

TEST_F(ExportDepths, OfAFolderAreReadBackWithinHalfAUnitByTheCameraBesideThem) {
  write_range();
  const CommandResult done = exported("range", "depth", {"--png"});
  ASSERT_EQ(done.status, kDone) << done.err;
  EXPECT_THAT(done.out, HasSubstr("3 range maps, units of 0.1 mm, so depths are rounded by at most "
                                  "0.05 mm (Open3D: depth_scale=10000)"));
  for (std::size_t i = 0; i < 3; ++i)
    expect_depths("depth/00000" + std::to_string(i) + ".png", z[i], 0.1);
  // Other commands know unit and camera from the file of the camera.
  const CommandResult meshed =
      run_palpate({"mesh", scratch / "depth/000001.png", "--camera",
                   scratch / "depth/camera_intrinsic.json", "-o", scratch / "surface.ply"});
  ASSERT_EQ(meshed.status, kDone) << meshed.err;
  const geometry::TriangleMesh surface = geometry::read_mesh(scratch / "surface.ply");
  EXPECT_EQ(surface.vertices.cols(), z[1].size() - 24);
  EXPECT_NEAR(surface.vertices.row(2).maxCoeff(), static_cast<double>(z[1](0, 31)), 0.051);
}

TEST_F(ExportDepths, OfOneRangeMapHaveTheNamesAndTheUnitsOfTheCall) {
  write_range();
  const CommandResult both =
      exported("range/000002.tiff", "frame", {"--png", "--npy", "--depth-unit", "0.2"});
  ASSERT_EQ(both.status, kDone) << both.err;
  expect_depths("frame.png", z[2], 0.2);
  const std::string npy = read_text(scratch / "frame.npy");
  EXPECT_EQ(npy.substr(npy.size() - sizeof(float)),
            std::string(reinterpret_cast<const char*>(&z[2](23, 31)), sizeof(float)));
  // Another one may lie beside it, but not one that the same camera file would misread.
  EXPECT_EQ(exported("range/000000.tiff", "other.png", {"--png", "--depth-unit", "0.2"}).status,
            kDone);
  EXPECT_EQ(exported("range/000000.tiff", "array.npy", {"--npy"}).status, kDone);
  const CommandResult units = exported("range/000000.tiff", "fine.png", {"--png"});
  EXPECT_EQ(units.status, kWrongCall);
  EXPECT_THAT(units.err, HasSubstr("camera_intrinsic.json: is of other units than these depths"));
  EXPECT_FALSE(fs::exists(scratch / "fine.png"));
}

TEST_F(ExportDepths, WithLensDistortionKeepTheirPixelsAndSaySoOrAreUndistorted) {
  write_range({-0.2, 0.03});
  const CommandResult raw = exported("range", "raw", {"--png"});
  ASSERT_EQ(raw.status, kDone) << raw.err;
  EXPECT_THAT(raw.out, HasSubstr("Open3D, need --undistort"));
  EXPECT_FALSE(fs::exists(scratch / "raw/camera_intrinsic.json"));
  const geometry::Camera lens = sensing::read_camera(scratch / "raw/camera.yaml");
  EXPECT_EQ(lens.distortion, camera.distortion);
  const geometry::RangeMap kept = sensing::read_depth_image(scratch / "raw/000000.png", 0.1, lens);
  EXPECT_TRUE((kept.z.isNaN() == z[0].isNaN()).all());

  const CommandResult moved = exported("range", "moved", {"--png", "--undistort", "--every", "2"});
  ASSERT_EQ(moved.status, kDone) << moved.err;
  EXPECT_FALSE(fs::exists(scratch / "moved/000001.png"));
  const sensing::CameraFile pinhole =
      sensing::read_camera_file(scratch / "moved/camera_intrinsic.json");
  const geometry::RangeMap straight =
      sensing::read_depth_image(scratch / "moved/000002.png", 0.1, pinhole.camera);
  // A point of the surface is at the same place through either camera.
  const Eigen::Vector2d ray = geometry::undistort(pinhole.camera, {4, 20});
  const Eigen::Vector2d pixel = geometry::distort(camera, ray);
  const double depth = 620 + 0.6237 * (pixel.x() - pixel.y());
  EXPECT_NEAR(static_cast<double>(straight.z(20, 4)), depth, 0.06);
  EXPECT_GT(std::abs(0.6237 * (4 - 20 - pixel.x() + pixel.y())), 0.1);  // it did move
}

TEST_F(ExportDepths, SayWhatCannotBeWritten) {
  write_range();
  geometry::write_mesh(scratch / "m.ply", {.vertices = Eigen::Matrix3d::Identity(),
                                           .triangles = Eigen::Vector3i(0, 1, 2)});
  const auto refuses = [&](const std::string& input, const Words& options,
                           const std::string& words) {
    const CommandResult refused = exported(input, "none", options);
    EXPECT_EQ(refused.status, kWrongCall);
    EXPECT_THAT(refused.err, HasSubstr(words));
    EXPECT_FALSE(fs::exists(scratch / "none"));
  };
  refuses("range", {"--png", "--depth-unit", "0.005"}, "units of 0.01 mm are long enough");
  refuses("range", {"--npy", "--depth-unit", "1"}, "--depth-unit: is for depth images (--png)");
  refuses("range", {"--png", "--undistort"}, "has no lens distortion; leave out --undistort");
  refuses("range", {"--png", "--ply"}, "is a folder of several");
  refuses("m.ply", {"--png", "--npy"}, "is no range map and no depth image");
  EXPECT_THAT(exported("range", "p.html", {"--html", "--undistort"}).err,
              HasSubstr("--undistort: is for depths"));
  ASSERT_EQ(exported("range", "depth", {"--png"}).status, kDone);
  write_text(scratch / "depth/notes.txt", "mine");
  EXPECT_THAT(exported("range", "depth", {"--png"}).err, HasSubstr("notes.txt"));
}

}  // namespace
}  // namespace palpate::apps
