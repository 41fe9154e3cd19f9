// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "maker/model_page.h"
#include "output_path.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_surface.h"
#include "plausible.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using haptics::BuildResult;
using haptics::ContactModel;
using haptics::Model;
using probing::CheckedAcquisition;

/// A property with one number of each contact.
template <typename Scalar, typename Member>
auto of_contacts(Member member) {
  return [member](const Model& model) {
    return gather<Scalar>(model.contacts,
                          [&](const ContactModel& contact) { return contact.*member; });
  };
}

/// The folder of page.html beside the Python files of this module.
fs::path page_folder() {
  const auto file = py::module_::import("palpate").attr("__file__").cast<std::string>();
  return fs::path(file).parent_path();
}

void add_model(py::module_& module) {
  py::class_<Model>(
      module, "Model",
      R"(A deformable object as it was measured: fit() and bake() make one, read_model() reads one.

Arrays of contacts are copies, in the order of the contacts.)")
      .def_property_readonly(
          "surface", [](const Model& model) { return model.surface; },
          "The undeformed surface [mm], a copy.")
      .def_property_readonly(
          "contacts",
          [](const Model& model) {
            return gather_rows(model.contacts,
                               [](const ContactModel& contact) { return contact.position; });
          },
          "[mm] (C, 3) places of the contacts on the undeformed surface.")
      .def_property_readonly("ids", of_contacts<long long>(&ContactModel::id),
                             "(C,) int64 ids of the contacts, as in the acquisition.")
      .def_property_readonly("friction", of_contacts<double>(&ContactModel::friction),
                             "(C,) coefficients of friction; 0 where nothing is known of it.")
      .def_property_readonly("rms", of_contacts<double>(&ContactModel::rms),
                             "[N] (C,) root mean square error of each fit at its samples.")
      .def_property_readonly("samples", of_contacts<int>(&ContactModel::samples),
                             "(C,) int32 number of samples of each fit.")
      .def_property_readonly(
          "triangles",
          [](const Model& model) { return own_rows(Eigen::Matrix3Xi(model.triangles)); },
          "(T, 3) int32 triangles of contacts, between which forces are interpolated.")
      .def_readonly("probe_radius", &Model::probe_radius,
                    "[mm] of the ball with which the object was measured; None: not known.")
      .def_property_readonly(
          "triangulation",
          [](const Model& model) { return geometry::to_string(model.triangulation); },
          "The method that made the triangles: 'delaunay' or 'voronoi_dual'.")
      .def_readonly(
          "samples_fingerprint", &Model::samples_fingerprint,
          "16 hexadecimal digits of the samples it was fitted to; None: of no acquisition.")
      .def_readonly("made", &Model::made,
                    "How it was made: sources, options, program (a copy). For people to read.")
      .def_property_readonly("unknown_friction", &haptics::unknown_friction_count,
                             "Number of contacts whose friction is unknown.")
      .def(
          "write",
          [](const Model& model, const fs::path& folder) {
            const Unlocked unlocked;
            haptics::write_model(output_path(folder), model);
          },
          arg("folder"),
          R"(Writes the model as a folder, as a whole or not at all; read_model() reads it back exactly.

A folder that holds anything but a model is not replaced. Raises InvalidInput or OutputError.)")
      .def(
          "page",
          [](const Model& model, const std::string& title, double unknown_friction) {
            const fs::path package = page_folder();
            const Unlocked unlocked;
            return web::model_page(model, {title, unknown_friction}, package / "page.html");
          },
          kw_only(), arg("title") = "", arg("unknown_friction") = 0.0,
          R"(The page of `palpate export --html`: HTML in which one presses and drags on the object.

unknown_friction: coefficient of contacts whose friction is unknown.
Raises InvalidInput if the model cannot be played.)")
      .def(
          "write_page",
          [](const Model& model, const fs::path& path, const std::string& title,
             double unknown_friction) {
            const fs::path package = page_folder();
            const Unlocked unlocked;
            const std::string page =
                web::model_page(model, {title, unknown_friction}, package / "page.html");
            write_file(output_path(path), [&](std::ostream& file) { file << page; });
          },
          arg("path"), kw_only(), arg("title") = "", arg("unknown_friction") = 0.0,
          "Writes page() to a file, as a whole or not at all. Raises OutputError.")
      .def(
          "show",
          [](const py::object& self, const std::string& title, double unknown_friction,
             int height) {
            py::module_::import("palpate._notebook")
                .attr("show")(self.attr("page")(arg("title") = title,
                                                arg("unknown_friction") = unknown_friction),
                              height);
          },
          kw_only(), arg("title") = "", arg("unknown_friction") = 0.0, arg("height") = 600,
          R"(Shows page() in a notebook, `height` px high.

Raises Error outside of one.)")
      .def("__repr__",
           [](const Model& model) {
             return "<palpate.Model: " + std::to_string(model.contacts.size()) +
                    " contacts, surface of " + std::to_string(model.surface.triangles.cols()) +
                    " triangles>";
           })
      .def("_repr_html_", drawn_by("model_html"));
  module.def(
      "read_model",
      [](const fs::path& folder) {
        const Unlocked unlocked;
        return haptics::read_model(folder);
      },
      arg("folder"),
      R"(Reads a model folder, as fit() and `palpate fit` write it.

Raises FileError if it is no model, damaged, or of a newer version.)");
}

std::vector<std::pair<long long, std::string>> left_out(const BuildResult& built) {
  std::vector<std::pair<long long, std::string>> misfits;
  for (const auto& misfit : built.left_out) misfits.emplace_back(misfit.id, misfit.reason);
  return misfits;
}

/// A surface of the contacts.
geometry::TriangleMesh contact_surface(const CheckedAcquisition& acquisition,
                                       const py::kwargs& keywords) {
  probing::ContactSurfaceOptions options;
  options.tip_radius = acquisition.records().probe_radius.value_or(options.tip_radius);
  set_fields(fields_of(options), keywords);
  const Unlocked unlocked;
  return probing::contact_surface(acquisition.contacts(), options).mesh;
}

BuildResult fit(const CheckedAcquisition& acquisition, const geometry::TriangleMesh& surface,
                const haptics::BuildOptions& options) {
  BuildResult built = haptics::build_model(acquisition, surface, options);
  built.model.made["program"] = "palpate " PALPATE_VERSION " (Python)";
  return built;
}

void add_fit(py::module_& module) {
  py::class_<BuildResult>(module, "Fit", "The result of fit().")
      .def_property_readonly(
          "model", [](const BuildResult& built) { return built.model; }, "The model (a copy).")
      .def_property_readonly("left_out", &left_out,
                             "Contacts that do not fit the surface: (id, why).")
      .def_readonly("without_samples", &BuildResult::without_samples,
                    "Ids of contacts left out because they have no samples.")
      .def_readonly("isolated", &BuildResult::isolated,
                    "Ids of contacts in no triangle of contacts.")
      .def_property_readonly(
          "registration",
          [](const BuildResult& built) { return haptics::to_string(built.registration); },
          "Whether the contacts were moved onto the surface: 'not_needed', 'accepted', 'too_far' "
          "or 'not_converged'.")
      .def_readonly("distance_rms", &BuildResult::distance_rms,
                    "[mm] of the contacts to the surface as given.")
      .def_readonly("surface_flipped", &BuildResult::surface_flipped,
                    "Whether the triangles were reversed to agree with the contacts' normals.")
      .def_property_readonly(
          "explained",
          [](const BuildResult& built) { return haptics::explained_share(built.contacts); },
          "Share of the squared forces of all contacts that their fits explain, in [0, 1].")
      .def("__repr__", [](const BuildResult& built) {
        return "<palpate.Fit: " + std::to_string(built.model.contacts.size()) + " contacts, " +
               std::to_string(built.left_out.size()) + " left out>";
      });
  def_with_options<haptics::BuildOptions>(
      module,
      "fit(acquisition: Acquisition, surface: TriangleMesh | None = None, *, progress: "
      "Callable | None = None",
      "Fit",
      R"(Fits a model to measurements and the undeformed surface, as `palpate fit` does.

surface: None: one is made of the contacts, flat between them.
progress: called as progress(done, total) after each contact, from any thread, one at a time.

All processors are used, and other threads of Python run meanwhile. Ctrl-C ends the fit after the
next contact. Raises InvalidInput, also if `acquisition` cannot be measurements of an
object, or SolverError; warns (UserWarning) of what is suspicious.)",
      [](const CheckedAcquisition& acquisition, const geometry::TriangleMesh* surface,
         const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<haptics::BuildOptions>(keywords);
        LongWork work(progress);
        options.progress = [&work, report = work.report()](haptics::BuildStage stage, int done,
                                                           int total) {
          work.go_on();
          // Others take no time.
          if (stage == haptics::BuildStage::fields) report(done, total);
        };
        check_plausible("fit()", acquisition);
        const geometry::TriangleMesh made =
            surface == nullptr ? contact_surface(acquisition, {}) : *surface;
        return work.run([&] { return fit(acquisition, made, options); });
      },
      arg("acquisition"), arg("surface") = py::none(), kw_only(), arg("progress") = py::none());
  def_with_options<probing::ContactSurfaceOptions>(
      module, "contact_surface(acquisition: Acquisition, *", "TriangleMesh",
      R"(A surface of the contacts, flat between them, for an object without a scan.

fit() without a surface takes this one. Without tip_radius: that of the ball that touched
the object, if the acquisition states it. Raises InvalidInput. Ctrl-C is not heard.)",
      &contact_surface, arg("acquisition"));
}

}  // namespace

void add_fitting(py::module_& module) {
  add_model(module);
  add_fit(module);
}

}  // namespace palpate::python
