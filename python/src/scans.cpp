// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/smoothing.h"

// From scans to one clean surface.
namespace palpate::python {
namespace {

using geometry::FilledMesh;
using geometry::MergedScans;
using geometry::MergeScansOptions;
using geometry::Scan;
using geometry::SmoothingOptions;
using geometry::TriangleMesh;

/// One for each mesh, or none at all.
void check_count(const char* name, const std::vector<py::object>& given, std::size_t meshes) {
  if (given.empty() || given.size() == meshes) return;
  throw InvalidInput(std::string(name) + ": there are " + std::to_string(given.size()) +
                     "; there must be one for each of the " + std::to_string(meshes) + " meshes");
}

std::vector<Scan> scans_of(const std::vector<TriangleMesh>& meshes,
                           const std::vector<py::object>& poses,
                           const std::vector<py::object>& sigmas) {
  check_count("poses", poses, meshes.size());
  check_count("sigmas", sigmas, meshes.size());
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    Scan& scan = scans.emplace_back(Scan{.mesh = meshes[i]});
    const std::string place = "[" + std::to_string(i) + "]";
    if (!poses.empty()) scan.T_object_scan = isometry(poses[i], ("poses" + place).c_str());
    if (sigmas.empty()) continue;
    const py::array_t<double> numbers = real_numbers(sigmas[i], ("sigmas" + place).c_str());
    scan.sigma = Eigen::Map<const Eigen::VectorXd>(numbers.data(), numbers.size());
  }
  return scans;
}

void add_merging(py::module_& module) {
  py::class_<MergedScans>(module, "MergedScans", "The result of merge_scans().")
      .def_readonly("mesh", &MergedScans::mesh, "The surface, in the frame of the object.")
      .def_property_readonly(
          "sigma",
          [](const py::object& self) { return vector_view(self.cast<MergedScans&>().sigma, self); },
          "[mm] (V,) standard deviations of the vertices; empty unless all scans have sigmas.")
      .def_readonly("spacing", &MergedScans::spacing, "[mm] of the grid.")
      .def_property_readonly(
          "conflicts",
          [](const MergedScans& merged) {
            std::vector<std::tuple<int, int, double, double>> pairs;
            for (const geometry::ScanConflict& found : merged.conflicts)
              pairs.emplace_back(found.scan, found.other, found.share, found.depth);
            return pairs;
          },
          "Read this before you use the mesh: (scan, other, share, depth [mm]) of the pairs of "
          "scans that disagree, the worst first. A share of the places that the first saw lies "
          "behind the surface of the other.");
  def_with_options<MergeScansOptions>(
      module,
      "merge_scans(meshes: Sequence[TriangleMesh], *, poses: Sequence[ArrayLike] = (), sigmas: "
      "Sequence[ArrayLike] = (), progress: Callable | None = None",
      "MergedScans",
      R"(Merges overlapping scans into one surface that averages them.

meshes: their triangles face the outside of the object.
poses: a (4, 4) matrix for each mesh, from its frame to that of the object, as
Registration.T_target_source; without them, all meshes are in one frame.
sigmas: [mm] for each mesh the standard deviations of its vertices, (V,); without them, all weigh
the same.
progress: called as progress(done, total), several times for each mesh; Ctrl-C is heard then.
Raises InvalidInput or SolverError.)",
      [](const std::vector<TriangleMesh>& meshes, const std::vector<py::object>& poses,
         const std::vector<py::object>& sigmas, const py::object& progress,
         const py::kwargs& keywords) {
        auto options = options_from<MergeScansOptions>(keywords);
        const std::vector<Scan> scans = scans_of(meshes, poses, sigmas);
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return geometry::merge_scans(scans, options); });
      },
      arg("meshes"), kw_only(), arg("poses") = py::tuple(), arg("sigmas") = py::tuple(),
      arg("progress") = py::none());
}

void add_hole_filling(py::module_& module) {
  py::class_<FilledMesh>(module, "FilledMesh", "The result of fill_holes().")
      .def_readonly("mesh", &FilledMesh::mesh, "The mesh, and then the patches.")
      .def_readonly("filled", &FilledMesh::filled, "Number of holes filled.")
      .def_readonly("left", &FilledMesh::left, "Number of borders that stay.");
  def_with_options<geometry::HoleFillingOptions>(
      module, "fill_holes(mesh: TriangleMesh, *, progress: Callable | None = None", "FilledMesh",
      R"(Fills holes with patches that are as dense as their rim and continue the surface smoothly.

Give max_diameter. The outline of an open surface stays, unless that is infinite.
progress: called as progress(done, total) after each border; Ctrl-C is heard then.
Raises InvalidInput unless the mesh is manifold and oriented: see repair().)",
      [](const TriangleMesh& mesh, const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<geometry::HoleFillingOptions>(keywords);
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return geometry::fill_holes(mesh, options); });
      },
      arg("mesh"), kw_only(), arg("progress") = py::none());
}

}  // namespace

void add_scans(py::module_& module) {
  add_merging(module);
  add_hole_filling(module);
  def_with_options<SmoothingOptions>(
      module, "smooth(mesh: TriangleMesh, *", "TriangleMesh",
      R"(Smooths a copy of a mesh without shrinking it (Taubin 1995).

Raises InvalidInput. Ctrl-C is not heard.)",
      [](const TriangleMesh& mesh, const py::kwargs& keywords) {
        const auto options = options_from<SmoothingOptions>(keywords);
        const Unlocked unlocked;
        return geometry::smooth(mesh, options);
      },
      arg("mesh"));
}

}  // namespace palpate::python
