// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <limits>
#include <ostream>
#include <set>
#include <string>
#include <string_view>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/core/idle_fields.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {
namespace {

constexpr Interval kBlur = at_least(0).at_most(100);
/// [mm] Range of the distances of objects.
constexpr Interval kDistances = at_least(0.1).at_most(1e6);
/// With more ambient light, every camera's noise hides the projector's light.
constexpr double kBrightest = 1e6;
constexpr double kMaxFalloff = 10;
constexpr int kMaxSamples = 32;
constexpr int kMaxExposureSteps = 1024;
constexpr std::array<std::string_view, 3> kReadouts{"color", "mosaic", "demosaiced"};
constexpr std::string_view kType = "VirtualSensor";

/// The name of a field in a file, and in messages about it: without the struct.
std::string name_in_file(const std::string& field) { return field.substr(kType.size() + 2); }

}  // namespace

void visit(VirtualSensor& sensor, FieldVisitor& visitor) {
  visitor.begin(kType);
  visitor.choice(
      {"readout",
       "Format of the camera's images: color, where every pixel measures all channels; mosaic, a "
       "raw RGGB mosaic; demosaiced, the same with the missing channels interpolated"},
      sensor.readout, kReadouts);
  visitor.whole({"bits", "Bits per channel: 8 or 16"}, sensor.bits, at_least(8).at_most(16));
  visitor.real(
      {"ambient",
       "Ambient light, as a share of the projector's white on a surface that faces it at a "
       "distance of 1 m"},
      sensor.ambient, at_least(0).at_most(kBrightest));
  visitor.real({"exposure_distance",
                "Fixed exposure: a white surface that faces the projector's white at this distance "
                "reads exposure_level of full scale. Without it: automatic, so that "
                "exposure_percentile of the lit pixels of the first frame read less",
                "mm"},
               sensor.exposure_distance, kDistances);
  visitor.whole({"seed", "Seed of the noise"}, sensor.seed,
                at_least(0).at_most(std::numeric_limits<int>::max()));
  constexpr bool kExpert = true;
  visitor.real({"projector_gamma", "Light of the projector = value ^ projector_gamma", "", kExpert},
               sensor.projector_gamma, above(0).finite());
  visitor.real({"projector_black", "Light of a black pixel of the projector", "of white", kExpert},
               sensor.projector_black, at_least(0).below(1));
  visitor.real(
      {"projector_blur_px", "Standard deviation of the projector's blur", "projector px", kExpert},
      sensor.projector_blur_px, kBlur);
  visitor.real({"projector_falloff",
                "Exponent of the cosine of the angle to the projector's axis in the emitted light: "
                "0 shines evenly in all directions, -3 lights a plane that faces it evenly",
                "", kExpert},
               sensor.projector_falloff, at_least(-kMaxFalloff).at_most(kMaxFalloff));
  visitor.real({"camera_blur_px", "Standard deviation of the camera's blur", "px", kExpert},
               sensor.camera_blur_px, kBlur);
  visitor.whole({"samples_per_axis", "Rays per pixel along each axis", "", kExpert},
                sensor.samples_per_axis, at_least(1).at_most(kMaxSamples));
  visitor.whole(
      {"exposure_steps", "Moments of an exposure at which a moving body is seen", "", kExpert},
      sensor.exposure_steps, at_least(1).at_most(kMaxExposureSteps));
  visitor.real({"camera_gamma", "Value of a pixel = light ^ (1 / camera_gamma)", "", kExpert},
               sensor.camera_gamma, above(0).finite());
  visitor.real(
      {"full_well", "Electrons at full scale; 0 turns all noise off", "electrons", kExpert},
      sensor.full_well, at_least(0).finite());
  visitor.real({"read_noise", "Standard deviation of the read noise", "electrons", kExpert},
               sensor.read_noise, at_least(0).finite());
  visitor.real({"exposure_percentile",
                "Automatic exposure: share of the lit pixels that read less than exposure_level",
                "", kExpert},
               sensor.exposure_percentile, above(0).at_most(1));
  visitor.real({"exposure_level", "What the exposure is set for", "of full scale", kExpert},
               sensor.exposure_level, above(0).at_most(1));
}

void check_virtual_sensor(const VirtualSensor& sensor) {
  static_cast<void>(in_range(sensor));
  require_one_of("VirtualSensor::bits", sensor.bits, {8, 16});
  if (sensor.exposure_distance) refuse_idle(sensor, "exposure_distance", {"exposure_percentile"});
  if (sensor.full_well == 0) refuse_idle(sensor, "full_well", {"read_noise"});
}

VirtualSensor ideal(VirtualSensor sensor) {
  sensor.projector_blur_px = sensor.camera_blur_px = 0;
  sensor.readout = Readout::color;
  sensor.bits = 16;
  sensor.full_well = 0;
  sensor.read_noise = VirtualSensor{}.read_noise;  // does nothing without noise
  return sensor;
}

VirtualSensor read_virtual_sensor(const std::filesystem::path& path) {
  const StorageFile file(path);
  VirtualSensor sensor;
  const FieldList fields = fields_of(sensor);
  std::set<std::string> names;
  for (const FieldText& field : texts_of(fields)) names.insert(field.name);
  file.allow_only(file.root(), names);
  try {
    for (const std::string& name : names) {
      if (const YAML::Node node = file.find(file.root(), name))
        assign(fields, name, file.scalar(node, name));
    }
    check_virtual_sensor(sensor);
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw FileError(path.string() + ": " + error.with_names(name_in_file));
  }
  return sensor;
}

void write_virtual_sensor(const std::filesystem::path& path, const VirtualSensor& sensor) {
  check_virtual_sensor(sensor);
  VirtualSensor written = sensor;
  write_file(path, [&](std::ostream& out) {
    out << "%YAML:1.0\n---\n";
    for (const FieldText& field : texts_of(fields_of(written)))
      if (!field.text.empty()) out << field.name << ": " << field.text << '\n';
  });
}

}  // namespace palpate::sensing
