// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/camera_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <opencv2/core/persistence.hpp>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "setup/lens_entry.h"

namespace palpate::sensing {
namespace {

constexpr const char* kExpected =
    "the camera of a depth camera is a file of Palpate (camera_size), ROS camera_info "
    "(image_width, or K), Open3D (intrinsic_matrix) or RealSense (fx, fy, ppx, ppy)";

bool has(const YAML::Node& map, const char* key) { return StorageFile::find(map, key).IsDefined(); }

/// The keys and values of an entry.
YAML::Node map_at(const StorageFile& file, const char* key) {
  const YAML::Node map = file.child(file.root(), key);
  if (!map.IsMap()) file.fail(key, "keys and values are expected");
  return map;
}

/// The text of a key; empty if it is missing or has no value.
std::string optional_text(const StorageFile& file, const char* key) {
  const YAML::Node node = StorageFile::find(file.root(), key);
  return node.IsDefined() && !node.IsNull() ? file.text(node, key) : "";
}

/// The spelling of a key that the map has, or the first one if it has neither.
const char* spelt(const YAML::Node& map, const char* usual, const char* other) {
  return !has(map, usual) && has(map, other) ? other : usual;
}

void read_size(const StorageFile& file, const YAML::Node& map, const char* width,
               const char* height, geometry::Camera& camera) {
  const auto read = [&](const char* key) {
    const int pixels = file.whole_number(file.child(map, key), key);
    if (pixels <= 0) file.fail(key, fmt::format("is {} px; the size of an image is > 0", pixels));
    return pixels;
  };
  camera.width = read(width);
  camera.height = read(height);
}

/// Takes fx 0 cx, 0 fy cy, 0 0 1 row by row.
void set_matrix(const StorageFile& file, const std::string& key, const std::vector<double>& rows,
                const char* uncalibrated, geometry::Camera& camera) {
  if (rows.size() != 9)
    file.fail(key, fmt::format("has {} numbers; a matrix of 9 is expected", rows.size()));
  if (!(rows[0] > 0) || !(rows[4] > 0)) {
    file.fail(key, fmt::format("fx is {:g} px and fy {:g} px; they must be > 0{}", rows[0], rows[4],
                               uncalibrated));
  }
  if (rows[1] != 0 || rows[3] != 0 || rows[6] != 0 || rows[7] != 0 || rows[8] != 1)
    file.fail(key, "must have the form fx 0 cx, 0 fy cy, 0 0 1; a skew is not supported");
  camera.fx = rows[0];
  camera.fy = rows[4];
  camera.cx = rows[2];
  camera.cy = rows[5];
}

/// The numbers of a list, or of a matrix with rows, cols and data.
std::vector<double> list_or_data(const StorageFile& file, const std::string& key) {
  const YAML::Node node = file.child(file.root(), key);
  if (!node.IsMap()) return file.numbers(node, key);
  return file.numbers(file.child(node, "data", key + "."), key + ".data");
}

bool all_zero(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return value == 0; });
}

/// Takes k1 k2 p1 p2 k3 k4 k5 k6 of OpenCV; those after them must be zero.
void set_distortion(const StorageFile& file, const std::string& key,
                    const std::vector<double>& values, geometry::Camera& camera) {
  const std::size_t known = camera.distortion.size();
  if (values.size() > known && !all_zero(std::span(values).subspan(known))) {
    file.fail(key,
              "has thin-prism or tilt coefficients (more than 8), which are not supported; "
              "undistort the images, and pass the camera of the undistorted ones");
  }
  std::copy_n(values.begin(), std::min(values.size(), known), camera.distortion.begin());
}

/// Takes the part of the image that a message of ROS states, in pixels of the whole one.
void set_region(const StorageFile& file, geometry::Camera& camera) {
  const YAML::Node roi = map_at(file, "roi");
  const auto pixels = [&](const char* key) {
    const std::string place = std::string("roi.") + key;
    const int value = has(roi, key) ? file.whole_number(roi[key], place) : 0;
    if (value < 0) file.fail(place, fmt::format("is {} px; it must be >= 0", value));
    return value;
  };
  const int x = pixels("x_offset"), y = pixels("y_offset"), width = pixels("width"),
            height = pixels("height");
  if (x == 0 && y == 0 && width == 0 && height == 0) return;  // the whole image
  if (width == 0 || height == 0 || width > camera.width - x || height > camera.height - y) {
    file.fail("roi",
              fmt::format("is {} x {} px from column {} and row {}; it must be a part of the image "
                          "of {} x {} px, or 0 throughout for the whole image",
                          width, height, x, y, camera.width, camera.height));
  }
  camera.width = width;
  camera.height = height;
  camera.cx -= x;
  camera.cy -= y;
}

CameraFile read_ros(const StorageFile& file) {
  const YAML::Node& root = file.root();
  const bool is_message = !has(root, "image_width");
  CameraFile read;
  read.format = is_message || has(root, "distortion_model") ? CameraFileFormat::ros
                                                            : CameraFileFormat::opencv;
  read_size(file, root, is_message ? "width" : "image_width",
            is_message ? "height" : "image_height", read.camera);
  const std::string matrix = is_message ? spelt(root, "K", "k") : "camera_matrix";
  set_matrix(file, matrix, list_or_data(file, matrix),
             "; ROS writes zeros for a camera that is not calibrated", read.camera);
  for (const char* key : {"binning_x", "binning_y"}) {
    if (has(root, key) && file.whole_number(root[key], key) > 1) {
      file.fail(key,
                "binned images are not supported; pass a camera_info whose K and size are those of "
                "the binned images, with binning 0");
    }
  }
  if (has(root, "roi")) set_region(file, read.camera);
  const std::string coefficients = is_message ? spelt(root, "D", "d") : "distortion_coefficients";
  const std::string model = optional_text(file, "distortion_model");
  std::vector<double> values;
  if (has(root, coefficients.c_str()))
    values = list_or_data(file, coefficients);
  else if (model != "none" && !(is_message && model.empty()))
    file.fail(coefficients, "is missing; write zeros if there is no lens distortion");
  // OpenCV's calibration program writes 1 for a fisheye lens.
  const bool is_fisheye =
      has(root, "fisheye_model") && file.whole_number(root["fisheye_model"], "fisheye_model") != 0;
  if (is_fisheye || model == "equidistant" || model == "fisheye") {
    file.fail(is_fisheye ? "fisheye_model" : "distortion_model",
              (is_fisheye ? root["fisheye_model"].Scalar() : model) +
                  " is that of a fisheye lens, which is not supported; undistort the images, and "
                  "pass the camera of those");
  }
  if (!model.empty() && model != "plumb_bob" && model != "rational_polynomial" && model != "none") {
    file.fail("distortion_model",
              model + " is not known; plumb_bob and rational_polynomial are supported");
  }
  if (model == "plumb_bob" && values.size() > 5 && !all_zero(std::span(values).subspan(5)))
    file.fail(coefficients, "plumb_bob has the 5 coefficients k1, k2, p1, p2, k3");
  const bool has_none = model == "none" || (read.format == CameraFileFormat::ros && model.empty());
  if (has_none && !all_zero(values)) {
    file.fail("distortion_model", fmt::format("is {}, but there are distortion coefficients",
                                              model.empty() ? "empty" : model));
  }
  set_distortion(file, coefficients, values, read.camera);
  return read;
}

/// [mm] For the units a metre of `depth_scale`.
constexpr double kMetre = 1000;

CameraFile read_open3d(const StorageFile& file) {
  const YAML::Node map =
      has(file.root(), "intrinsic_matrix") ? file.root() : map_at(file, "intrinsic");
  CameraFile read{.camera = {}, .format = CameraFileFormat::open3d};
  read_size(file, map, "width", "height", read.camera);
  const std::string key = "intrinsic_matrix";
  const std::vector<double> columns = file.numbers(file.child(map, key), key);
  if (columns.size() != 9)
    file.fail(key, fmt::format("has {} numbers; Open3D writes 9", columns.size()));
  if ((columns[2] != 0 || columns[5] != 0) && columns[6] == 0 && columns[7] == 0)
    file.fail(key, "is written by rows; Open3D writes fx 0 0, 0 fy 0, cx cy 1");
  std::vector<double> rows(9);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = columns[i % 3 * 3 + i / 3];
  set_matrix(file, key, rows, "", read.camera);
  if (!has(map, "depth_scale")) return read;
  const double units = file.number(map["depth_scale"], "depth_scale");
  if (!(units > 0))
    file.fail("depth_scale", fmt::format("is {:g} units a metre; it must be > 0", units));
  read.mm_per_unit = kMetre / units;
  return read;
}

/// The models of `rs2_distortion`, by number.
enum class RealSenseModel { none, modified, inverse, f_theta, brown_conrady, kannala_brandt };
constexpr std::array<const char*, 6> kRealSenseModels = {
    "none",   "modifiedbrownconrady", "inversebrownconrady",
    "ftheta", "brownconrady",         "kannalabrandt4"};

/// The model by its number or name: "distortion.brown_conrady" in Python, "Brown Conrady" in C++.
RealSenseModel read_model(const StorageFile& file, const std::string& key) {
  const YAML::Node node = file.child(file.root(), key);
  if (!node.IsScalar()) file.fail(key, "the name or the number of a model is expected");
  const std::string text = node.Scalar();
  std::string letters;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  for (const std::string prefix : {"rs2", "distortion"})
    if (letters.starts_with(prefix)) letters.erase(0, prefix.size());
  for (std::size_t i = 0; i < kRealSenseModels.size(); ++i) {
    if (letters == kRealSenseModels[i] || letters == std::to_string(i))
      return static_cast<RealSenseModel>(i);
  }
  file.fail(key, text +
                     " is not known; expected none, brown_conrady, modified_brown_conrady, "
                     "inverse_brown_conrady, ftheta or kannala_brandt4");
}

CameraFile read_realsense(const StorageFile& file) {
  const YAML::Node& root = file.root();
  CameraFile read{.camera = {}, .format = CameraFileFormat::realsense};
  read_size(file, root, "width", "height", read.camera);
  const auto number = [&](const char* key) { return file.number(file.child(root, key), key); };
  read.camera.fx = number("fx");
  read.camera.fy = number("fy");
  for (const char* key : {"fx", "fy"})
    if (!(number(key) > 0)) file.fail(key, fmt::format("is {:g} px; it must be > 0", number(key)));
  read.camera.cx = number(spelt(root, "ppx", "cx"));
  read.camera.cy = number(spelt(root, "ppy", "cy"));
  std::vector<double> values;
  if (has(root, "coeffs")) values = file.numbers(root["coeffs"], "coeffs");
  if (values.size() > 5)
    file.fail("coeffs", fmt::format("has {} numbers; librealsense has 5", values.size()));
  values.resize(5);
  const std::string key = spelt(root, "model", "distortion_model");
  if (!has(root, key.c_str())) {
    if (!all_zero(values)) file.fail("model", "is missing, but coeffs are not zero");
    return read;
  }
  const RealSenseModel model = read_model(file, key);
  using enum RealSenseModel;
  if (model == f_theta || model == kannala_brandt) {
    file.fail(key, std::string("is that of a fisheye lens, which is not supported; undistort the "
                               "images, and pass the camera of those"));
  }
  const bool is_tangential = values[2] != 0 || values[3] != 0;
  if ((model == inverse && !all_zero(values)) || (model == modified && is_tangential)) {
    file.fail(key, std::string(model == inverse ? "the inverse" : "the modified") +
                       " Brown-Conrady model is not supported with these coeffs. Align the colour "
                       "images with the depth images, which have no distortion, instead of the "
                       "depth images with the colour images (rs.align(rs.stream.depth)), and pass "
                       "the camera of the depth images; or undistort the images");
  }
  if (model != none) std::ranges::copy(values, read.camera.distortion.begin());
  return read;
}

/// A camera or a rig of Palpate.
CameraFile read_own(const StorageFile& file) { return {.camera = read_lens(file, "camera")}; }

/// A key that only the files of one program have.
struct KnownKey {
  const char* key;
  CameraFile (*read)(const StorageFile& file);
};
constexpr std::array<KnownKey, 8> kKnownKeys{{{"camera_size", read_own},
                                              {"projector_matrix", read_own},
                                              {"image_width", read_ros},
                                              {"K", read_ros},
                                              {"k", read_ros},
                                              {"intrinsic_matrix", read_open3d},
                                              {"intrinsic", read_open3d},
                                              {"fx", read_realsense}}};

/// The first of these keys that a file has; null if it has none.
const KnownKey* known_key(const StorageFile& file) {
  const auto* const known = std::ranges::find_if(
      kKnownKeys, [&](const KnownKey& format) { return has(file.root(), format.key); });
  return known == kKnownKeys.end() ? nullptr : known;
}

CameraFile read_any(const std::filesystem::path& path) {
  const std::string bytes = read_input_file(path);
  const StorageFile file(path, bytes, kExpected);
  const KnownKey* const known = known_key(file);
  if (known == nullptr) file.fail("camera_size", std::string("is missing; ") + kExpected);
  // In our own files, nothing may follow the keys and values.
  if (known->read == read_own) return read_own(StorageFile(path, bytes));
  return known->read(file);
}

}  // namespace

std::string_view name(CameraFileFormat format) {
  constexpr std::array<std::string_view, 5> kNames = {"Palpate", "OpenCV", "ROS", "RealSense",
                                                      "Open3D"};
  return kNames.at(static_cast<std::size_t>(format));
}

bool is_camera_file(const std::filesystem::path& path) {
  const StorageFile file(path, read_input_file(path),
                         "write `key: value` in each line, or a JSON object");
  return known_key(file) != nullptr;
}

CameraFile read_camera_file(const std::filesystem::path& path) {
  CameraFile read = read_any(path);
  try {
    geometry::check_camera(read.camera, (path.string() + ": camera").c_str());
  } catch (const InvalidInput& error) {
    throw FileError(error.what());
  }
  return read;
}

geometry::Camera read_camera(const std::filesystem::path& path) {
  return read_camera_file(path).camera;
}

void write_camera(const std::filesystem::path& path, const geometry::Camera& camera) {
  geometry::check_camera(camera, "write_camera");
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  write_lens(storage, "camera", camera);
  const std::string text = storage.releaseAndGetString();
  write_file(path, [&](std::ostream& out) { out << text; });
}

void write_open3d_camera(const std::filesystem::path& path, const geometry::Camera& camera,
                         double mm_per_unit) {
  geometry::check_camera(camera, "write_open3d_camera");
  require("write_open3d_camera(): mm_per_unit", mm_per_unit, above(0).finite(), "mm");
  if (!all_zero(camera.distortion)) {
    throw InvalidInput(path.string() +
                       ": the camera has a lens distortion, which this format does not hold; "
                       "undistort the images, and pass the camera of those");
  }
  write_file(path, [&](std::ostream& out) {
    out << fmt::format(
        "{{\n  \"width\": {},\n  \"height\": {},\n  \"intrinsic_matrix\": "
        "[{}, 0, 0, 0, {}, 0, {}, {}, 1],\n  \"depth_scale\": {}\n}}\n",
        camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
        kMetre / mm_per_unit);
  });
}

CameraFile CameraFiles::read(const std::filesystem::path& path) {
  const std::scoped_lock lock(mutex_);
  const auto known = files_.find(path);
  return known != files_.end() ? known->second
                               : files_.emplace(path, read_camera_file(path)).first->second;
}

}  // namespace palpate::sensing
