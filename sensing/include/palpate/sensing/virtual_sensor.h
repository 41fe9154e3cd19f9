// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// One thing the virtual sensor looks at. Its reflectance at a point is `reflectance` times the
/// colour of the vertices around it times that of the texture, each where there is one.
struct Body {
  geometry::TriangleMesh mesh;  ///< camera frame [mm]; both sides of a triangle are seen and lit
  /// [mm] 3 x V: where the vertices are when the shutter closes, at constant speed; empty: at rest.
  Eigen::Matrix3Xd end_vertices{};
  Eigen::Vector3d reflectance{0.8, 0.8, 0.8};  ///< red, green, blue in [0, 1]; Lambertian
  Eigen::Matrix3Xd vertex_colors{};            ///< 3 x V red, green, blue in [0, 1]; or empty
  /// 8 or 16 bit, grey or BGR, linear in the light; with `texture_coordinates`, or empty.
  cv::Mat texture{};
  /// 2 x V: (0, 0) is the lower left corner of the texture, (1, 1) the upper right one; beyond, it
  /// repeats.
  Eigen::Matrix2Xd texture_coordinates{};
  double specular = 0;    ///< strength of the highlight, which has the light's colour; in [0, 1]
  double shininess = 50;  ///< its exponent (Blinn and Phong): the higher, the narrower; >= 1
  /// Triangles that meet at an edge look smooth iff their normals differ by <= crease_angle [rad];
  /// in [0, pi].
  double crease_angle = 0.6;
};

/// What leaves the camera.
enum class Readout {
  color,       ///< every pixel measures all three channels
  mosaic,      ///< raw RGGB mosaic, one channel
  demosaiced,  ///< RGGB mosaic, missing channels interpolated bilinearly
};

/// Light, optics and electronics of a camera and a projector, beyond the geometry of their rig.
/// The defaults are a common colour camera with 8 bits.
struct VirtualSensor {
  double projector_gamma = 1;  ///< light = value ^ projector_gamma; > 0
  double projector_black = 0;  ///< share of its white light that black lets through; in [0, 1)
  double projector_blur = 0;   ///< px of the projector, standard deviation of the blur; in [0, 100]
  /// The projector sends out light as the cosine of the angle to its axis to this power: 0 is a
  /// point that shines evenly, -3 lights a screen that faces it evenly; in [-10, 10].
  double projector_falloff = -2;
  /// Light from everywhere, as a share of the projector's white on a surface that faces it 1 m
  /// away; >= 0.
  double ambient = 0;

  double camera_blur = 1;    ///< px of the camera, standard deviation of the blur; in [0, 100]
  int samples_per_axis = 1;  ///< rays a pixel, across and down, on a regular grid; in [1, 64]
  int exposure_steps = 8;  ///< moments into which motion is cut; in [1, 1024]; 1 if all is at rest

  Readout readout = Readout::demosaiced;
  int bits = 8;              ///< a channel: 8 or 16
  double camera_gamma = 1;   ///< value = light ^ (1 / camera_gamma); > 0
  double full_well = 12000;  ///< electrons at full scale, >= 0; 0: no noise at all
  double read_noise = 20;    ///< electrons, standard deviation; >= 0
  std::uint64_t seed = 1;    ///< of the noise

  /// The camera sets its exposure so that a white surface that faces the projector's white at this
  /// distance [mm] reads exposure_level of full scale; > 0. Or 0: so that exposure_percentile of
  /// the lit pixels stay below it in the first frame.
  double exposure_distance = 0;
  double exposure_percentile = 0.97;  ///< in (0, 1]
  double exposure_level = 0.8;        ///< in (0, 1]
};

/// \throws InvalidInput, beginning with `what`, if a value is not in its range.
void check_virtual_sensor(const VirtualSensor& sensor, const std::string& what);

/// The same without any fault: no blur, no mosaic, no noise, 16 bits.
[[nodiscard]] VirtualSensor ideal(VirtualSensor sensor);

/// Reads a sensor (OpenCV FileStorage: the names above, `readout` in words; what is missing keeps
/// its default).
/// \throws FileError naming the file and the key.
[[nodiscard]] VirtualSensor read_virtual_sensor(const std::filesystem::path& path);

/// Writes a sensor as `read_virtual_sensor` reads it.
/// \throws InvalidInput if it is not valid; OutputError.
void write_virtual_sensor(const std::filesystem::path& path, const VirtualSensor& sensor);

/// rows x cols, row after row.
using PixelMask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using PixelLabels = Eigen::Array<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What is true of the scene, at pixel centres in green's optics, in the middle of the exposure.
struct SceneTruth {
  geometry::RangeMap range;  ///< NaN where no body is
  PixelLabels body;          ///< number of the body; -1 where none is
  PixelMask covered;         ///< there is a body, and the projector's image reaches its place ...
  PixelMask lit;             ///< ... and nothing keeps the light away
  /// [rad] angle of the surface's normal to the camera's or the projector's ray, whichever is
  /// larger; NaN where no body is.
  geometry::ImageF incidence;
};

struct Simulation {
  std::vector<cv::Mat> frames;  ///< one for each of the projector's images, as the readout says
  SceneTruth truth;
  double exposure = 0;  ///< full scales per light on a white surface that faces white from 1 m
};

/// What a camera sees of bodies under a projector's images; one frame an image, all with the
/// exposure of the first.
///
/// A ray from the camera meets the first surface; its light is that of the panel at the place whose
/// ray ends there, unless a body is in between:
///
///     E = panel cos^falloff(angle to the axis) cos(incidence) / (distance / 1 m)^2
///     L = E (reflectance + specular (s + 8) / 8 cos^s(angle of normal and half vector))
///         + ambient reflectance
///
/// Each colour has its own path through both lenses (`ChromaticShift`; beta acts on both axes of
/// the panel, gamma along `axis` alone). The camera then blurs L, and turns it into electrons with
/// shot and read noise, which depend on the seed, the number of the frame and the place alone.
/// Light that goes from surface to surface is left out.
///
/// \param panels  the projector's images: 8 or 16 bit or float in [0, 1], grey or BGR, of the
///                projector's size; bilinear between pixel centres.
/// \param axis    along which the pattern's sinusoid varies: the direction of gamma.
/// \param first_frame  number of the first frame, for the noise.
/// \throws InvalidInput if a body, a panel, the rig or the sensor is not valid.
[[nodiscard]] Simulation simulate(const Rig& rig, std::span<const Body> bodies,
                                  std::span<const cv::Mat> panels, const VirtualSensor& sensor,
                                  Axis axis = Axis::y, std::uint64_t first_frame = 0);

}  // namespace palpate::sensing
