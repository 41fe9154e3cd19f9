// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// The program whose format a file of a camera has.
enum class CameraFileFormat {
  palpate,    ///< OpenCV FileStorage with `camera_size`: a rig, or its camera alone
  opencv,     ///< as OpenCV's calibration writes it: `image_width`, `camera_matrix`
  ros,        ///< `camera_info`: the message as ROS prints it, or the file of a calibration
  realsense,  ///< JSON with the fields of librealsense's `rs2_intrinsics`
  open3d      ///< JSON of PinholeCameraIntrinsic, PinholeCameraParameters or RGBDVideoMetadata
};

/// "Palpate", "OpenCV", "ROS", "RealSense" or "Open3D".
[[nodiscard]] std::string_view name(CameraFileFormat format);

/// The content of a file of a camera.
struct CameraFile {
  geometry::Camera camera;
  CameraFileFormat format = CameraFileFormat::palpate;
  /// [mm] length of one unit of the camera's depth images; only RGBDVideoMetadata states it.
  std::optional<double> mm_per_unit = {};
};

/// Reads the camera of a file, whatever its name, by these keys:
///
/// - `camera_size`: Palpate, see `read_rig`;
/// - `image_width`, or `K` or `k`: ROS, or OpenCV if there is no `distortion_model`. The matrix K
///   and the distortion D of the raw image are used, not the matrix P of the rectified one. If
///   `roi` states a part of the image, the camera is that of the part;
/// - `intrinsic_matrix`, also in `intrinsic`: Open3D, a list of 9 numbers by columns;
/// - `fx` and `ppx`: RealSense, with `model` (its name, or its number) and `coeffs`.
///
/// `Camera` has the distortion models plumb_bob and rational_polynomial of ROS, and of RealSense
/// Brown-Conrady, and the modified one without tangential coefficients. The other models are
/// refused; the inverse Brown-Conrady model, which RealSense cameras name even for rectified
/// images, only if a coefficient is not zero. The coefficients of a distortion may be missing only
/// if ROS names the model none or no model.
/// \throws FileError naming the file and the key if a value is missing, has the wrong shape or is
/// not finite, or if the file has a distortion or a binning that `Camera` cannot represent.
[[nodiscard]] CameraFile read_camera_file(const std::filesystem::path& path);

/// Returns true if a file has the keys of one of these formats, so that `read_camera_file` reads it
/// or states what is wrong with it. Rigs count.
/// \throws FileError naming the line if it cannot be read, or is neither YAML nor JSON.
[[nodiscard]] bool is_camera_file(const std::filesystem::path& path);

/// Returns only the camera of `read_camera_file`.
[[nodiscard]] geometry::Camera read_camera(const std::filesystem::path& path);

/// Writes a camera in the format `palpate`, so that `read_camera` reads every number back exactly.
/// \throws InvalidInput if the camera is not valid. \throws OutputError.
void write_camera(const std::filesystem::path& path, const geometry::Camera& camera);

/// Writes a camera as JSON of Open3D's PinholeCameraIntrinsic, and with it the key `depth_scale`:
/// the number of units of its depth images in a metre. Only `read_camera_file` reads that key.
/// \param mm_per_unit [mm] length of one unit of its depth images.
/// \throws InvalidInput if the camera is not valid or has a lens distortion, which this format does
/// not hold, or unless the unit is finite and > 0. \throws OutputError.
void write_open3d_camera(const std::filesystem::path& path, const geometry::Camera& camera,
                         double mm_per_unit);

/// Files of cameras, each of which is read once. Threads may use an object at the same time.
class CameraFiles {
 public:
  /// Returns `read_camera_file` of the first call with this path.
  [[nodiscard]] CameraFile read(const std::filesystem::path& path);

 private:
  std::mutex mutex_;
  std::map<std::filesystem::path, CameraFile> files_;
};

}  // namespace palpate::sensing
