// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// An object in front of the virtual sensor. The reflectance at a point is the product of
/// `reflectance`, the interpolated vertex colour (if any) and the texture colour (if any).
struct Body {
  geometry::TriangleMesh mesh;  ///< camera frame [mm]; triangles are visible and lit on both sides
  /// [mm] 3 x V: vertex positions at the end of the exposure, reached at constant speed. If not
  /// given, the body is at rest.
  std::optional<Eigen::Matrix3Xd> end_vertices{};
  Eigen::Vector3d reflectance{0.8, 0.8, 0.8};       ///< red, green, blue in [0, 1]; Lambertian
  std::optional<Eigen::Matrix3Xd> vertex_colors{};  ///< 3 x V red, green, blue in [0, 1]
  /// 8 or 16 bit, grey or BGR, linear in the light; needs `texture_coordinates`.
  std::optional<cv::Mat> texture{};
  /// 2 x V: (0, 0) is the lower left corner of the texture and (1, 1) the upper right one; the
  /// texture repeats outside this square.
  Eigen::Matrix2Xd texture_coordinates{};
  double specular = 0;  ///< strength of the highlight, which has the colour of the light; in [0, 1]
  double shininess = 50;  ///< exponent of the highlight (Blinn-Phong): higher is narrower; >= 1
  /// An edge is shaded smoothly if the normals of its triangles differ by <= crease_angle [rad];
  /// in [0, pi].
  double crease_angle = 0.6;
};

/// Format of the camera's images.
enum class Readout {
  color,       ///< every pixel measures all three channels
  mosaic,      ///< raw RGGB mosaic, one channel
  demosaiced,  ///< RGGB mosaic, missing channels interpolated bilinearly
};

/// Light, optics and electronics of a camera and a projector; their geometry is the `Rig`. The
/// defaults describe a common 8-bit colour camera. The unit and range of each field stand in its
/// list, `visit(VirtualSensor&, FieldVisitor&)`.
struct VirtualSensor {
  double projector_gamma = 1;    ///< light = value ^ projector_gamma
  double projector_black = 0;    ///< light of a black pixel as a share of white
  double projector_blur_px = 0;  ///< projector px, standard deviation of the blur
  /// Exponent of cos(angle to the projector's axis) in the emitted light: 0 is a point source that
  /// shines evenly in all directions; -3 lights a plane that faces it evenly.
  double projector_falloff = -2;
  /// Ambient light, as a share of the projector's white on a surface that faces it at a distance
  /// of 1 m.
  double ambient = 0;

  double camera_blur_px = 1;  ///< camera px, standard deviation of the blur
  int samples_per_axis = 1;   ///< rays per pixel along each axis, on a regular grid
  int exposure_steps = 8;     ///< time samples of motion per exposure, of a body that moves

  Readout readout = Readout::demosaiced;
  int bits = 8;              ///< per channel: 8 or 16
  double camera_gamma = 1;   ///< value = light ^ (1 / camera_gamma)
  double full_well = 12000;  ///< electrons at full scale; 0 turns all noise off
  double read_noise = 20;    ///< electrons, standard deviation
  unsigned seed = 1;         ///< seed of the noise

  /// Fixed exposure: a white surface facing the projector's white at this distance [mm] reads
  /// exposure_level of full scale. If not given, the exposure is automatic: it puts
  /// exposure_percentile of the lit pixels of the first frame below exposure_level.
  std::optional<double> exposure_distance{};
  double exposure_percentile = 0.97;
  double exposure_level = 0.8;
};

void visit(VirtualSensor& sensor, FieldVisitor& visitor);

/// Checks that every value is in its range.
/// \throws InvalidInput otherwise.
void check_virtual_sensor(const VirtualSensor& sensor);

/// Returns the sensor without imperfections: no blur, no mosaic, no noise, 16 bits.
[[nodiscard]] VirtualSensor ideal(VirtualSensor sensor);

/// Reads a sensor from a YAML file. The keys are the member names of `VirtualSensor`, with
/// `readout` as a word; a missing key keeps its default.
/// \throws FileError naming the file and the key.
[[nodiscard]] VirtualSensor read_virtual_sensor(const std::filesystem::path& path);

/// Writes a sensor so that `read_virtual_sensor` reads it back.
/// \throws InvalidInput if the sensor is not valid.
/// \throws OutputError if the file cannot be written.
void write_virtual_sensor(const std::filesystem::path& path, const VirtualSensor& sensor);

/// Images of rows x cols, row-major.
using PixelMask = geometry::PixelMask;
using PixelLabels = Eigen::Array<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Ground truth at pixel centres, through green's optics, at the middle of the exposure.
struct SceneTruth {
  geometry::RangeMap range;  ///< NaN where there is no body
  PixelLabels body;          ///< index of the body; -1 where there is none
  PixelMask covered;         ///< a body that lies within the projector's field of view
  PixelMask lit;             ///< `covered`, and the projector's light reaches it
  /// [rad] angle between the surface normal and the ray to the camera or to the projector,
  /// whichever is larger; NaN where there is no body.
  geometry::ImageF incidence;
};

struct Simulation {
  std::vector<cv::Mat> frames;  ///< one per projector image, in the format of the readout
  SceneTruth truth;
  double exposure = 0;  ///< pixel value (1 = full scale) of a white surface facing white at 1 m
};

/// Renders what the camera sees of bodies under projector images, one frame per image. All frames
/// use the exposure of the first one. Interreflections are not simulated.
///
/// The light E on a surface and the radiance L towards the camera are
///
///     E = panel cos^falloff(angle to the axis) cos(incidence) / (distance / 1 m)^2
///     L = E (reflectance + specular (s + 8) / 8 cos^s(angle of normal and half vector))
///         + ambient reflectance
///
/// with E = 0 in shadow. Each colour has its own path through both lenses (`ChromaticShift`: beta
/// acts on both axes of the panel, gamma only along `axis`). The camera blurs L and converts it to
/// electrons with shot and read noise, which depend only on seed, frame number and pixel.
///
/// \param panels  the projector's images: 8 or 16 bit or float in [0, 1], grey or BGR, of the
///                projector's size; interpolated bilinearly between pixel centres.
/// \param axis    the axis along which the pattern's sinusoid varies, and gamma shifts.
/// \param first_frame  number of the first frame, used by the noise.
/// \throws InvalidInput if a body, a panel, the rig or the sensor is not valid.
[[nodiscard]] Simulation simulate(const Rig& rig, std::span<const Body> bodies,
                                  std::span<const cv::Mat> panels, const VirtualSensor& sensor,
                                  Axis axis = Axis::y, std::uint64_t first_frame = 0);

}  // namespace palpate::sensing
