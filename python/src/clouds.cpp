// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "output_path.h"
#include "palpate/geometry/attribute.h"
#include "palpate/geometry/cloud_clusters.h"
#include "palpate/geometry/cloud_distance.h"
#include "palpate/geometry/cloud_normals.h"
#include "palpate/geometry/cloud_outliers.h"
#include "palpate/geometry/cloud_sampling.h"
#include "palpate/geometry/cloud_shapes.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using geometry::CloudCylinder;
using geometry::CloudPlane;
using geometry::CloudShapeOptions;
using geometry::CloudSphere;

template <typename Scalar>
py::array_t<Scalar> array_of(const std::vector<Scalar>& numbers) {
  return py::array_t<Scalar>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

/// Calls a function without the lock of the interpreter.
template <typename Function>
auto unlocked(const Function& function) {
  const Unlocked while_it_works;
  return function();
}

void add_point_files(py::module_& module) {
  module.def(
      "read_points",
      [](const fs::path& path, const std::optional<double>& unit) {
        return own_rows(unlocked(
            [&] { return std::move(geometry::read_point_cloud(path, {.unit = unit}).points); }));
      },
      arg("path"), kw_only(), arg("unit") = py::none(),
      R"(Reads points [mm]: PCD, or the vertices of PLY, OBJ, OFF, STL and others: (N, 3).

Unknown points are NaN. Colours, normals and other attributes are left out.
unit: [mm] length of one unit of the file; None: what the file declares, or mm.
Raises FileError. Ctrl-C is not heard.)");
  module.def(
      "write_points",
      [](const fs::path& path, const py::object& points, const py::object& normals) {
        const Points given(points, "points");
        geometry::PointCloud cloud;
        cloud.points = given.columns();
        cloud.width = cloud.points.cols();
        if (!normals.is_none())
          geometry::set_normals(cloud.attributes, Points(normals, "normals").columns());
        const Unlocked while_it_writes;
        geometry::write_point_cloud(output_path(path), cloud);
      },
      arg("path"), arg("points"), kw_only(), arg("normals") = py::none(),
      R"(Writes (N, 3) points in mm, and normals if they are given, as .pcd or .ply.

Its folder must exist. A file is replaced as a whole, or not at all. Raises InvalidInput or OutputError.)");
}

void add_selection(py::module_& module) {
  def_with_options<geometry::OutlierOptions>(
      module, "without_outliers(points: ArrayLike, *, progress: Callable | None = None", "NDArray",
      R"(Indices of the points that are not unusually far from their neighbours, ascending: int32.

progress: called as progress(done, total) after each part of the points; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const py::object& points, const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<geometry::OutlierOptions>(keywords);
        const Points given(points, "points");
        LongWork work(progress);
        options.progress = work.report();
        return array_of(
            work.run([&] { return geometry::without_outliers(given.columns(), options); }));
      },
      arg("points"), kw_only(), arg("progress") = py::none());
  module.def(
      "without_isolated",
      [](const py::object& points, double radius, int neighbours, const py::object& progress) {
        const Points given(points, "points");
        LongWork work(progress);
        return array_of(work.run([&] {
          return geometry::without_isolated(given.columns(), radius, neighbours, work.report());
        }));
      },
      arg("points"), arg("radius"), arg("neighbours"), kw_only(), arg("progress") = py::none(),
      R"(Indices of the points that have at least this number of others within the radius [mm], ascending: int32.

progress: called as progress(done, total) after each part of the points; Ctrl-C is heard then.
Raises InvalidInput.)");
  module.def(
      "voxel_sample",
      [](const py::object& points, double edge) {
        const Points given(points, "points");
        geometry::VoxelSample sample =
            unlocked([&] { return geometry::voxel_sample(given.columns(), edge); });
        return std::pair(own_rows(std::move(sample.points)), array_of(sample.voxel));
      },
      arg("points"), arg("edge"),
      R"(The means of the points in each cube of the given edge [mm], (V, 3), and the cube of each point.

The second array is (N,) int32: the index of the mean that a point is in; -1 for a point that is not
finite. Raises InvalidInput. Ctrl-C is not heard.)");
  module.def(
      "poisson_sample",
      [](const py::object& points, double min_distance, const py::object& progress) {
        const Points given(points, "points");
        LongWork work(progress);
        return array_of(work.run([&] {
          return geometry::poisson_sample(given.columns(), min_distance, work.report());
        }));
      },
      arg("points"), arg("min_distance"), kw_only(), arg("progress") = py::none(),
      R"(Indices of points that cover the cloud evenly, no two closer than min_distance [mm]: int32.

progress: called as progress(done, total) after each part of the points; Ctrl-C is heard then.
Raises InvalidInput.)");
  def_with_options<geometry::CloudClusterOptions>(
      module, "cloud_clusters(points: ArrayLike, *, progress: Callable | None = None", "NDArray",
      R"(The cluster of each point, (N,) int32: 0 is the largest; -1: in none.

Give max_gap.
progress: called as progress(done, total) after each part of the work; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const py::object& points, const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<geometry::CloudClusterOptions>(keywords);
        const Points given(points, "points");
        LongWork work(progress);
        options.progress = work.report();
        return array_of(
            work.run([&] { return geometry::cloud_clusters(given.columns(), options); }).cluster);
      },
      arg("points"), kw_only(), arg("progress") = py::none());
}

void add_measures(py::module_& module) {
  def_with_options<geometry::CloudNormalOptions>(
      module,
      "cloud_normals(points: ArrayLike, *, viewpoint: ArrayLike | None = None, progress: Callable "
      "| None = None",
      "NDArray",
      R"(Unit normals of the planes of the nearest neighbours of each point, (N, 3); NaN where unknown.

viewpoint: [mm] (3,) where the points were seen from: normals point there. None: neighbours get the
same side, and normals point outwards.
progress: called as progress(done, total) after each part of the points; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const py::object& points, const py::object& viewpoint, const py::object& progress,
         const py::kwargs& keywords) {
        auto options = options_from<geometry::CloudNormalOptions>(keywords);
        const Points given(points, "points");
        LongWork work(progress);
        options.progress = work.report();
        if (!viewpoint.is_none()) options.viewpoints = vector3(viewpoint, "viewpoint");
        return own_rows(work.run(
            [&] { return std::move(geometry::cloud_normals(given.columns(), options).normals); }));
      },
      arg("points"), kw_only(), arg("viewpoint") = py::none(), arg("progress") = py::none());
  module.def(
      "distances_to_cloud",
      [](const py::object& points, const py::object& cloud, const py::object& progress) {
        const Points given(points, "points"), reference(cloud, "cloud");
        LongWork work(progress);
        const Eigen::VectorXd distances = work.run([&] {
          return geometry::distances_to_cloud(given.columns(), reference.columns(), work.report());
        });
        return py::array_t<double>(distances.size(), distances.data());
      },
      arg("points"), arg("cloud"), kw_only(), arg("progress") = py::none(),
      R"(Distance [mm] of each of (N, 3) points from the nearest point of a cloud: (N,).

NaN for a point that is not finite.
progress: called as progress(done, total) after each part of the points; Ctrl-C is heard then.
Raises InvalidInput if no point of the cloud is finite.)");
  module.def(
      "distances_to_surface",
      [](const py::object& points, const geometry::TriangleMesh& mesh) {
        const Points given(points, "points");
        const Eigen::VectorXd distances =
            unlocked([&] { return geometry::distances_to_surface(given.columns(), mesh); });
        return py::array_t<double>(distances.size(), distances.data());
      },
      arg("points"), arg("mesh"),
      R"(Signed distance [mm] of each of (N, 3) points from a surface: (N,).

Positive on the side of the surface's normals; NaN for a point that is not finite.
Raises InvalidInput. Ctrl-C is not heard.)");
}

/// Adds the members that all shapes have.
template <typename Shape>
py::class_<Shape> add_shape(py::module_& module, const char* name, const char* doc) {
  return py::class_<Shape>(module, name, doc)
      .def_property_readonly(
          "inliers",
          [](const py::object& self) { return vector_view(self.cast<Shape&>().inliers, self); },
          "(M,) int32: indices of the points within the tolerance, ascending.")
      .def_property_readonly(
          "rms", [](const Shape& shape) { return shape.rms; },
          "[mm] of the distances of these points from the shape.");
}

/// Adds a function that finds a shape. \param find called with points and options.
template <typename Shape>
void def_shape(py::module_& module, const std::string& name, const std::string& shape,
               const std::string& text,
               std::optional<Shape> (*find)(const Eigen::Ref<const Eigen::Matrix3Xd>&,
                                            const CloudShapeOptions&)) {
  def_with_options<CloudShapeOptions>(
      module, name + "(points: ArrayLike, *, progress: Callable | None = None", shape + " | None",
      text,
      [find](const py::object& points, const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<CloudShapeOptions>(keywords);
        const Points given(points, "points");
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return find(given.columns(), options); });
      },
      arg("points"), kw_only(), arg("progress") = py::none());
}

void add_shapes(py::module_& module) {
  add_shape<CloudPlane>(module, "CloudPlane", "A plane in a cloud.")
      .def_property_readonly(
          "point", [](const CloudPlane& plane) { return copy_of(plane.point); },
          "[mm] (3,) centroid of the inliers.")
      .def_property_readonly(
          "normal", [](const CloudPlane& plane) { return copy_of(plane.normal); },
          "(3,) of unit length; its largest coordinate is positive.");
  add_shape<CloudSphere>(module, "CloudSphere", "A sphere in a cloud.")
      .def_property_readonly(
          "centre", [](const CloudSphere& sphere) { return copy_of(sphere.centre); }, "[mm] (3,)")
      .def_readonly("radius", &CloudSphere::radius, "[mm]");
  add_shape<CloudCylinder>(module, "CloudCylinder", "A cylinder in a cloud.")
      .def_property_readonly(
          "point", [](const CloudCylinder& cylinder) { return copy_of(cylinder.point); },
          "[mm] (3,) on the axis, amid the inliers.")
      .def_property_readonly(
          "axis", [](const CloudCylinder& cylinder) { return copy_of(cylinder.axis); },
          "(3,) of unit length; its largest coordinate is positive.")
      .def_readonly("radius", &CloudCylinder::radius, "[mm]")
      .def_readonly("length", &CloudCylinder::length, "[mm] of the inliers along the axis.");
  def_shape<CloudPlane>(
      module, "find_plane", "CloudPlane",
      R"(The largest plane in (N, 3) points [mm], by random samples and least squares; None without one.

Give tolerance; a plane has no max_radius.
progress: called as progress(done, total) after each part of the search; Ctrl-C is heard then.
Raises InvalidInput.)",
      &geometry::find_plane);
  def_shape<CloudSphere>(module, "find_sphere", "CloudSphere",
                         R"(The largest sphere in (N, 3) points [mm]; None without one.

Give tolerance. progress and errors are those of find_plane().)",
                         &geometry::find_sphere);
  def_with_options<CloudShapeOptions>(
      module,
      "find_cylinder(points: ArrayLike, normals: ArrayLike, *, progress: Callable | None = None",
      "CloudCylinder | None",
      R"(The largest cylinder in (N, 3) points [mm]; None without one.

normals: (N, 3), as from cloud_normals(); their side does not matter.
Give tolerance. progress and errors are those of find_plane().)",
      [](const py::object& points, const py::object& normals, const py::object& progress,
         const py::kwargs& keywords) {
        auto options = options_from<CloudShapeOptions>(keywords);
        const Points given(points, "points"), directions(normals, "normals");
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] {
          return geometry::find_cylinder(given.columns(), directions.columns(), options);
        });
      },
      arg("points"), arg("normals"), kw_only(), arg("progress") = py::none());
}

}  // namespace

void add_clouds(py::module_& module) {
  add_point_files(module);
  add_selection(module);
  add_measures(module);
  add_shapes(module);
}

}  // namespace palpate::python
