// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"
#include "palpate/sensing/virtual_sensor.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(VirtualSensorFile, KeepsEveryValue) {
  const ScratchFolder folder;
  VirtualSensor sensor{.projector_gamma = 2.1,
                       .projector_black = 0.01,
                       .projector_blur_px = 0.3,
                       .projector_falloff = -1.1,
                       .ambient = 0.07,
                       .camera_blur_px = 0.9,
                       .samples_per_axis = 3,
                       .exposure_steps = 5,
                       .readout = Readout::mosaic,
                       .bits = 16,
                       .camera_gamma = 1.9,
                       .full_well = 9000.5,
                       .read_noise = 3.3,
                       .seed = 77,
                       .exposure_distance = 712.3,
                       .exposure_level = 0.83};
  write_virtual_sensor(folder / "sensor.yaml", sensor);
  const VirtualSensor read = read_virtual_sensor(folder / "sensor.yaml");
  EXPECT_EQ(read.projector_gamma, sensor.projector_gamma);
  EXPECT_EQ(read.projector_black, sensor.projector_black);
  EXPECT_EQ(read.projector_blur_px, sensor.projector_blur_px);
  EXPECT_EQ(read.projector_falloff, sensor.projector_falloff);
  EXPECT_EQ(read.ambient, sensor.ambient);
  EXPECT_EQ(read.camera_blur_px, sensor.camera_blur_px);
  EXPECT_EQ(read.samples_per_axis, sensor.samples_per_axis);
  EXPECT_EQ(read.exposure_steps, sensor.exposure_steps);
  EXPECT_EQ(read.readout, sensor.readout);
  EXPECT_EQ(read.bits, sensor.bits);
  EXPECT_EQ(read.camera_gamma, sensor.camera_gamma);
  EXPECT_EQ(read.full_well, sensor.full_well);
  EXPECT_EQ(read.read_noise, sensor.read_noise);
  EXPECT_EQ(read.seed, sensor.seed);
  EXPECT_EQ(read.exposure_distance, sensor.exposure_distance);
  EXPECT_EQ(read.exposure_level, sensor.exposure_level);
  sensor.exposure_distance.reset();
  sensor.exposure_percentile = 0.91;
  write_virtual_sensor(folder / "automatic.yaml", sensor);
  EXPECT_EQ(read_virtual_sensor(folder / "automatic.yaml").exposure_percentile, 0.91);
}

TEST(VirtualSensorFile, LeavesDefaultsForWhatIsMissing) {
  const ScratchFolder folder;
  const VirtualSensor sensor =
      read_virtual_sensor(written(folder, "s.yaml", "%YAML:1.0\n---\nread_noise: 5\n"));
  EXPECT_EQ(sensor.read_noise, 5);
  EXPECT_EQ(sensor.full_well, VirtualSensor{}.full_well);
  EXPECT_EQ(sensor.readout, VirtualSensor{}.readout);
  EXPECT_FALSE(sensor.exposure_distance);
}

TEST(VirtualSensorFile, TellsAutomaticFromFixedExposure) {
  const ScratchFolder folder;
  VirtualSensor sensor;
  write_virtual_sensor(folder / "automatic.yaml", sensor);
  EXPECT_EQ(read_virtual_sensor(folder / "automatic.yaml").exposure_distance, std::nullopt);
  sensor.exposure_distance = 812.5;
  write_virtual_sensor(folder / "fixed.yaml", sensor);
  EXPECT_EQ(read_virtual_sensor(folder / "fixed.yaml").exposure_distance, 812.5);
}

TEST(VirtualSensorFile, RefusesMisspeltAndImpossibleValues) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& line) {
    const auto path = written(folder, "s.yaml", "%YAML:1.0\n---\n" + line + "\n");
    return message_of<FileError>([&] { (void)read_virtual_sensor(path); });
  };
  EXPECT_NE(refusal("readnoise: 5").find("readnoise: is not known"), std::string::npos);
  EXPECT_NE(refusal("readout: rgb").find("must be color or mosaic or demosaiced"),
            std::string::npos);
  EXPECT_NE(refusal("bits: 12").find("bits is 12; it must be 8 or 16"), std::string::npos);
  EXPECT_NE(refusal("bits: 8.5").find("whole number"), std::string::npos);
  EXPECT_NE(refusal("seed: -1").find("seed"), std::string::npos);
  EXPECT_NE(refusal("exposure_distance: 0")
                .find("exposure_distance is \"0\"; it must be a number in [0.1, 1000000]"),
            std::string::npos);
  EXPECT_NE(refusal("ambient: .nan").find("ambient"), std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
