// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/camera_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <string>
#include <thread>

#include "code_blocks.h"
#include "palpate/core/error.h"
#include "palpate/geometry/camera.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using geometry::Camera;

Camera camera_of(const std::string& text, CameraFileFormat format) {
  const ScratchFolder folder;
  const CameraFile read = read_camera_file(written(folder, "camera.txt", text));
  EXPECT_EQ(read.format, format) << text;
  return read.camera;
}

/// The message about a file that is refused; it names the file.
std::string refusal_of(const std::string& text) {
  const ScratchFolder folder;
  const auto path = written(folder, "camera.txt", text);
  std::string message = message_of<FileError>([&] { (void)read_camera_file(path); });
  EXPECT_NE(message.find("camera.txt: "), std::string::npos) << "read without a word: " << text;
  return message;
}

void expect_refused(const std::string& text, const std::string& words) {
  const std::string message = refusal_of(text);
  EXPECT_NE(message.find(words), std::string::npos) << "no '" << words << "' in " << message;
}

std::string replaced(std::string text, const std::string& old, const std::string& now) {
  text.replace(text.find(old), old.size(), now);
  return text;
}

void expect_pinhole(const Camera& camera) {
  EXPECT_EQ(camera.width, 848);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 421.5);
  EXPECT_EQ(camera.fy, 420.25);
  EXPECT_EQ(camera.cx, 424.75);
  EXPECT_EQ(camera.cy, 239.125);
}

// As str() of pyrealsense2's intrinsics gives the parts.
const std::string kRealSense = R"({
  "width": 848, "height": 480, "fx": 421.5, "fy": 420.25, "ppx": 424.75, "ppy": 239.125,
  "model": "distortion.inverse_brown_conrady", "coeffs": [0.0, 0.0, 0.0, 0.0, 0.0]
})";

// As Open3D writes it: by jsoncpp, with tabs; the matrix by columns.
const std::string kOpen3d =
    "{\n\t\"height\" : 480,\n\t\"intrinsic_matrix\" : \n\t[\n\t\t421.5,\n\t\t0.0,\n\t\t0.0,\n"
    "\t\t0.0,\n\t\t420.25,\n\t\t0.0,\n\t\t424.75,\n\t\t239.125,\n\t\t1.0\n\t],\n\t\"width\" : "
    "848\n}";

// As `rostopic echo -n 1` prints it.
const std::string kRosMessage = R"(header:
  seq: 17
  stamp:
    secs: 1662013622
    nsecs: 722922214
  frame_id: "camera_depth_optical_frame"
height: 480
width: 848
distortion_model: "plumb_bob"
D: [0.125, -0.25, 0.001, -0.002, 0.0625]
K: [421.5, 0.0, 424.75, 0.0, 420.25, 239.125, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [400.0, 0.0, 420.0, 0.0, 0.0, 400.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
roi:
  x_offset: 0
  y_offset: 0
  height: 0
  width: 0
  do_rectify: False
---
)";

// As camera_calibration writes it.
const std::string kRosFile = R"(image_width: 848
image_height: 480
camera_name: narrow
camera_matrix:
  rows: 3
  cols: 3
  data: [421.5, 0, 424.75, 0, 420.25, 239.125, 0, 0, 1]
distortion_model: rational_polynomial
distortion_coefficients:
  rows: 1
  cols: 8
  data: [0.5, -0.25, 0.001, -0.002, 0.0625, 0.75, -0.375, 0.03125]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
)";

TEST(CameraFile, ReadsTheRigWithoutAProjectorThatThePageShows) {
  const std::vector<std::string> blocks = code_blocks("docs/calibration.md", "yaml");
  ASSERT_EQ(blocks.size(), 1u);
  const Camera camera = camera_of(blocks[0], CameraFileFormat::palpate);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.fx, 600);
  EXPECT_EQ(camera.cy, 240);
}

TEST(CameraFile, IsReadBackExactly) {
  const ScratchFolder folder;
  const Camera camera{.width = 640,
                      .height = 480,
                      .fx = 600.1,
                      .fy = 1e3 / 3,
                      .cx = 319.7,
                      .cy = -12.25,
                      .distortion = {0.1, -0.2, 1e-3, -2e-3, 0.3, 0, 0, 1e-17}};
  write_camera(folder / "camera.yaml", camera);
  const CameraFile read = read_camera_file(folder / "camera.yaml");
  EXPECT_EQ(read.format, CameraFileFormat::palpate);
  EXPECT_EQ(read.camera, camera);
  EXPECT_THROW(write_camera(folder / "none.yaml", Camera{}), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.yaml"));
}

TEST(CameraFile, ReadsThePartsOfRealSenseIntrinsics) {
  const Camera camera = camera_of(kRealSense, CameraFileFormat::realsense);
  expect_pinhole(camera);
  EXPECT_EQ(camera.distortion, Camera{}.distortion);
}

TEST(CameraFile, ReadsTheDistortionModelsOfRealSenseByNameAndNumber) {
  const auto with = [](const std::string& model, const std::string& coefficients) {
    return replaced(replaced(kRealSense, "\"distortion.inverse_brown_conrady\"", model),
                    "[0.0, 0.0, 0.0, 0.0, 0.0]", coefficients);
  };
  const std::array<double, 8> all{0.125, -0.25, 0.001, -0.002, 0.0625};
  for (const char* model : {"\"distortion.brown_conrady\"", "\"Brown Conrady\"",
                            "\"RS2_DISTORTION_BROWN_CONRADY\"", "4"}) {
    const Camera camera = camera_of(with(model, "[0.125, -0.25, 0.001, -0.002, 0.0625]"),
                                    CameraFileFormat::realsense);
    EXPECT_EQ(camera.distortion, all) << model;
  }
  // Without tangential coefficients, the order of the two parts does not matter.
  const std::array<double, 8> radial{0.125, -0.25, 0, 0, 0.0625};
  EXPECT_EQ(
      camera_of(with("1", "[0.125, -0.25, 0, 0, 0.0625]"), CameraFileFormat::realsense).distortion,
      radial);
  EXPECT_EQ(
      camera_of(with("\"None\"", "[0.1, 0, 0, 0, 0]"), CameraFileFormat::realsense).distortion,
      Camera{}.distortion);

  expect_refused(with("\"distortion.inverse_brown_conrady\"", "[0.1, 0, 0, 0, 0]"),
                 "rs.align(rs.stream.depth)");
  expect_refused(with("1", "[0.1, 0, 0.001, 0, 0]"), "model: the modified Brown-Conrady");
  expect_refused(with("\"distortion.kannala_brandt4\"", "[0, 0, 0, 0, 0]"), "fisheye");
  expect_refused(with("3", "[0, 0, 0, 0, 0]"), "fisheye");
  expect_refused(with("\"barrel\"", "[0, 0, 0, 0, 0]"), "model: barrel is not known");
  expect_refused(with("4", "[0, 0, 0, 0, 0, 0]"), "coeffs: has 6 numbers");
  expect_refused(replaced(with("4", "[0.1, 0, 0, 0, 0]"), "\"model\": 4,", ""),
                 "model: is missing");
}

TEST(CameraFile, ReadsTheMatrixOfOpen3dByColumns) {
  expect_pinhole(camera_of(kOpen3d, CameraFileFormat::open3d));
  expect_pinhole(
      camera_of("{\"class_name\": \"PinholeCameraParameters\", \"extrinsic\": [1, 0, 0, "
                "0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], \"intrinsic\": " +
                    kOpen3d + "}",
                CameraFileFormat::open3d));
  expect_refused(replaced(replaced(replaced(replaced(kOpen3d, "424.75", "0.0"), "239.125", "0.0"),
                                   "0.0", "0.0"),
                          "421.5,\n\t\t0.0,\n\t\t0.0", "421.5,\n\t\t0.0,\n\t\t424.75"),
                 "is written by rows");
}

TEST(CameraFile, KnowsTheUnitOfTheDepthsThatOpen3dRecords) {
  const ScratchFolder folder;
  const auto unit = [&](const std::string& text) {
    return read_camera_file(written(folder, "intrinsic.json", text)).mm_per_unit;
  };
  EXPECT_FALSE(unit(kOpen3d));
  const std::string start = "{\n\t\"depth_scale\" : ";
  EXPECT_EQ(unit(start + "4000.0," + kOpen3d.substr(1)), 0.25);
  expect_refused(start + "0," + kOpen3d.substr(1), "depth_scale: is 0 units a metre");
}

TEST(CameraFile, IsWrittenForOpen3dAndReadBackExactly) {
  const ScratchFolder folder;
  Camera camera{.width = 640, .height = 480, .fx = 600.1, .fy = 1e3 / 3, .cx = 319.7, .cy = -12.25};
  write_open3d_camera(folder / "camera.json", camera, 0.1);
  const CameraFile read = read_camera_file(folder / "camera.json");
  EXPECT_EQ(read.format, CameraFileFormat::open3d);
  EXPECT_EQ(read.camera, camera);
  EXPECT_EQ(read.mm_per_unit, 0.1);
  EXPECT_THROW(write_open3d_camera(folder / "none.json", camera, 0), InvalidInput);
  EXPECT_THROW(write_open3d_camera(folder / "none.json", Camera{}, 1), InvalidInput);
  camera.distortion[4] = 1e-9;
  const std::string message =
      message_of<InvalidInput>([&] { write_open3d_camera(folder / "none.json", camera, 1); });
  EXPECT_NE(message.find("none.json: the camera has a lens distortion"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.json"));
}

TEST(CameraFile, ReadsMessagesAndFilesOfRos) {
  const Camera message = camera_of(kRosMessage, CameraFileFormat::ros);
  expect_pinhole(message);
  EXPECT_EQ(message.distortion, (std::array<double, 8>{0.125, -0.25, 0.001, -0.002, 0.0625}));
  std::string ros2 = kRosMessage;  // has small letters
  for (const char* key : {"D", "K", "R", "P"})
    ros2 = replaced(ros2, "\n" + std::string(key) + ":",
                    "\n" + std::string(1, static_cast<char>(*key - 'A' + 'a')) + ":");
  EXPECT_EQ(camera_of(ros2, CameraFileFormat::ros).distortion, message.distortion);
  EXPECT_EQ(camera_of(ros2 + ros2, CameraFileFormat::ros).fx, 421.5);  // prints on and on

  const Camera file = camera_of(kRosFile, CameraFileFormat::ros);
  expect_pinhole(file);
  EXPECT_EQ(file.distortion,
            (std::array<double, 8>{0.5, -0.25, 0.001, -0.002, 0.0625, 0.75, -0.375, 0.03125}));
  const std::string opencv =
      replaced(kRosFile, "distortion_model: rational_polynomial\n", "") + "avg_reprojection: 0.1\n";
  EXPECT_EQ(camera_of(opencv, CameraFileFormat::opencv).distortion, file.distortion);
}

TEST(CameraFile, TakesMissingCoefficientsForZerosOnlyIfTheModelSaysSo) {
  const std::string missing = "distortion_coefficients: is missing; write zeros";
  const auto begin = kRosFile.find("distortion_coefficients"),
             end = kRosFile.find("rectification_matrix");
  const std::string file = kRosFile.substr(0, begin) + kRosFile.substr(end);
  expect_refused(file, missing);
  expect_refused(replaced(file, "distortion_model: rational_polynomial\n", ""), missing);
  const std::string model = "\"plumb_bob\"",
                    message =
                        replaced(kRosMessage, "D: [0.125, -0.25, 0.001, -0.002, 0.0625]\n", "");
  expect_refused(message, "D: is missing; write zeros");
  for (const char* none : {"\"\"", "none"}) {
    const Camera camera = camera_of(replaced(message, model, none), CameraFileFormat::ros);
    EXPECT_EQ(camera.distortion, Camera{}.distortion);
    expect_refused(replaced(kRosMessage, model, none), "but there are distortion coefficients");
  }
}

TEST(CameraFile, RefusesWhatItCannotRepresentInWords) {
  expect_refused(replaced(kRosMessage, "\"plumb_bob\"", "\"equidistant\""),
                 "distortion_model: equidistant is that of a fisheye lens");
  expect_refused(kRosFile + "fisheye_model: 1\n", "fisheye_model: 1 is that of a fisheye lens");
  expect_refused(replaced(kRosMessage, "\"plumb_bob\"", "\"thin\""), "thin is not known");
  expect_refused(replaced(kRosMessage, "\"plumb_bob\"", "\"\""), "distortion_model: is empty");
  expect_refused(replaced(kRosMessage, "0.0625]", "0.0625, 0.1]"), "D: plumb_bob has the 5");
  expect_refused(replaced(kRosFile, "0.03125]", "0.03125, 0.1, 0, 0, 0]"), "thin-prism");
  expect_refused(replaced(kRosMessage, "binning_x: 0", "binning_x: 2"), "binning_x: binned");
  expect_refused(replaced(kRosMessage, "[421.5, 0.0,", "[421.5, 0.3,"), "a skew");
}

/// The message of ROS of a camera that sends only a part of its image.
std::string with_region(int x, int y, int width, int height) {
  const auto of = [](int value) { return std::to_string(value); };
  return replaced(kRosMessage, "  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n",
                  "  x_offset: " + of(x) + "\n  y_offset: " + of(y) + "\n  height: " + of(height) +
                      "\n  width: " + of(width) + "\n");
}

TEST(CameraFile, IsTheCameraOfThePartOfTheImageThatRosTells) {
  const Camera whole = camera_of(kRosMessage, CameraFileFormat::ros);
  const Camera part = camera_of(with_region(200, 60, 320, 240), CameraFileFormat::ros);
  EXPECT_EQ(part.width, 320);
  EXPECT_EQ(part.height, 240);
  // The ray of a pixel does not depend on where the image is cut.
  const Eigen::Vector2d place(17, 211), corner(200, 60);
  EXPECT_LT((undistort(part, place) - undistort(whole, place + corner)).norm(), 1e-12);

  const Camera upper_left = camera_of(with_region(0, 0, 320, 240), CameraFileFormat::ros);
  EXPECT_EQ(upper_left.width, 320);
  EXPECT_EQ(upper_left.height, 240);
  EXPECT_EQ(upper_left.cx, whole.cx);
  expect_pinhole(camera_of(with_region(0, 0, 848, 480), CameraFileFormat::ros));
}

TEST(CameraFile, RefusesAPartThatIsNotInTheImage) {
  expect_refused(with_region(600, 0, 320, 240), "roi: is 320 x 240 px from column 600 and row 0");
  expect_refused(with_region(0, 300, 320, 240), "must be a part of the image of 848 x 480 px");
  expect_refused(with_region(0, 12, 0, 0), "roi: is 0 x 0 px from column 0 and row 12");
  expect_refused(with_region(-3, 0, 320, 240), "roi.x_offset: is -3 px; it must be >= 0");
}

TEST(CameraFile, NamesKeysThatHoldAListInPlaceOfOneValue) {
  expect_refused(kRosFile + "fisheye_model: [0]\n", "fisheye_model: a whole number is expected");
  expect_refused(replaced(replaced(kRosMessage, "\"plumb_bob\"", "[]"),
                          "[0.125, -0.25, 0.001, -0.002, 0.0625]", "[0, 0, 0, 0, 0]"),
                 "distortion_model: a text is expected");
  expect_refused(replaced(kRealSense, "\"distortion.inverse_brown_conrady\"", "[4]"),
                 "model: the name or the number of a model is expected");
  expect_refused(replaced(kRosMessage, "binning_x: 0", "binning_x: [2]"), "binning_x: a whole");
  expect_refused(replaced(kRosMessage, "x_offset: 0", "x_offset: [8]"), "roi.x_offset: a whole");
  expect_refused(kRosFile + "roi: [8, 8, 320, 240]\n", "roi: keys and values are expected");
  expect_refused("{\"intrinsic\": [421.5, 0, 0]}", "intrinsic: keys and values are expected");
  expect_refused(replaced(kRealSense, "848", "[848]"), "width: a whole number is expected");
}

TEST(CameraFile, TellsTheFormatByKeysOnly) {
  expect_pinhole(camera_of("# unlike camera_size of a rig, in two keys\n" + kRosMessage,
                           CameraFileFormat::ros));
  expect_pinhole(
      camera_of(replaced(kRosFile, "narrow", "beside_projector_matrix"), CameraFileFormat::ros));
  const ScratchFolder folder;
  const auto is_one = [&](const std::string& text) {
    return is_camera_file(written(folder, "file.yaml", text));
  };
  for (const std::string& text : {kRealSense, kOpen3d, kRosMessage, kRosFile})
    EXPECT_TRUE(is_one(text)) << text;
  EXPECT_TRUE(is_one(read_text(demo_path("rig.yaml"))));
  EXPECT_TRUE(is_one("camera_size: many\n"));
  EXPECT_FALSE(is_one("f: 1  # no camera_size\n"));
  EXPECT_FALSE(is_one("camera:\n  fx: 1\n"));
}

TEST(CameraFile, SaysInWhichLineItIsDamaged) {
  const ScratchFolder folder;
  const auto path = written(folder, "file.yaml", "camera_size: [ 4, 3 ]\nfx: [ 1\n");
  EXPECT_NE(message_of<FileError>([&] { (void)is_camera_file(path); }).find("file.yaml: line "),
            std::string::npos);
}

TEST(CameraFiles, ReadEachFileOnce) {
  const ScratchFolder folder;
  const auto path = written(folder, "camera.json", kRealSense);
  CameraFiles files;
  expect_pinhole(files.read(path).camera);
  std::filesystem::remove(path);
  expect_pinhole(files.read(path).camera);
  EXPECT_THROW((void)files.read(folder / "other.json"), FileError);
}

TEST(CameraFile, NamesWhatIsMissingOrWrong) {
  expect_refused(replaced(kRealSense, "\"ppx\": 424.75, ", ""), "ppx: is missing");
  expect_refused(replaced(kRealSense, "\"fy\": 420.25", "\"fy\": \"much\""), "fy: a number");
  expect_refused(replaced(kRealSense, "\"fy\": 420.25", "\"fy\": -1"), "fy: is -1 px");
  expect_refused(replaced(kRealSense, "848", "0"), "width: is 0 px");
  expect_refused(replaced(kRealSense, "848", "848.5"), "width: a whole number");
  expect_refused(replaced(kOpen3d, "\"width\"", "\"breadth\""), "width: is missing");
  expect_refused(replaced(kOpen3d, "239.125,", ""), "intrinsic_matrix: has 8 numbers");
  expect_refused(replaced(kRosMessage, "K: [421.5, 0.0, 424.75, 0.0, 420.25,",
                          "K: [0.0, 0.0, 424.75, 0.0, 0.0,"),
                 "ROS writes zeros for a camera that is not calibrated");
  expect_refused(kRealSense.substr(0, 60), "not a YAML or JSON file");
  expect_refused("[1, 2]", "not a YAML or JSON file");
  expect_refused("{\"f\": 3}", "camera_size: is missing; the camera of a depth camera is");
  expect_refused(R"({"fx": 1, "fx": 2})", "fx is there twice");
}

TEST(CameraFile, ReadsRigsAndCamerasOfPalpateAlsoThroughAPipe) {
  const CameraFile rig = read_camera_file(demo_path("rig.yaml"));
  EXPECT_EQ(rig.format, CameraFileFormat::palpate);
  EXPECT_EQ(rig.camera.fx, 1100);
  const ScratchFolder folder;
  const auto pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { write_text(pipe, read_text(demo_path("rig.yaml"))); });
  EXPECT_EQ(read_camera(pipe).fx, 1100);
  writer.join();
  expect_refused(replaced(read_text(demo_path("rig.yaml")), "camera_matrix", "camera_matrlx"),
                 "camera_matrix: is missing");
}

}  // namespace
}  // namespace palpate::sensing
