// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/identify.h"
#include "palpate/haptics/identify_solid.h"
#include "palpate/probing/material_text.h"
#include "palpate/probing/specimen_file.h"
#include "plausible.h"
#include "specimen_binding.h"

// Agreement of a model, or a parametric model, with measurements.
namespace palpate::python {
namespace {

using haptics::Identification;
using haptics::LeaveOneOut;
using haptics::LeaveOneOutOptions;
using haptics::Model;
using haptics::ParameterEstimate;
using haptics::QueryErrors;
using haptics::QueryOptions;
using probing::CheckedAcquisition;

std::vector<haptics::Query> queries_of(const py::object& contacts, const py::object& displacements,
                                       const py::object& forces) {
  const Points at(contacts, "contacts"), moved(displacements, "displacements"),
      felt(forces, "forces");
  const Eigen::Index count = at.columns().cols();
  if (moved.columns().cols() != count || felt.columns().cols() != count) {
    throw InvalidInput("contacts, displacements and forces: have " + std::to_string(count) + ", " +
                       std::to_string(moved.columns().cols()) + " and " +
                       std::to_string(felt.columns().cols()) +
                       " rows; they must have the same number");
  }
  std::vector<haptics::Query> queries;
  for (Eigen::Index i = 0; i < count; ++i)
    queries.push_back({at.columns().col(i), moved.columns().col(i), felt.columns().col(i)});
  return queries;
}

/// A property with the number of a `StatedErrors`, or None.
template <typename Errors>
auto stated(double haptics::StatedErrors::*member) {
  return [member](const Errors& errors) -> std::optional<double> {
    if (!errors.stated) return std::nullopt;
    return (*errors.stated).*member;
  };
}

constexpr const char* kStatedRatio =
    "Root mean square of the errors, each relative to the one that the model states: 1 if they are "
    "stated rightly; None if it states none.";

void add_query_errors(py::module_& module) {
  py::class_<QueryErrors>(module, "QueryErrors", "The result of evaluate().")
      .def_readonly("count", &QueryErrors::count, "Number of queries.")
      .def_readonly("rms", &QueryErrors::rms, "[N] root mean square length of the error vectors.")
      .def_readonly("median", &QueryErrors::median, "[N] median length.")
      .def_readonly("p90", &QueryErrors::p90, "[N] 90 % are at most this long.")
      .def_property_readonly("stated_ratio", stated<QueryErrors>(&haptics::StatedErrors::ratio),
                             kStatedRatio)
      .def_readonly("explained", &QueryErrors::explained,
                    "Share of the squared forces that the model explains; None if all are zero.")
      .def_readonly(
          "scale", &QueryErrors::scale,
          "Factor of the model's forces with which the errors would be least. Far from 1, "
          "the queries may have other signs or units.");
  def_with_options<QueryOptions>(
      module,
      "evaluate(model: Model, contacts: ArrayLike, displacements: ArrayLike, forces: ArrayLike, *",
      "QueryErrors",
      R"(Compares a model with known forces, as `palpate evaluate --queries` does.

contacts: [mm] (N, 3) places on the undeformed surface.
displacements: [mm] (N, 3) tool minus contact.
forces: [N] (N, 3) of the tool on the object.
Raises InvalidInput.)",
      [](const Model& model, const py::object& contacts, const py::object& displacements,
         const py::object& forces, const py::kwargs& keywords) {
        const auto options = options_from<QueryOptions>(keywords);
        const std::vector<haptics::Query> queries = queries_of(contacts, displacements, forces);
        const Unlocked unlocked;
        return haptics::evaluate_queries(model, queries, options);
      },
      arg("model"), arg("contacts"), arg("displacements"), arg("forces"));
}

void add_leave_one_out(py::module_& module) {
  py::class_<LeaveOneOut>(module, "LeaveOneOut", "The result of leave_one_out().")
      .def_readonly("rms", &LeaveOneOut::rms, "[N] over all samples of all contacts.")
      .def_readonly("interior_rms", &LeaveOneOut::interior_rms,
                    "[N] over contacts with neighbours all around; None if there are none.")
      .def_readonly("border_rms", &LeaveOneOut::border_rms,
                    "[N] over the others, which have neighbours on one side only; None if there "
                    "are none.")
      .def_property_readonly("stated_ratio", stated<LeaveOneOut>(&haptics::StatedErrors::ratio),
                             kStatedRatio)
      .def_property_readonly(
          "ids",
          [](const LeaveOneOut& errors) {
            return gather<long long>(errors.per_contact,
                                     [](const auto& error) { return error.contact; });
          },
          "(C,) int64 ids of the contacts.")
      .def_property_readonly(
          "contact_rms",
          [](const LeaveOneOut& errors) {
            return gather<double>(errors.per_contact, [](const auto& error) { return error.rms; });
          },
          "[N] (C,) root mean square error at each contact.")
      .def_property_readonly(
          "suggested",
          [](const LeaveOneOut& errors) {
            return gather_rows(errors.suggested, [](const auto& place) { return place.position; });
          },
          "[mm] (N, 3) where one more contact would reduce the error most, the best first.");
  def_with_options<LeaveOneOutOptions>(
      module,
      "leave_one_out(model: Model, acquisition: Acquisition, *, progress: Callable | None = None",
      "LeaveOneOut",
      R"(Predicts the samples of each contact from the other contacts, as `palpate evaluate --leave-one-out` does.

acquisition: the measurements that the model was fitted to.
progress: called as progress(done, total) after each contact; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const Model& model, const CheckedAcquisition& acquisition, const py::object& progress,
         const py::kwargs& keywords) {
        auto options = options_from<LeaveOneOutOptions>(keywords);
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return haptics::leave_one_out(model, acquisition, options); });
      },
      arg("model"), arg("acquisition"), kw_only(), arg("progress") = py::none());
}

void add_identification(py::module_& module) {
  py::class_<ParameterEstimate>(module, "ParameterEstimate", "A parameter of an Identification.")
      .def_readonly("name", &ParameterEstimate::name, "In words, such as 'tension'.")
      .def_readonly("unit", &ParameterEstimate::unit, "'N', 'mm', ...; empty for a ratio.")
      .def_property_readonly(
          "status",
          [](const ParameterEstimate& parameter) { return haptics::to_string(parameter.status); },
          "'determined', 'at_bound' or 'undetermined' by the measurements.")
      .def_readonly("value", &ParameterEstimate::value, "None if undetermined.")
      .def_readonly("standard_error", &ParameterEstimate::standard_error, "None unless determined.")
      .def("__repr__", [](const ParameterEstimate& parameter) {
        if (!parameter.value) return "<" + parameter.name + ": not determined>";
        const std::string value = py::repr(py::cast(*parameter.value)).cast<std::string>();
        return "<" + parameter.name + ": " + value + " " + parameter.unit + ">";
      });
  py::class_<Identification>(module, "Identification", "The result of identify().")
      .def_property_readonly(
          "verdict", [](const Identification& found) { return haptics::to_string(found.verdict); },
          "Whether the parametric model describes the object: 'describes', 'does_not_describe', "
          "'not_testable' or 'not_converged'. Read this first.")
      .def_readonly("parameters", &Identification::parameters, "The parameters, with errors.")
      .def_property_readonly(
          "correlations", [](const Identification& found) { return copy_of(found.correlations); },
          "(P, P) of the errors of the parameters, without friction; NaN where one is not "
          "determined.")
      .def_readonly("chi2", &Identification::chi2,
                    "Chi^2 per degree of freedom; None if not testable.")
      .def_readonly("rms", &Identification::rms, "[mm] of the errors of the displacements.")
      .def_readonly("explained", &Identification::explained,
                    "Share of the squared displacements that is explained.")
      .def_readonly("displacement_noise", &Identification::displacement_noise,
                    "[mm] as given or estimated.")
      .def_readonly("force_noise", &Identification::force_noise, "[N] as given or estimated.");
  def_with_options<haptics::IdentifyOptions>(
      module,
      "identify(acquisition: Acquisition, model: Literal['strip', 'half-space'] = 'strip', *, "
      "tool_radius: float | None = None",
      "Identification",
      R"(Estimates elastic parameters of an object, with errors, as `palpate identify` does.

model: 'strip', a sheet stretched between two supports; 'half-space', a large elastic body.
tool_radius: [mm] of the tool's flat end, for the half-space.
Raises InvalidInput or SolverError; warns (UserWarning) of suspicious measurements.)",
      [](const CheckedAcquisition& acquisition, const std::string& model,
         const std::optional<double>& tool_radius, const py::kwargs& keywords) {
        const auto options = options_from<haptics::IdentifyOptions>(keywords);
        enum class Law { strip, half_space };
        const Law law =
            choose<Law>("model", model, {{"strip", Law::strip}, {"half-space", Law::half_space}});
        if ((law == Law::half_space) != tool_radius.has_value())
          throw InvalidInput("tool_radius: is for the half-space, which needs it");
        check_plausible("identify()", acquisition);
        const Unlocked unlocked;
        return law == Law::strip
                   ? haptics::identify_strip(acquisition, options).report
                   : haptics::identify_half_space(acquisition, *tool_radius, options).report;
      },
      arg("acquisition"), arg("model") = "strip", kw_only(), arg("tool_radius") = py::none());
}

struct MaterialFound {
  haptics::IdentifiedSolid found;
  Specimen specimen;
};

void add_solid_identification(py::module_& module) {
  py::class_<MaterialFound>(module, "IdentifiedSolid", "The result of identify_solid().")
      .def_property_readonly(
          "report", [](const MaterialFound& result) { return result.found.report; },
          "The parameters with their errors, and the verdict.")
      .def_property_readonly(
          "specimen", [](const MaterialFound& result) { return result.specimen; },
          "The solid with the material that was found; what the data do not determine is as given.")
      .def_property_readonly(
          "mesh_errors",
          [](const MaterialFound& result) {
            return copy_of(Eigen::Map<const Eigen::VectorXd>(result.found.mesh_errors.data(),
                                                             std::ssize(result.found.mesh_errors)));
          },
          "(P,) by how much the mesh makes each parameter wrong, in its unit, without friction; "
          "corrected. NaN: not known.")
      .def_property_readonly(
          "mesh_limited", [](const MaterialFound& result) { return result.found.mesh_limited; },
          "Parameters that the measurements would determine, but not with the error of this mesh.")
      .def_property_readonly(
          "left_out", [](const MaterialFound& result) { return result.found.left_out; },
          "Ids of contacts that the tip cannot reach on the solid.");
  haptics::SolidOptions usual;
  haptics::IdentifyOptions usual_estimate;
  def_with_fields(
      module, fields_of_all(usual, usual_estimate),
      "identify_solid(acquisition: Acquisition, specimen: Specimen, *, progress: Callable | None = "
      "None",
      "IdentifiedSolid",
      R"(Estimates the material of a solid, as `palpate identify --finite-elements` does.

specimen: of the type finite_elements; its geometry, supports and regions are known.
progress: called as progress(done, total) after each equilibrium; Ctrl-C is heard then.
Raises InvalidInput or SolverError; warns (UserWarning) of suspicious measurements.)",
      [](const CheckedAcquisition& acquisition, const Specimen& specimen,
         const py::object& progress, const py::kwargs& keywords) {
        haptics::SolidOptions solid;
        haptics::IdentifyOptions options;
        set_fields(fields_of_all(solid, options), keywords);
        check_plausible("identify_solid()", acquisition);
        const std::string source = "specimen";
        LongWork work(progress);
        solid.progress = work.report();
        MaterialFound result;
        result.found = work.run([&] {
          return haptics::identify_solid(
              acquisition, probing::parse_finite_elements(specimen.text, source), solid, options);
        });
        result.specimen =
            new_specimen(probing::with_material(specimen.text, source, result.found.object,
                                                result.found.presses),
                         source);
        return result;
      },
      arg("acquisition"), arg("specimen"), kw_only(), arg("progress") = py::none());
}

}  // namespace

void add_evaluation(py::module_& module) {
  add_query_errors(module);
  add_leave_one_out(module);
  add_identification(module);
  add_solid_identification(module);
}

}  // namespace palpate::python
