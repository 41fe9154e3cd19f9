// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;

Rig awkward_rig() {
  Rig rig;
  rig.camera = {.width = 641, .height = 479, .fx = 1100.1, .fy = 1099.7, .cx = 319.3, .cy = 240.9};
  rig.camera.distortion = {0.1, -0.2, 1e-3, -2e-3, 0.3, 0.01, 0.02, -0.03};
  rig.projector = {
      .width = 1024, .height = 768, .fx = 1500.3, .fy = 1499.1, .cx = 511.7, .cy = 1.0 / 3};
  rig.T_projector_camera.linear() =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  rig.T_projector_camera.translation() = Eigen::Vector3d(150.1, -20.0 / 3, 1e-7);
  rig.red = {.alpha = 0.999, .beta = 1.0006, .gamma = 2e-4};
  rig.color_mixing(1, 0) = 0.125;
  rig.blue = {.alpha = 1.0014, .beta = 0.999, .gamma = -1.5e-4};
  return rig;
}

TEST(Rig, IsWrittenAsYamlThatStricterReadersTake) {
  const ScratchFolder folder;
  write_rig(folder / "rig.yaml", awkward_rig());
  const std::string text = read_text(folder / "rig.yaml");
  // A colon without a space after it belongs to the key.
  EXPECT_NE(text.find("alpha: "), std::string::npos);
  EXPECT_EQ(text.find("alpha:0"), std::string::npos);
  EXPECT_EQ(text.find("alpha:1"), std::string::npos);
}

TEST(Rig, SurvivesWritingAndReadingExactly) {
  const ScratchFolder folder;
  const Rig rig = awkward_rig();
  write_rig(folder / "rig.yaml", rig);
  const Rig again = read_rig(folder / "rig.yaml");
  EXPECT_EQ(rig.camera, again.camera);
  EXPECT_EQ(rig.projector, again.projector);
  EXPECT_EQ(rig.T_projector_camera.matrix(), again.T_projector_camera.matrix());
  EXPECT_EQ(rig.red.alpha, again.red.alpha);
  EXPECT_EQ(rig.red.gamma, again.red.gamma);
  EXPECT_EQ(rig.color_mixing, again.color_mixing);
  EXPECT_EQ(rig.blue.beta, again.blue.beta);
}

TEST(Rig, CovarianceSurvivesExactlyAndMayBeAbsent) {
  const ScratchFolder folder;
  Rig rig = awkward_rig();
  write_rig(folder / "exact.yaml", rig);
  EXPECT_FALSE(read_rig(folder / "exact.yaml").covariance);
  RigCovariance root;
  for (int i = 0; i < kRigParameters * kRigParameters; ++i)
    root(i) = std::sin(1.7 * i) / 3 * std::pow(10, -(i % kRigParameters) / 4);
  rig.covariance = root * root.transpose();
  rig.covariance = (*rig.covariance + rig.covariance->transpose().eval()) / 2;
  write_rig(folder / "rig.yaml", rig);
  const Rig again = read_rig(folder / "rig.yaml");
  ASSERT_TRUE(again.covariance);
  EXPECT_TRUE(*again.covariance == *rig.covariance);

  const auto expect_refused = [&](auto change) {
    Rig wrong = rig;
    change(*wrong.covariance);
    EXPECT_THAT(message_of<InvalidInput>([&] { check_rig(wrong, "rig"); }),
                HasSubstr("covariance"));
  };
  expect_refused([](RigCovariance& c) { c(3, 3) = -1; });
  expect_refused([](RigCovariance& c) { c(3, 4) += 1; });
  expect_refused([](RigCovariance& c) { c(0, 0) = std::nan(""); });
  std::string text = read_text(folder / "rig.yaml");
  text.replace(text.find("rows: 24"), 8, "rows: 12");
  text.replace(text.find("cols: 24"), 8, "cols: 48");
  const auto wrong = written(folder, "wrong.yaml", text);
  EXPECT_NE(message_of<FileError>([&] { (void)read_rig(wrong); }).find("24 x 24 is expected"),
            std::string::npos);
}

TEST(Rig, ReadsTheBundledRigs) {
  const Rig rig = read_rig(demo_path("rig.yaml"));
  EXPECT_EQ(rig.camera.width, 640);
  EXPECT_EQ(rig.camera.fx, 1100.0);
  EXPECT_EQ(rig.projector.cx, 200.0);
  EXPECT_EQ(rig.T_projector_camera.translation(), Eigen::Vector3d(150, 165, -20));
  EXPECT_EQ(rig.blue.alpha, 1.0014);
  const Rig verging = read_rig(demo_path("verging/rig.yaml"));
  EXPECT_DOUBLE_EQ(verging.T_projector_camera.linear()(0, 1), 0.03402700477637864);
}

TEST(Rig, ChromaticShiftAbsentMeansNone) {
  const ScratchFolder folder;
  const std::string text = read_text(demo_path("rig.yaml"));
  const Rig rig = read_rig(written(folder, "rig.yaml", text.substr(0, text.find("chromatic:"))));
  EXPECT_EQ(rig.red.alpha, 1);
  EXPECT_EQ(rig.blue.beta, 1);
  EXPECT_EQ(rig.blue.gamma, 0);
}

TEST(Rig, TakesDistortionsOfZeroFourFiveAndEightCoefficients) {
  const ScratchFolder folder;
  const std::string text = read_text(demo_path("rig.yaml"));
  const std::string five = "rows: 1\n   cols: 5\n   dt: d\n   data: [ 0.0, 0.0, 0.0, 0.0, 0.0 ]";
  ASSERT_NE(text.find(five), std::string::npos);
  const auto read_with = [&](int count, const std::string& data) {
    return read_rig(written(folder, "rig.yaml",
                            replaced(text, five,
                                     "rows: 1\n   cols: " + std::to_string(count) +
                                         "\n   dt: d\n   data: [ " + data + " ]")));
  };
  EXPECT_EQ(read_with(4, "1., 2., 3., 4.").camera.distortion[3], 4);
  EXPECT_EQ(read_with(8, "1., 2., 3., 4., 5., 6., 7., 8.").camera.distortion[7], 8);
  EXPECT_EQ(
      read_rig(written(folder, "rig.yaml", replaced(text, "!!opencv-matrix\n   " + five, "[]")))
          .camera.distortion[0],
      0);
  EXPECT_THROW((void)read_with(6, "1., 2., 3., 4., 5., 6."), FileError);
}

TEST(Rig, RefusesWrongFilesAndNamesTheKey) {
  const ScratchFolder folder;
  const std::string text = read_text(demo_path("rig.yaml"));
  const auto refusal = [&](const std::string& from, const std::string& to) {
    const auto path = written(folder, "bad_rig.yaml", replaced(text, from, to));
    const std::string message = message_of<FileError>([&] { (void)read_rig(path); });
    EXPECT_NE(message.find("bad_rig.yaml"), std::string::npos) << from << " -> " << to;
    return message;
  };
  EXPECT_NE(refusal("camera_size: [ 640, 480 ]", "camera_size: [ 640 ]").find("camera_size"),
            std::string::npos);
  EXPECT_NE(refusal("[ 640, 480 ]", "[ 640, -480 ]").find("camera_size"), std::string::npos);
  EXPECT_NE(refusal("projector_matrix", "projector_matrux").find("projector_matrix"),
            std::string::npos);
  EXPECT_NE(refusal("1100.0, 0.0, 319.5", "1100.0, 0.5, 319.5").find("camera_matrix"),
            std::string::npos);
  EXPECT_NE(refusal("1100.0, 0.0, 319.5", "-1100.0, 0.0, 319.5").find("camera_matrix"),
            std::string::npos);
  EXPECT_NE(refusal("1500.0", ".NaN").find("projector_matrix"), std::string::npos);
  EXPECT_NE(refusal("150.0, 165.0", ".Inf, 165.0").find("t.data[0]: is not finite"),
            std::string::npos);
  EXPECT_NE(
      refusal("data: [ 1.0, 0.0, 0.0, 0.0, 1.0", "data: [ 1.0, 0.0, 0.1, 0.0, 1.0").find("R: "),
      std::string::npos);
  EXPECT_NE(
      refusal("data: [ 1.0, 0.0, 0.0, 0.0, 1.0", "data: [ -1.0, 0.0, 0.0, 0.0, 1.0").find("R: "),
      std::string::npos);
  EXPECT_NE(refusal("150.0, 165.0, -20.0", "0.0, 0.0, 0.0").find("t: "), std::string::npos);
  EXPECT_NE(refusal("alpha: 0.999", "alpha: -0.999").find("chromatic.red"), std::string::npos);
  for (const char* const mixing : {"[ 1, 0, 0, 0, 1, 0, 0, 0 ]", "[ 1, 0, 0, 0, 2, 0, 0, 0, 1 ]",
                                   "[ 1, 1, 0, 1, 1, 0, 0, 0, 1 ]"}) {
    EXPECT_NE(refusal("chromatic:", std::string("chromatic:\n   mixing: ") + mixing)
                  .find("chromatic.mixing"),
              std::string::npos)
        << mixing;
  }
  EXPECT_NE(refusal("gamma: 0.0002", "gama: 0.0002").find("chromatic.red.gamma"),
            std::string::npos);
  EXPECT_NE(refusal("blue:", "bleu:").find("chromatic.bleu: is not known; known are blue"),
            std::string::npos);
}

TEST(Rig, DamageIsAFileErrorUnlessItLeavesARig) {
  const ScratchFolder folder;
  const std::string text = read_text(demo_path("rig.yaml"));
  std::mt19937 random(1);
  const auto below = [&](std::size_t end) { return random() % end; };
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string damaged = text;
    for (int k = 0; k < 4; ++k) {
      const std::size_t at = below(damaged.size());
      if (k % 2 == 0) {
        damaged[at] = static_cast<char>(below(128));
      } else {
        damaged.erase(at, below(20));
      }
    }
    try {
      (void)read_rig(written(folder, "damaged.yaml", damaged));
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("damaged.yaml"), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(Rig, RefusesMissingEmptyAndForeignFiles) {
  const ScratchFolder folder;
  EXPECT_THROW((void)read_rig(folder / "none.yaml"), FileError);
  EXPECT_THROW((void)read_rig(folder.path()), FileError);
  EXPECT_THROW((void)read_rig(written(folder, "empty.yaml", "")), FileError);
  EXPECT_THROW((void)read_rig(written(folder, "text.yaml", "hello")), FileError);
  EXPECT_THROW((void)read_rig(demo_path("frames/duck.png")), FileError);
  const std::string text = read_text(demo_path("rig.yaml"));
  EXPECT_THROW((void)read_rig(written(folder, "cut.yaml", text.substr(0, text.size() / 2))),
               FileError);
}

TEST(Rig, RefusesToWriteAnInvalidRig) {
  const ScratchFolder folder;
  Rig rig = awkward_rig();
  rig.T_projector_camera.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_rig(folder / "rig.yaml", rig), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder / "rig.yaml"));
}

}  // namespace
}  // namespace palpate::sensing
