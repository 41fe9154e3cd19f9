// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// From the images of a depth camera to meshes over time, on the bundled sequence, whose truth is
// known: cameras of other programs, recordings, selected depths, and faults in them.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string bundled(const std::string& name) { return demo("depth_sequence/" + name); }
std::string depth_image(const std::string& number) {
  return bundled("depth/0000" + number + ".png");
}

class DepthCamera : public ::testing::Test {
 protected:
  const ScratchFolder scratch;

  /// Returns the call with the bundled camera and unit, and with further arguments.
  static std::vector<std::string> with(std::vector<std::string> call,
                                       const std::vector<std::string>& more = {},
                                       const std::string& scale = "1") {
    call.insert(call.end(), {"--camera", bundled("camera.json"), "--scale", scale});
    call.insert(call.end(), more.begin(), more.end());
    return call;
  }
  static json figures(std::vector<std::string> call, int status = kDone) {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, status) << result.err;
    return result.out.empty() ? json() : json::parse(result.out);
  }
  static std::string refused(const std::vector<std::string>& call) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << result.err;
    return result.err;
  }
  std::string copied_depths() const {
    fs::copy(bundled("depth"), scratch / "depth");
    return scratch / "depth";
  }
};

TEST_F(DepthCamera, TakesTheCamerasOfOtherPrograms) {
  const std::string ply = scratch / "a.ply";
  figures(with({"mesh", depth_image("00"), "-o", ply}));
  const std::string expected = read_text(ply);
  write_text(scratch / "camera_info.yaml",
             "height: 150\nwidth: 200\ndistortion_model: plumb_bob\nD: [0, 0, 0, 0, 0]\n"
             "K: [260, 0, 99.5, 0, 260, 74.5, 0, 0, 1]\n---\n");
  write_text(scratch / "open3d.json",
             "{\"width\": 200, \"height\": 150, \"depth_scale\": 1000.0, \"intrinsic_matrix\": "
             "[260, 0, 0, 0, 260, 0, 99.5, 74.5, 1]}");
  const auto expect_same = [&](const std::vector<std::string>& camera) {
    std::vector<std::string> call = {"mesh", depth_image("00"), "-o", scratch / "b.ply"};
    call.insert(call.end(), camera.begin(), camera.end());
    figures(call);
    EXPECT_EQ(read_text(scratch / "b.ply"), expected) << camera[1];
  };
  expect_same({"--camera", scratch / "camera_info.yaml", "--scale", "1"});
  expect_same({"--rig", scratch / "open3d.json"});  // knows the unit
  expect_same({"--intrinsics", "260,260,99.5,74.5", "--scale", "1"});
  EXPECT_THAT(run_palpate({"info", scratch / "open3d.json"}).out,
              AllOf(HasSubstr("200 x 150 px"), HasSubstr("Open3D"), HasSubstr("1 mm")));
  EXPECT_THAT(run_palpate({"info", scratch / "camera_info.yaml"}).out, HasSubstr("ROS"));
  write_text(scratch / "no_model.yaml",
             "height: 150\nwidth: 200\nD: [0, 0, 0, 0, 0]\nK: [260, 0, 99.5, 0, 260, 74.5, 0, 0, "
             "1]\n");
  EXPECT_THAT(run_palpate({"info", scratch / "no_model.yaml"}).out, HasSubstr("ROS"));
  write_text(scratch / "cx.json",
             R"({"width": 200, "height": 150, "fx": 260, "fy": 260, "cx": 99.5, "cy": 74.5})");
  EXPECT_THAT(run_palpate({"info", scratch / "cx.json"}).out, HasSubstr("RealSense"));
  write_text(scratch / "other.yaml", "f: 260\n");
  EXPECT_THAT(refused({"info", scratch / "other.yaml"}),
              AllOf(HasSubstr("ROS"), HasSubstr("RealSense"), HasSubstr("Open3D")));
  write_text(scratch / "fish.yaml",
             "height: 150\nwidth: 200\ndistortion_model: equidistant\nD: [0, 0, 0, 0]\n"
             "K: [260, 0, 99.5, 0, 260, 74.5, 0, 0, 1]\n");
  EXPECT_THAT(refused({"mesh", depth_image("00"), "--camera", scratch / "fish.yaml", "--scale", "1",
                       "-o", scratch / "c.ply"}),
              AllOf(HasSubstr("fish.yaml: distortion_model: equidistant"), HasSubstr("undistort")));
}

// As in `--camera <(ros2 topic echo --once /camera/depth/camera_info)`.
TEST_F(DepthCamera, ReadsTheCameraOnceSoThatItMayComeThroughAPipe) {
  const std::string camera =
      "{\"width\": 200, \"height\": 150, \"depth_scale\": 1000.0, \"intrinsic_matrix\": "
      "[260, 0, 0, 0, 260, 0, 99.5, 74.5, 1]}";
  fs::create_directory(scratch / "depth");
  for (const std::string number : {"00", "01", "02"})
    fs::copy(depth_image(number), scratch / ("depth/0000" + number + ".png"));
  const std::string pipe = scratch / "camera";
  ASSERT_EQ(mkfifo(pipe.c_str(), S_IRUSR | S_IWUSR), 0);
  for (const std::vector<std::string>& call : std::vector<std::vector<std::string>>{
           {"mesh", scratch / "depth", "-o", scratch / "meshes", "--camera", pipe},
           {"fuse", scratch / "depth", "-o", scratch / "fused.ply", "--camera", pipe}}) {
    const std::jthread writer([&](const std::stop_token& done) {
      write_text(pipe, camera);
      while (!done.stop_requested()) {  // a second reader finds it empty
        const int again = open(pipe.c_str(), O_WRONLY | O_NONBLOCK);
        if (again >= 0) close(again);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << result.err;
  }
  figures(with({"mesh", depth_image("02"), "-o", scratch / "a.ply"}));
  EXPECT_EQ(read_text(scratch / "meshes/000002.ply"), read_text(scratch / "a.ply"));
}

TEST_F(DepthCamera, TakesTheUnitOfTheCameraBesideTheImages) {
  const std::string depths = copied_depths();
  write_text(depths + "/rig.yaml",
             "{\"width\": 200, \"height\": 150, \"depth_scale\": 1000.0, \"intrinsic_matrix\": "
             "[260, 0, 0, 0, 260, 0, 99.5, 74.5, 1]}");
  figures({"mesh", depths + "/000000.png", "-o", scratch / "a.ply"});
  figures(with({"mesh", depth_image("00"), "-o", scratch / "b.ply"}));
  EXPECT_EQ(read_text(scratch / "a.ply"), read_text(scratch / "b.ply"));
  EXPECT_THAT(refused({"mesh", depths + "/000000.png", "--intrinsics", "260,260,99.5,74.5", "-o",
                       scratch / "c.ply"}),
              HasSubstr("a depth image needs --scale"));
}

TEST_F(DepthCamera, ReadsTheLayoutOfTum) {
  fs::create_directories(scratch / "tum/depth");
  fs::create_directories(scratch / "tum/rgb");
  std::string depths = "# timestamp filename\n", colors = depths;
  for (const std::string number : {"00", "01"}) {
    // 5000 units are a metre.
    cv::Mat1w units = sensing::read_frame(depth_image(number));
    units *= 5;
    sensing::write_png(scratch / ("tum/depth/5." + number + ".png"), units);
    fs::copy(bundled("color/0000" + number + ".png"), scratch / ("tum/rgb/5.01" + number + ".png"));
    depths += "5." + number + " depth/5." + number + ".png\n";
    colors += "5.01" + number + " rgb/5.01" + number + ".png\n";
  }
  fs::copy(depth_image("02"), scratch / "tum/depth/9.png");  // is not listed
  write_text(scratch / "tum/depth.txt", depths);
  write_text(scratch / "tum/rgb.txt", colors);
  const auto made = figures({"mesh", scratch / "tum", "--camera", bundled("camera.json"),
                             "--color-images", scratch / "tum/rgb", "-o", scratch / "meshes"});
  EXPECT_EQ(made["meshes"], 2);
  EXPECT_EQ(made["per_mesh"][0]["range_map"], "5.00.png");
  figures(with(
      {"mesh", depth_image("00"), "--color-images", bundled("color"), "-o", scratch / "a.ply"}));
  EXPECT_EQ(read_text(scratch / "meshes/5.00.ply"), read_text(scratch / "a.ply"));
}

TEST_F(DepthCamera, RefusesARecordingThatListsOtherImagesAsDepths) {
  const std::string depths = copied_depths();
  write_text(scratch / "depth.txt", "0 depth/000000.png\n1 depth/000001.png\n");
  const ScratchFolder output;
  const std::vector<std::string> call = {
      "mesh", scratch.path(), "--camera", bundled("camera.json"), "-o", output / "meshes"};
  fs::copy(bundled("color/000001.png"), depths + "/000001.png",
           fs::copy_options::overwrite_existing);
  EXPECT_THAT(refused(call), AllOf(HasSubstr("000001.png: is a colour image of 8 bit"),
                                   HasSubstr("16-bit single-channel PNG")));
  EXPECT_FALSE(fs::exists(output / "meshes"));
  fs::remove(depths + "/000001.png");
  const CommandResult rest = run_palpate(call);
  EXPECT_EQ(rest.status, kWorkFailed);
  EXPECT_THAT(rest.err, HasSubstr("000001.png"));
  EXPECT_TRUE(fs::exists(output / "meshes/000000.ply"));
}

TEST_F(DepthCamera, TakesTheUnitOfTumOnlyForImagesThatAreListed) {
  const std::string depths = copied_depths();
  const std::vector<std::string> call = {
      "-v", "mesh",           depths + "/000000.png", "--camera", bundled("camera.json"),
      "-o", scratch / "a.ply"};
  write_text(scratch / "depth.txt", "The depth of the water is 3 m.\n");
  EXPECT_THAT(refused(call), HasSubstr("a depth image needs --scale"));
  write_text(scratch / "depth.txt", "0 depth/000001.png\n");
  EXPECT_THAT(refused(call), HasSubstr("a depth image needs --scale"));
  for (const char* list : {"depth.txt", "depth/depth.txt"}) {
    fs::remove(scratch / "depth.txt");
    write_text(scratch / list,
               fs::path(list).has_parent_path() ? "0 000000.png\n" : "0 depth/000000.png\n");
    const CommandResult taken = run_palpate(call);
    EXPECT_EQ(taken.status, kDone) << taken.err;
    const std::string told = "one unit is 0.2 mm";
    EXPECT_THAT(taken.err, HasSubstr(told));
    EXPECT_EQ(taken.err.find(told), taken.err.rfind(told));
  }
}

TEST_F(DepthCamera, SaysOnceThatOptionsConflict) {
  for (const std::string command : {"mesh", "track", "fuse"}) {
    const auto told = [&](const std::vector<std::string>& more) {
      const fs::path output = scratch / (command == "fuse" ? "a.ply" : "a");
      const std::string message = refused(with({command, bundled("depth"), "-o", output}, more));
      EXPECT_EQ(std::ranges::count(message, '\n'), 1) << message;
      EXPECT_FALSE(fs::exists(output));
      return message;
    };
    EXPECT_THAT(told({"--near", "900", "--far", "300"}),
                HasSubstr("--near is 900 mm; it must be less than --far"));
    EXPECT_THAT(told({"--crop", "0,0,2,1,1,1"}), HasSubstr("--crop"));
    EXPECT_THAT(told({"--mask", scratch / "none.png"}),
                HasSubstr("none.png: there is no such file"));
  }
}

TEST_F(DepthCamera, LeavesTheObjectAloneWithoutTableAndWall) {
  const auto all = figures(with({"mesh", depth_image("00"), "-o", scratch / "all.ply"}));
  figures(with({"mesh", depth_image("00"), "-o", scratch / "object.ply"},
               {"--far", "700", "--remove-plane", "3"}));
  EXPECT_GT(all["pixels"], 20'000);
  const geometry::TriangleMesh object = geometry::read_mesh(scratch / "object.ply", {}),
                               truth = geometry::read_mesh(bundled("truth/000000.ply"), {});
  const geometry::ClosestPoints closest =
      closest_points(geometry::SurfaceQuery(truth), object.vertices);
  // Table and wall are more than 10 mm from the cushion; mixed pixels at its edges may be nearer.
  const auto away = (closest.distances.array() > 10).count();
  EXPECT_GT(object.vertices.cols(), 2500);
  EXPECT_LT(static_cast<double>(away), 0.002 * static_cast<double>(object.vertices.cols()));
}

TEST_F(DepthCamera, TellsWhatLeavesOutEverythingOrNothing) {
  const auto mesh = [&](const std::vector<std::string>& more) {
    return with({"mesh", depth_image("00"), "-o", scratch / "a.ply"}, more);
  };
  EXPECT_THAT(refused(mesh({"--near", "2000"})),
              AllOf(HasSubstr("no depth is left"), HasSubstr("are nearer than --near 2000")));
  EXPECT_THAT(refused(mesh({"--crop", "0,0,0,1,1,1"})), HasSubstr("are outside --crop"));
  EXPECT_THAT(refused(mesh({"--near", "500", "--far", "400"})),
              HasSubstr("--near is 500 mm; it must be less than --far"));
  EXPECT_THAT(refused(mesh({"--crop", "0,0,2,1,1,1"})), HasSubstr("z0 < z1"));
  EXPECT_THAT(refused(mesh({"--far", "-1"})), HasSubstr("--far"));
  const CommandResult idle = run_palpate(mesh({"--near", "10", "--far", "9000"}));
  EXPECT_EQ(idle.status, kDone);
  EXPECT_THAT(idle.err, AllOf(HasSubstr("--near leaves out nothing: the nearest depth is"),
                              HasSubstr("--far leaves out nothing: the farthest depth is")));
  EXPECT_THAT(
      refused({"mesh", bundled("truth/000000.ply"), "--far", "700", "-o", scratch / "b.ply"}),
      HasSubstr("work for range maps"));
}

TEST_F(DepthCamera, TakesAMaskForAllOrForEach) {
  cv::Mat1b mask(150, 200, std::uint8_t{0});
  mask(cv::Rect(80, 50, 40, 30)) = 255;
  sensing::write_png(scratch / "mask.png", mask);
  fs::create_directory(scratch / "masks");
  fs::copy(scratch / "mask.png", scratch / "masks/000000.png");
  std::string one;
  for (const char* name : {"mask.png", "masks"}) {
    const auto made = figures(
        with({"mesh", depth_image("00"), "-o", scratch / "a.ply"}, {"--mask", scratch / name}));
    EXPECT_GT(made["vertices"], 1000);
    EXPECT_LE(made["vertices"], 1200);
    if (one.empty()) one = read_text(scratch / "a.ply");
    EXPECT_EQ(read_text(scratch / "a.ply"), one);
  }
  EXPECT_THAT(refused(with({"mesh", depth_image("01"), "-o", scratch / "b.ply"},
                           {"--mask", scratch / "masks"})),
              HasSubstr("masks/000001.png"));
  sensing::write_png(scratch / "mask.png", cv::Mat1b(10, 10, std::uint8_t{1}));
  EXPECT_THAT(refused(with({"mesh", depth_image("00"), "-o", scratch / "b.ply"},
                           {"--mask", scratch / "mask.png"})),
              HasSubstr("a mask needs the 200 x 150 px"));
}

TEST_F(DepthCamera, ProposesTheLikelyUnit) {
  const auto told = [&](const std::string& scale) {
    return refused(with({"mesh", depth_image("00"), "-o", scratch / "a.ply"}, {}, scale));
  };
  EXPECT_THAT(told("0.001"), AllOf(HasSubstr("impossible"), HasSubstr("with 1 mm, half of the")));
  EXPECT_THAT(
      run_palpate(with({"mesh", depth_image("00"), "-o", scratch / "a.ply"}, {}, "1000")).err,
      AllOf(HasSubstr("unlikely"), HasSubstr("with 1 mm, half of the")));
  EXPECT_THAT(refused({"mesh", depth_image("00"), "--camera", bundled("camera.json"), "-o",
                       scratch / "a.ply"}),
              HasSubstr("a depth image needs --scale"));
}

TEST_F(DepthCamera, KeepsTheRestIfFramesAreDamagedOrOfAnotherCamera) {
  const std::string depths = copied_depths();
  write_text(depths + "/000001.png", read_text(depth_image("01")).substr(0, 3000));
  sensing::write_png(depths + "/000002.png", cv::Mat1w(120, 160, std::uint16_t{450}));
  for (const char* number : {"04", "05", "06", "08", "09", "10", "11", "12"})
    fs::remove(depths + "/0000" + number + ".png");
  const std::vector<std::string> selected = {"--far", "700", "--remove-plane", "3"};
  const CommandResult meshed =
      run_palpate(with({"mesh", depths, "-o", scratch / "meshes"}, selected));
  EXPECT_EQ(meshed.status, kWorkFailed);
  EXPECT_THAT(meshed.err, AllOf(HasSubstr("000001.png"), HasSubstr("000002.png: is 160 x 120"),
                                HasSubstr("the colour camera if depths are aligned"),
                                HasSubstr("2 of 4 depth images could not be meshed")));
  EXPECT_TRUE(fs::exists(scratch / "meshes/000003.ply"));
  const CommandResult tracked =
      run_palpate(with({"track", depths, "--nodes", "100", "-o", scratch / "tracked"}, selected));
  EXPECT_EQ(tracked.status, kWorkFailed);
  EXPECT_THAT(tracked.err, HasSubstr("2 of 4 frames were lost (000001.png, 000002.png)"));
  EXPECT_TRUE(fs::exists(scratch / "tracked/000003.ply"));
  const json fused =
      figures(with({"fuse", depths, "-o", scratch / "fused.ply"}, selected), kWorkFailed);
  EXPECT_EQ(fused["scans"], 2);
  EXPECT_EQ(fused["broken"], json({"000001.png", "000002.png"}));
  EXPECT_THAT(refused(with({"fuse", depths + "/000000.png", depths + "/000001.png", "-o",
                            scratch / "two.ply"})),
              HasSubstr("000001.png"));
}

TEST_F(DepthCamera, SaysThatThereIsNoFrameOrOnlyOne) {
  fs::create_directories(scratch / "recording/depth");
  EXPECT_THAT(refused(with({"track", scratch / "recording", "-o", scratch / "a"})),
              HasSubstr("there is no range map in it"));
  EXPECT_THAT(refused(with({"mesh", scratch / "recording", "-o", scratch / "a"})),
              HasSubstr("pass " + (scratch / "recording/depth")));
  fs::copy(depth_image("00"), scratch / "recording/depth/000000.png");
  const CommandResult one =
      run_palpate(with({"track", scratch / "recording/depth", "-o", scratch / "tracked"}));
  EXPECT_EQ(one.status, kDone) << one.err;
  EXPECT_THAT(one.err, HasSubstr("is the only frame"));
}

/// [mm] Median distance of the vertices of the last tracked mesh from the true places of their
/// points, which are those of the first.
double tracking_error(const fs::path& tracked) {
  const auto mesh = [](const fs::path& file) { return geometry::read_mesh(file, {}); };
  const geometry::TriangleMesh first = mesh(tracked / "000000.ply"),
                               last = mesh(tracked / "000012.ply"),
                               rest = mesh(bundled("truth/000000.ply")),
                               truth = mesh(bundled("truth/000012.ply"));
  const geometry::ClosestPoints on = closest_points(geometry::SurfaceQuery(rest), first.vertices);
  std::vector<double> errors;
  for (Eigen::Index v = 0; v < first.vertices.cols(); ++v) {
    if (on.distances[v] > 3) continue;  // mixed at an edge, or table
    const Eigen::Vector3d place =
        truth.vertices(Eigen::all, truth.triangles.col(on.triangles[v])) * on.barycentric.col(v);
    errors.push_back((last.vertices.col(v) - place).norm());
  }
  std::ranges::nth_element(errors, errors.begin() + static_cast<long>(errors.size() / 2));
  return errors[errors.size() / 2];
}

TEST_F(DepthCamera, FindsTheNoiseInStillFramesAndHalvesTheErrors) {
  const std::vector<std::string> object = {"--far", "700", "--remove-plane", "3"};
  const std::vector<std::string> still = {depth_image("00"), depth_image("01"), depth_image("02"),
                                          depth_image("03")};
  const auto rms_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> call =
        with({"mesh", depth_image("00"), "-o", scratch / "mesh.ply"}, object);
    call.insert(call.end(), more.begin(), more.end());
    const json mesh = figures(call);
    if (!more.empty()) {
      // Made with 0.4 mm at 450 mm, growing with the square of the depth, and rounded to 1 mm.
      const double depth = geometry::read_mesh(scratch / "mesh.ply").vertices.row(2).mean();
      const double made = std::hypot(0.4 * std::pow(depth / 450, 2), 1 / std::sqrt(12));
      EXPECT_NEAR(mesh["depth_noise"].get<double>(), made, 0.1 * made);
    }
    return figures({"compare", scratch / "mesh.ply", bundled("truth/000000.ply")})["rms"]
        .get<double>();
  };
  std::vector<std::string> smooth = {"--smooth-depths", "--still"};
  smooth.insert(smooth.end(), still.begin(), still.end());
  EXPECT_LT(rms_of(smooth), 0.6 * rms_of({}));
  const std::vector<std::string> call =
      with({"mesh", depth_image("00"), "-o", scratch / "none.ply", "--smooth-depths"});
  EXPECT_THAT(refused(call),
              HasSubstr("pass depth images of a scene that does not move with --still"));
  smooth.pop_back();
  std::vector<std::string> few = with({"mesh", depth_image("00"), "-o", scratch / "none.ply"});
  few.insert(few.end(), smooth.begin(), smooth.end());
  EXPECT_THAT(refused(few),
              HasSubstr("at least 4 frames of a scene that does not move; there are 3"));
  EXPECT_FALSE(fs::exists(scratch / "none.ply"));
}

TEST_F(DepthCamera, TracksTheCushionByItsColours) {
  const auto tracked = figures(with(
      {"track", bundled("depth"), "--color-images", bundled("color"), "-o", scratch / "tracked"},
      {"--far", "700", "--remove-plane", "3", "--nodes", "200"}));
  EXPECT_EQ(tracked["meshes"], 12);
  // The top of the cushion moves by 20 mm; the noise of the reference is 0.4 mm.
  EXPECT_LT(tracking_error(scratch / "tracked"), 1.0);
  const geometry::MeshFile last = geometry::read_mesh_file(scratch / "tracked/000012.ply", {});
  EXPECT_TRUE(std::ranges::any_of(last.vertex_attributes,
                                  [](const auto& attribute) { return attribute.name == "red"; }));
  // Another selection is another run.
  EXPECT_THAT(run_palpate(with({"track", bundled("depth"), "--color-images", bundled("color"), "-o",
                                scratch / "tracked", "--resume"},
                               {"--far", "600", "--remove-plane", "3", "--nodes", "200"}))
                  .err,
              HasSubstr("--far"));
}

}  // namespace
}  // namespace palpate::apps
