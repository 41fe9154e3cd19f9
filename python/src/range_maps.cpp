// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "output_path.h"
#include "palpate/geometry/camera.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/range_map_selection.h"
#include "palpate/geometry/range_map_smoothing.h"
#include "plausible.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using geometry::Camera;
using geometry::RangeMap;
using geometry::TriangleMesh;

Camera new_camera(int width, int height, double fx, double fy, double cx, double cy,
                  const std::vector<double>& distortion) {
  Camera camera{.width = width, .height = height, .fx = fx, .fy = fy, .cx = cx, .cy = cy};
  if (distortion.size() > camera.distortion.size()) {
    throw InvalidInput("distortion: has " + std::to_string(distortion.size()) +
                       " numbers; it must have at most 8");
  }
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
  geometry::check_camera(camera, "Camera()");
  return camera;
}

}  // namespace

void add_range_maps(py::module_& module) {
  py::class_<Camera>(module, "Camera", R"(A pinhole camera with the lens distortion of OpenCV.

Frame: X right, Y down, Z out of the lens; pixel centres are at whole numbers, (0, 0) top left.)")
      .def(py::init(&new_camera), kw_only(), arg("width"), arg("height"), arg("fx"), arg("fy"),
           arg("cx"), arg("cy"), arg("distortion") = std::vector<double>{},
           "All in px; distortion: k1 k2 p1 p2 k3 k4 k5 k6, the last ones may be left out.")
      .def_readonly("width", &Camera::width, "[px]")
      .def_readonly("height", &Camera::height, "[px]")
      .def_readonly("fx", &Camera::fx, "[px]")
      .def_readonly("fy", &Camera::fy, "[px]")
      .def_readonly("cx", &Camera::cx, "[px]")
      .def_readonly("cy", &Camera::cy, "[px]")
      .def_property_readonly(
          "distortion",
          [](const Camera& camera) {
            return py::array_t<double>(static_cast<py::ssize_t>(camera.distortion.size()),
                                       camera.distortion.data());
          },
          "(8,) k1 k2 p1 p2 k3 k4 k5 k6");

  py::class_<RangeMap>(module, "RangeMap", "Depths on the raw pixel grid of a camera.")
      .def(py::init([](const py::object& z, const Camera& camera) {
             RangeMap map{.z = image(z, "z"), .camera = camera};
             if (map.z.rows() != camera.height || map.z.cols() != camera.width) {
               throw InvalidInput("z: is " + std::to_string(map.z.cols()) + " x " +
                                  std::to_string(map.z.rows()) + " pixels, but the camera has " +
                                  std::to_string(camera.width) + " x " +
                                  std::to_string(camera.height));
             }
             return map;
           }),
           arg("z"), arg("camera"),
           R"(Copies (height, width) depths [mm] along the optical axis; NaN where unknown.

Raises InvalidInput unless the camera has this size.)")
      .def_property_readonly(
          "z", [](const py::object& self) { return image_view(self.cast<RangeMap&>().z, self); },
          R"([mm] (height, width) float32 depths along the optical axis, NaN where unknown.

A view without a copy, which keeps the map alive. Writing changes the map.)")
      .def_readonly("camera", &RangeMap::camera, "The camera of the pixels.")
      .def(
          "points",
          [](const RangeMap& map) {
            Eigen::Matrix3Xd points;
            {
              const Unlocked unlocked;
              points = geometry::back_project(map);
            }
            return own_rows(std::move(points));
          },
          "[mm] (height * width, 3): the point of each pixel, row by row; NaN where unknown.")
      .def("__repr__",
           [](const RangeMap& map) {
             return "<palpate.RangeMap: " + std::to_string(map.z.cols()) + " x " +
                    std::to_string(map.z.rows()) + " pixels, " +
                    std::to_string((map.z == map.z).count()) + " with a depth>";
           })
      .def("_repr_html_", drawn_by("range_map_html"));
  module.def(
      "write_range_map",
      [](const fs::path& path, const RangeMap& map) {
        const Unlocked unlocked;
        geometry::write_depth_tiff(output_path(path), map.z);
      },
      arg("path"), arg("map"),
      R"(Writes the depths as float32 TIFF, exactly; the camera is not written.

Its folder must exist. A file is replaced as a whole, or not at all. Raises OutputError.)");
  def_with_options<geometry::RangeMapMeshOptions>(
      module, "mesh_from(map: RangeMap, *", "TriangleMesh",
      R"(Triangulates a range map, in the frame of its camera [mm]; normals point to the camera.

Warns of a camera or depths that are unlikely. Raises InvalidInput, also if they are impossible.
Ctrl-C is not heard.)",
      [](const RangeMap& map, const py::kwargs& keywords) {
        const auto options = options_from<geometry::RangeMapMeshOptions>(keywords);
        tell_doubts("mesh_from(): map", sensing::range_map_doubts(map));
        const Unlocked unlocked;
        return geometry::mesh_range_map(map, options).mesh;
      },
      arg("map"));
  def_with_options<geometry::RangeMapSelectionOptions>(
      module, "select_depths(map: RangeMap, *, mask: ArrayLike | None = None", "RangeMap",
      R"(Leaves out the background of an object: those depths become NaN.

mask: (height, width); pixels where it is 0 or False are left out.
The options act in the order near, far, crop, mask, remove_plane. Raises InvalidInput. Ctrl-C is not
heard.)",
      [](const RangeMap& map, const py::object& mask, const py::kwargs& keywords) {
        const auto options = options_from<geometry::RangeMapSelectionOptions>(keywords);
        geometry::PixelMask kept;
        if (!mask.is_none()) {
          kept = image(mask, "mask") != 0;
          if (kept.size() == 0)
            throw InvalidInput(
                "mask: has no pixel; give one of the size of the range map, or None");
        }
        const Unlocked unlocked;
        return RangeMap{geometry::select_depths(map, options, kept).z, map.camera};
      },
      arg("map"), kw_only(), arg("mask") = py::none());
  def_with_options<geometry::RangeMapSmoothingOptions>(
      module, "smooth_depths(map: RangeMap, sigma: ArrayLike, *", "RangeMap",
      R"(Reduces the noise of depths within their standard deviations; steps stay where they are.

sigma: [mm] (height, width) of each depth; one without it (NaN) stays as it is.
Raises InvalidInput. Ctrl-C is not heard.)",
      [](const RangeMap& map, const py::object& sigma, const py::kwargs& keywords) {
        const auto options = options_from<geometry::RangeMapSmoothingOptions>(keywords);
        const geometry::ImageF deviations = image(sigma, "sigma");
        const Unlocked unlocked;
        return RangeMap{geometry::smooth_range_map(map.z, deviations, options), map.camera};
      },
      arg("map"), arg("sigma"));
}

}  // namespace palpate::python
