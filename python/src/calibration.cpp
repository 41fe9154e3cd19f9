// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/rig_view_files.h"
#include "plausible.h"

// Camera and projector from views of a board.
namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using sensing::RigCalibration;
using sensing::RigCalibrationOptions;
using sensing::RigView;

/// Width and height [px].
using Size = std::pair<int, int>;

sensing::ImageSize size_of(const Size& size) { return {size.first, size.second}; }

/// An argument of shape (N, 2). \throws InvalidInput
Eigen::Matrix2Xd pairs(const py::object& object, const char* name) {
  const py::array_t<double> numbers = real_numbers(object, name);
  if (numbers.ndim() != 2 || numbers.shape(1) != 2)
    throw InvalidInput(std::string(name) + ": must have the shape (N, 2)");
  return Eigen::Map<const Eigen::Matrix2Xd>(numbers.data(), 2, numbers.shape(0));
}

py::array_t<double> rows_of(const Eigen::Matrix2Xd& points) {
  return py::array_t<double>({points.cols(), Eigen::Index{2}}, points.data());
}

void add_views(py::module_& module) {
  const auto points = [](auto member) {
    return [member](const RigView& view) { return rows_of(view.*member); };
  };
  py::class_<RigView>(module, "RigView", "What camera and projector show of one pose of a board.")
      .def(py::init([](const std::string& name, const py::object& board, const py::object& camera,
                       const py::object& lit_camera, const py::object& projector) {
             return RigView{name, pairs(board, "board"), pairs(camera, "camera"),
                            pairs(lit_camera, "lit_camera"), pairs(projector, "projector")};
           }),
           arg("name"), kw_only(), arg("board"), arg("camera"), arg("lit_camera"), arg("projector"),
           R"(Of points that another program has found.

name: for messages. board: (N, 2) printed points [mm], and camera: (N, 2) their pixels.
lit_camera: (M, 2) pixels that see the board, and projector: (M, 2) what lights it there [px].)")
      .def_readonly("name", &RigView::name, "For messages: of files, that of the folder.")
      .def_property_readonly("board", points(&RigView::board), "[mm] (N, 2) printed points.")
      .def_property_readonly("camera", points(&RigView::camera), "[px] (N, 2) their pixels.")
      .def_property_readonly("lit_camera", points(&RigView::lit_camera),
                             "[px] (M, 2) in the camera, of lit points of the board.")
      .def_property_readonly("projector", points(&RigView::projector),
                             "[px] (M, 2) what lights these.");
  module.def(
      "read_rig_views",
      [](const std::vector<fs::path>& folders, const Size& projector_size, int columns, int rows,
         double square, double marker, int marker_bits, const py::object& progress) {
        const sensing::Board board{columns, rows, square, marker, marker_bits};
        LongWork work(progress);
        sensing::RigViewFiles files = work.run([&] {
          return sensing::read_rig_views(folders, board, size_of(projector_size), {},
                                         work.report());
        });
        return std::pair(std::move(files.views), Size(files.camera.width, files.camera.height));
      },
      arg("folders"), arg("projector_size"), kw_only(), arg("columns"), arg("rows"), arg("square"),
      arg("marker") = 0.0, arg("marker_bits") = sensing::Board{}.marker_bits,
      arg("progress") = py::none(),
      R"(Reads the poses of a board from folders of images, as `palpate calibrate rig` does.

projector_size: (width, height) [px].
columns, rows: inner corners of the board; square: [mm] side of a square.
marker: [mm] side of a ChArUco board's markers; 0: a chessboard. marker_bits: along their side.
progress: called as progress(done, total) after each pose; Ctrl-C is heard then.
Returns the views and the (width, height) of the camera's images. Raises FileError or InvalidInput.)");
}

void add_rig_calibration(py::module_& module) {
  py::class_<RigCalibration>(module, "RigCalibration", "The result of calibrate_rig().")
      .def_readonly("rig", &RigCalibration::rig, "Camera, projector and the pose between them.")
      .def_readonly("camera_rms", &RigCalibration::camera_rms, "[px] over all points.")
      .def_readonly("projector_rms", &RigCalibration::projector_rms, "[px] over all points.")
      .def_readonly("stereo_rms", &RigCalibration::stereo_rms,
                    "[px] over the points of both: the error of OpenCV's stereoCalibrate.")
      .def_readonly("depth_deviation", &RigCalibration::depth_deviation,
                    "Median standard deviation of depths by the rig's errors, relative to the "
                    "depth.")
      .def_readonly("advice", &RigCalibration::advice,
                    "What the views determine badly, and which pose to add.")
      .def_property_readonly(
          "views",
          [](const RigCalibration& calibration) {
            std::vector<std::tuple<std::string, double, double>> views;
            for (const sensing::ViewResiduals& view : calibration.views)
              views.emplace_back(view.name, view.camera_rms, view.projector_rms);
            return views;
          },
          "(name, camera_rms, projector_rms) [px] of the views that were used.")
      .def_property_readonly(
          "rejected",
          [](const RigCalibration& calibration) {
            std::vector<std::pair<std::string, std::string>> views;
            for (const sensing::RejectedView& view : calibration.rejected)
              views.emplace_back(view.name, view.reason);
            return views;
          },
          "(name, reason) of the others.");
  def_with_options<RigCalibrationOptions>(
      module,
      "calibrate_rig(views: Sequence[RigView], camera_size: tuple[int, int], projector_size: "
      "tuple[int, int], *",
      "RigCalibration",
      R"(Calibrates camera, projector and the pose between them from views of a board.

camera_size, projector_size: (width, height) [px].
Warns of lengths and angles that are unlikely. Raises InvalidInput, or SolverError if the views do
not determine the rig, which tells what to show. Ctrl-C is not heard.)",
      [](const std::vector<RigView>& views, const Size& camera_size, const Size& projector_size,
         const py::kwargs& keywords) {
        const auto options = options_from<RigCalibrationOptions>(keywords);
        RigCalibration calibration;
        {
          const Unlocked unlocked;
          calibration =
              sensing::calibrate_rig(views, size_of(camera_size), size_of(projector_size), options);
        }
        tell_doubts("calibrate_rig()", sensing::rig_doubts(calibration.rig));
        return calibration;
      },
      arg("views"), arg("camera_size"), arg("projector_size"));
}

}  // namespace

void add_calibration(py::module_& module) {
  add_views(module);
  add_rig_calibration(module);
}

}  // namespace palpate::python
