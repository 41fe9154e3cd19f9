// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "output_path.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/remeshing.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using geometry::Decimation;
using geometry::RepairedMesh;
using geometry::TriangleMesh;

TriangleMesh new_mesh(const py::object& vertices, const py::object& triangles) {
  TriangleMesh mesh{.vertices = Points(vertices, "vertices").columns(), .triangles = {}};
  const py::array_t<int> corners = indices(triangles, "triangles", 2);
  mesh.triangles = Eigen::Map<const Eigen::Matrix3Xi>(corners.data(), 3, corners.shape(0));
  return mesh;
}

void add_mesh(py::module_& module) {
  py::class_<TriangleMesh>(module, "TriangleMesh", R"(A triangle mesh.

Each function checks the mesh that it gets, so a vertex may be moved to anywhere: what is wrong
then raises InvalidInput.)")
      .def(
          py::init(&new_mesh), arg("vertices"), arg("triangles"),
          R"(Copies (V, 3) coordinates [mm] and (T, 3) indices of vertices, counter-clockwise seen from outside.

Numbers may have any real type and order. An index that is negative, no whole number or beyond
2^31 - 1 raises InvalidInput, which names its place.)")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return rows_view(self.cast<TriangleMesh&>().vertices, self);
          },
          R"([mm] (V, 3) float64: a view without a copy, which keeps the mesh alive.

Writing moves the vertices of the mesh. Do not write while a function works on the mesh in another
thread.)")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return rows_view(self.cast<TriangleMesh&>().triangles, self, View::read_only);
          },
          "(T, 3) int32 indices of vertices: a view without a copy, which cannot be written to.")
      .def("__repr__",
           [](const TriangleMesh& mesh) {
             return "<palpate.TriangleMesh: " + std::to_string(mesh.vertices.cols()) +
                    " vertices, " + std::to_string(mesh.triangles.cols()) + " triangles>";
           })
      .def(py::pickle(
          [](const TriangleMesh& mesh) {
            return py::make_tuple(own_rows(Eigen::Matrix3Xd(mesh.vertices)),
                                  own_rows(Eigen::Matrix3Xi(mesh.triangles)));
          },
          [](const py::tuple& state) { return new_mesh(state[0], state[1]); }))
      .def("_repr_html_", drawn_by("mesh_html"));

  module.def(
      "read_mesh",
      [](const fs::path& path, const std::optional<double>& unit, bool keep_defects) {
        const Unlocked unlocked;
        return geometry::read_mesh(path, {.unit = unit, .keep_defects = keep_defects});
      },
      arg("path"), kw_only(), arg("unit") = py::none(), arg("keep_defects") = false,
      R"(Reads a mesh: PLY, OBJ, OFF, STL, glTF and others; the extension tells which.

unit: [mm] length of one unit of the file; None: what the file declares, or mm.
keep_defects: also read a mesh with defects, for repair().
Raises FileError. Ctrl-C is not heard.)");
  module.def(
      "write_mesh",
      [](const fs::path& path, const TriangleMesh& mesh) {
        const Unlocked unlocked;
        geometry::write_mesh(output_path(path), mesh);
      },
      arg("path"), arg("mesh"),
      R"(Writes a mesh in mm as .ply, .obj, .vtk (exactly), .stl (rounded to float32) or .glb (in metres, float32).

Its folder must exist. A file is replaced as a whole, or not at all. Raises InvalidInput or OutputError.)");
}

void add_decimation(py::module_& module) {
  py::class_<Decimation>(module, "Decimation", "The result of decimate().")
      .def_readonly("mesh", &Decimation::mesh, "The mesh with fewer triangles.")
      .def_property_readonly(
          "source",
          [](const py::object& self) { return vector_view(self.cast<Decimation&>().source, self); },
          "(V,) int32: the input vertex of each vertex, ascending.")
      .def_readonly("distance", &Decimation::distance,
                    "[mm] Verified upper bound of the Hausdorff distance to the input.")
      .def_readonly("tries", &Decimation::tries, "Number of meshes that were made and checked.")
      .def("__repr__", [](const Decimation& decimated) {
        return "<palpate.Decimation: " + std::to_string(decimated.mesh.triangles.cols()) +
               " triangles, at most " + std::to_string(decimated.distance) + " mm off>";
      });
  def_with_options<geometry::DecimationOptions>(
      module, "decimate(mesh: TriangleMesh, *, progress: Callable | None = None", "Decimation",
      R"(Reduces the number of triangles; the vertices are a subset of the input's.

Give exactly one of tolerance and max_triangles.
progress: called as progress(done, total) after each mesh that was tried; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const TriangleMesh& mesh, const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<geometry::DecimationOptions>(keywords);
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return geometry::decimate(mesh, options); });
      },
      arg("mesh"), kw_only(), arg("progress") = py::none());

  py::class_<RepairedMesh>(module, "RepairedMesh", "The result of repair(), with what was done.")
      .def_readonly("mesh", &RepairedMesh::mesh, "The mesh without defects.")
      .def_property_readonly(
          "source",
          [](const py::object& self) {
            return vector_view(self.cast<RepairedMesh&>().source, self);
          },
          "(V,) int32: the input vertex of each vertex.")
      .def_readonly("removed_triangles", &RepairedMesh::removed_triangles,
                    "Triangles with invalid corners, repeated, or without area.")
      .def_readonly("flipped_edges", &RepairedMesh::flipped_edges,
                    "Edges flipped to remove triangles with collinear vertices.")
      .def_readonly("turned_triangles", &RepairedMesh::turned_triangles,
                    "Triangles turned to match the larger part of their surface.")
      .def_readonly("welded_vertices", &RepairedMesh::welded_vertices,
                    "Vertices joined with an earlier one at exactly the same place.")
      .def_readonly("split_vertices", &RepairedMesh::split_vertices,
                    "Vertices added where parts that met at one vertex were separated.")
      .def_readonly("removed_vertices", &RepairedMesh::removed_vertices,
                    "Vertices that are not finite or have no triangle.")
      .def_readonly("cut_edges", &RepairedMesh::cut_edges,
                    "Edges at which triangles that cannot form one surface were separated.");
  module.def(
      "repair",
      [](const TriangleMesh& mesh, const py::object& progress) {
        LongWork work(progress);
        const geometry::RepairOptions options{.progress = work.report()};
        return work.run([&] { return geometry::repair_mesh(mesh, options); });
      },
      arg("mesh"), kw_only(), arg("progress") = py::none(),
      R"(Repairs a copy of a mesh: the result is oriented and manifold. Holes stay open.

progress: called as progress(done, total) after each part of the work; Ctrl-C is heard then.
Raises InvalidInput if no triangle can be kept.)");
}

/// Remeshing, with its places as arrays.
struct RemeshedArrays {
  TriangleMesh mesh;
  Eigen::VectorXi triangles;
  Eigen::Matrix3Xd barycentric;
};

RemeshedArrays arrays_of(geometry::Remeshing&& remeshed) {
  const auto count = static_cast<Eigen::Index>(remeshed.places.size());
  RemeshedArrays arrays{.mesh = std::move(remeshed.mesh),
                        .triangles = Eigen::VectorXi(count),
                        .barycentric = Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index v = 0; v < count; ++v) {
    const geometry::SurfacePoint& place = remeshed.places[static_cast<std::size_t>(v)];
    arrays.triangles[v] = place.triangle;
    arrays.barycentric.col(v) = place.barycentric;
  }
  return arrays;
}

void add_remeshing(py::module_& module) {
  py::class_<RemeshedArrays>(module, "Remeshing", "The result of remesh().")
      .def_readonly("mesh", &RemeshedArrays::mesh, "The mesh with edges of one length.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return vector_view(self.cast<RemeshedArrays&>().triangles, self);
          },
          "(V,) int32: the input's triangle on which each vertex is.")
      .def_property_readonly(
          "barycentric",
          [](const py::object& self) {
            return rows_view(self.cast<RemeshedArrays&>().barycentric, self);
          },
          "(V, 3) coordinates in it: weights for values of the input's vertices.");
  def_with_options<geometry::RemeshingOptions>(
      module, "remesh(mesh: TriangleMesh, *, progress: Callable | None = None", "Remeshing",
      R"(Makes the triangles nearly equilateral; the border and sharp edges stay where they are.

Give edge_length.
progress: called as progress(done, total) after each part of the work; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const TriangleMesh& mesh, const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<geometry::RemeshingOptions>(keywords);
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return arrays_of(geometry::remesh(mesh, options)); });
      },
      arg("mesh"), kw_only(), arg("progress") = py::none());
}

}  // namespace

void add_meshes(py::module_& module) {
  add_mesh(module);
  add_decimation(module);
  add_remeshing(module);
}

}  // namespace palpate::python
