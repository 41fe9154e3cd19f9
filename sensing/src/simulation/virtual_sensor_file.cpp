// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <ostream>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {
namespace {

constexpr double kMaxBlur = 100;
constexpr double kMaxFalloff = 10;
constexpr int kMaxSamples = 64;
constexpr int kMaxExposureSteps = 1024;

constexpr std::array<std::pair<Readout, const char*>, 3> kReadouts = {
    {{Readout::color, "color"}, {Readout::mosaic, "mosaic"}, {Readout::demosaiced, "demosaiced"}}};

/// Names of the numbers in the file; `visit(name, value)` may read or change them.
template <typename Sensor, typename Visit>
void for_each_number(Sensor& sensor, const Visit& visit) {
  visit("projector_gamma", sensor.projector_gamma);
  visit("projector_black", sensor.projector_black);
  visit("projector_blur_px", sensor.projector_blur);
  visit("projector_falloff", sensor.projector_falloff);
  visit("ambient", sensor.ambient);
  visit("camera_blur_px", sensor.camera_blur);
  visit("samples_per_axis", sensor.samples_per_axis);
  visit("exposure_steps", sensor.exposure_steps);
  visit("bits", sensor.bits);
  visit("camera_gamma", sensor.camera_gamma);
  visit("full_well", sensor.full_well);
  visit("read_noise", sensor.read_noise);
  visit("exposure_percentile", sensor.exposure_percentile);
  visit("exposure_level", sensor.exposure_level);
}

void check_keys(const StorageFile& file) {
  std::set<std::string> known = {"readout", "seed", "exposure_distance"};
  VirtualSensor sensor;
  for_each_number(sensor, [&](const char* name, double) { known.insert(name); });
  file.allow_only(file.root(), known);
}

Readout read_readout(const StorageFile& file) {
  const std::string word = file.text(file.child(file.root(), "readout"), "readout");
  for (const auto& [readout, name] : kReadouts) {
    if (word == name) return readout;
  }
  file.fail("readout", "color, mosaic or demosaiced is expected, not '" + word + "'");
}

}  // namespace

void check_virtual_sensor(const VirtualSensor& sensor, const std::string& what) {
  const auto check = [&](const char* name, double value, const Interval& range,
                         const char* unit = "") {
    require(what + ": " + name, value, range, unit);
  };
  check("projector_gamma", sensor.projector_gamma, above(0).finite());
  check("projector_black", sensor.projector_black, at_least(0).below(1));
  check("projector_blur_px", sensor.projector_blur, at_least(0).at_most(kMaxBlur), "px");
  check("projector_falloff", sensor.projector_falloff, at_least(-kMaxFalloff).at_most(kMaxFalloff));
  check("ambient", sensor.ambient, at_least(0).finite());
  check("camera_blur_px", sensor.camera_blur, at_least(0).at_most(kMaxBlur), "px");
  check("samples_per_axis", sensor.samples_per_axis, at_least(1).at_most(kMaxSamples));
  check("exposure_steps", sensor.exposure_steps, at_least(1).at_most(kMaxExposureSteps));
  require_one_of(what + ": bits", sensor.bits, {8, 16});
  check("camera_gamma", sensor.camera_gamma, above(0).finite());
  check("full_well", sensor.full_well, at_least(0).finite(), "electrons");
  check("read_noise", sensor.read_noise, at_least(0).finite(), "electrons");
  require(what + ": exposure_distance", sensor.exposure_distance, above(0).finite(), "mm");
  check("exposure_percentile", sensor.exposure_percentile, above(0).at_most(1));
  check("exposure_level", sensor.exposure_level, above(0).at_most(1));
}

VirtualSensor ideal(VirtualSensor sensor) {
  sensor.projector_blur = sensor.camera_blur = 0;
  sensor.readout = Readout::color;
  sensor.bits = 16;
  sensor.full_well = 0;
  return sensor;
}

VirtualSensor read_virtual_sensor(const std::filesystem::path& path) {
  const StorageFile file(path);
  const YAML::Node& root = file.root();
  check_keys(file);
  VirtualSensor sensor;
  for_each_number(sensor, [&](const char* name, auto& value) {
    const YAML::Node node = file.find(root, name);
    if (!node) return;
    if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, int>) {
      value = file.whole_number(node, name);
    } else {
      value = file.number(node, name);
    }
  });
  if (const YAML::Node node = file.find(root, "exposure_distance"))
    sensor.exposure_distance = file.number(node, "exposure_distance");
  if (file.find(root, "readout")) sensor.readout = read_readout(file);
  if (const YAML::Node node = file.find(root, "seed")) {
    const int seed = file.whole_number(node, "seed");
    if (seed < 0) file.fail("seed", "must be >= 0");
    sensor.seed = static_cast<std::uint64_t>(seed);
  }
  try {
    check_virtual_sensor(sensor, path.string());
  } catch (const InvalidInput& error) {
    throw FileError(error.what());
  }
  return sensor;
}

void write_virtual_sensor(const std::filesystem::path& path, const VirtualSensor& sensor) {
  check_virtual_sensor(sensor, "write_virtual_sensor(" + path.string() + ")");
  if (sensor.seed > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
    throw InvalidInput("write_virtual_sensor(" + path.string() +
                       "): seed: the file holds whole numbers up to 2147483647");
  }
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  for_each_number(sensor, [&](const char* name, auto value) { storage << name << value; });
  for (const auto& [readout, name] : kReadouts) {
    if (sensor.readout == readout) storage << "readout" << name;
  }
  if (sensor.exposure_distance) storage << "exposure_distance" << *sensor.exposure_distance;
  storage << "seed" << static_cast<int>(sensor.seed);
  const std::string text = storage.releaseAndGetString();
  write_file(path, [&](std::ostream& out) { out << text; });
}

}  // namespace palpate::sensing
