// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "palpate/geometry/surface_map.h"
#include "palpate/haptics/error_forecast.h"
#include "palpate/haptics/merge_models.h"
#include "palpate/haptics/reduce_model.h"
#include "palpate/haptics/scale_model.h"
#include "palpate/haptics/transfer_model.h"

// Models made of other models.
namespace palpate::python {
namespace {

using geometry::SurfaceMap;
using haptics::ErrorBudget;
using haptics::ForceScaling;
using haptics::MergedModel;
using haptics::MergeModelsOptions;
using haptics::Model;
using haptics::ReducedModel;

ForceScaling scaling(const std::string& word) {
  return choose<ForceScaling>("forces", word,
                              {{"material", ForceScaling::material},
                               {"forces", ForceScaling::forces},
                               {"feel", ForceScaling::feel}});
}

void add_merging_of_models(py::module_& module) {
  py::class_<MergedModel>(module, "MergedModel", "The result of merge_models().")
      .def_property_readonly(
          "model", [](const MergedModel& merged) { return merged.model; }, "The model (a copy).")
      .def_property_readonly(
          "source",
          [](const MergedModel& merged) {
            std::vector<std::pair<int, long long>> source;
            for (const auto& contact : merged.source) source.emplace_back(contact.side, contact.id);
            return source;
          },
          "For each contact the number of its model, and its id there.")
      .def_readonly("isolated", &MergedModel::isolated,
                    "Ids of contacts in no triangle of contacts.")
      .def_readonly("same_place", &MergedModel::same_place, "[mm] the distance that was used.")
      .def_readonly("components", &MergedModel::components,
                    "Pieces of the merged surface. More than the object has mean that the models "
                    "do not overlap.");
  def_with_options<MergeModelsOptions>(
      module, "merge_models(models: Sequence[Model], *, poses: Sequence[ArrayLike] = ()",
      "MergedModel",
      R"(Merges models of several sides of an object into one, as `palpate merge` does.

poses: a (4, 4) matrix for each model, from its frame to that of the object; without them, all
models are in one frame. Registration.T_target_source is one.
Raises InvalidInput or SolverError. Ctrl-C is not heard.)",
      [](const std::vector<Model>& models, const std::vector<py::object>& poses,
         const py::kwargs& keywords) {
        const auto options = options_from<MergeModelsOptions>(keywords);
        if (!poses.empty() && poses.size() != models.size()) {
          throw InvalidInput("poses: there are " + std::to_string(poses.size()) +
                             "; there must be one for each of the " +
                             std::to_string(models.size()) + " models");
        }
        std::vector<haptics::SideModel> sides;
        for (std::size_t i = 0; i < models.size(); ++i) {
          const std::string place = "poses[" + std::to_string(i) + "]";
          sides.push_back({.model = models[i],
                           .T_object_model = isometry(
                               poses.empty() ? py::object(py::none()) : poses[i], place.c_str())});
        }
        const Unlocked unlocked;
        return haptics::merge_models(sides, options);
      },
      arg("models"), kw_only(), arg("poses") = py::tuple());
}

void add_reduction(py::module_& module) {
  py::class_<ReducedModel>(module, "ReducedModel", "The result of reduce_model().")
      .def_property_readonly(
          "model", [](const ReducedModel& reduced) { return reduced.model; }, "The model (a copy).")
      .def_readonly("out_of_reach", &ReducedModel::out_of_reach,
                    "Ids of contacts without influence where the tool can be.")
      .def_readonly("predicted", &ReducedModel::predicted,
                    "Ids of contacts that the others predict.")
      .def_readonly("simpler_fields", &ReducedModel::simpler_fields,
                    "Number of fields with fewer bases than before.")
      .def_readonly("surface_distance", &ReducedModel::surface_distance,
                    "[mm] bound of the distance between the surfaces.")
      .def_property_readonly(
          "difference", [](const ReducedModel& reduced) { return reduced.difference.rms; },
          "[N] RMS difference of the forces of both models over random presses and drags.")
      .def_readonly("force_rms", &ReducedModel::force_rms, "[N] RMS of the forces there.")
      .def_readonly("allowed", &ReducedModel::allowed, "[N] RMS difference that was allowed.")
      .def_readonly("raised", &ReducedModel::raised,
                    "How many times larger errors had to be than those asked for.")
      .def_readonly("stated_before", &ReducedModel::stated_before,
                    "[N] RMS of the errors that the model states there, or None.")
      .def_readonly("stated_after", &ReducedModel::stated_after,
                    "[N] the same of the reduced model.")
      .def_readonly("size_before", &ReducedModel::size_before, "[bytes] of the model folder.")
      .def_readonly("size_after", &ReducedModel::size_after,
                    "[bytes] of that of the reduced model.");
  def_with_options<haptics::ReduceOptions>(
      module,
      "reduce_model(model: Model, *, reachable: ArrayLike | None = None, progress: Callable | None "
      "= "
      "None",
      "ReducedModel",
      R"(Makes a smaller model that holds only what a scene requires, as `palpate reduce` does.

reachable: a truth value for each vertex of the surface; without it, the tool can be anywhere.
progress: called as progress(done, total) after each model that is tried; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const Model& model, const std::optional<std::vector<bool>>& reachable,
         const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<haptics::ReduceOptions>(keywords);
        if (reachable && reachable->empty())
          throw InvalidInput("reachable: is empty; it must have a value for each vertex");
        if (reachable) options.reachable = *reachable;
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return haptics::reduce_model(model, options); });
      },
      arg("model"), kw_only(), arg("reachable") = py::none(), arg("progress") = py::none());
}

std::vector<Eigen::Vector3d> places_from(const py::object& contacts) {
  const Eigen::Matrix3Xd places = Points(contacts, "contacts").columns();
  std::vector<Eigen::Vector3d> list;
  for (const auto& place : places.colwise()) list.emplace_back(place);
  return list;
}

void add_budget(py::module_& module) {
  py::class_<ErrorBudget>(
      module, "ErrorBudget",
      "The sources of an expected error [N]: the squares of the first six add up to that of "
      "`stated`.")
      .def_readonly("force_noise", &ErrorBudget::force_noise, "[N] Noise of the forces.")
      .def_readonly("position_noise", &ErrorBudget::position_noise,
                    "[N] Noise of the positions of the tool.")
      .def_readonly("fit", &ErrorBudget::fit, "[N] What the fields of contacts do not explain.")
      .def_readonly("across", &ErrorBudget::across,
                    "[N] Directions in which the tool did not press.")
      .def_readonly("spacing", &ErrorBudget::spacing, "[N] Distance between contacts.")
      .def_readonly("contrast", &ErrorBudget::contrast,
                    "[N] Blending of contacts that differ in stiffness.")
      .def_readonly("per_depth_noise", &ErrorBudget::per_depth_noise,
                    "[N/mm] for each mm of noise of the depths; not in `stated`.")
      .def_readonly("per_depth_offset", &ErrorBudget::per_depth_offset,
                    "[N/mm] for each mm of offset of the whole surface; not in `stated`.")
      .def_readonly("per_registration", &ErrorBudget::per_registration,
                    "[N/mm] for each mm of shift along the surface; not in `stated`.")
      .def_property_readonly("stated", &ErrorBudget::stated, "[N] Error that the model states.")
      .def(
          "with_surface",
          [](const ErrorBudget& self, std::optional<double> depth_noise,
             std::optional<double> depth_offset, std::optional<double> registration) {
            return self.with({depth_noise, depth_offset, registration});
          },
          kw_only(), arg("depth_noise") = py::none(), arg("depth_offset") = py::none(),
          arg("registration") = py::none(),
          "[N] Error with those errors [mm] of the surface that are known. Raises InvalidInput.");
}

void add_forecast(py::module_& module) {
  py::class_<haptics::ErrorForecast>(module, "ErrorForecast",
                                     "The error of a model with other contacts.")
      .def(
          py::init([](const Model& model, const std::optional<std::vector<bool>>& reachable,
                      std::optional<double> largest_force, std::optional<double> largest_depth,
                      bool slip) {
            haptics::ReduceOptions needs{
                .largest_force = largest_force, .largest_depth = largest_depth, .slip = slip};
            if (reachable) needs.reachable = *reachable;
            const Unlocked unlocked;
            return haptics::ErrorForecast(model, needs);
          }),
          arg("model"), kw_only(), arg("reachable") = py::none(), arg("largest_force") = py::none(),
          arg("largest_depth") = py::none(), arg("slip") = true,
          R"(Tells how large the error of a model would be with other contacts, as `palpate plan` does.

model: of the object, or of a similar one; it must state its errors.
reachable: a truth value for each vertex of the surface; without it, the tool can be anywhere.
largest_force [N], largest_depth [mm]: how hard the tool presses; without both, as far as most
contacts were measured.
slip: whether it also drags.
Raises InvalidInput.)")
      .def(
          "with_contacts",
          [](const haptics::ErrorForecast& forecast, const py::object& contacts) {
            const std::vector<Eigen::Vector3d> list = places_from(contacts);
            const Unlocked unlocked;
            return forecast.with(list);
          },
          arg("contacts"),
          R"(with_contacts(contacts: ArrayLike) -> float

[N] RMS error with contacts at these places (N, 3) [mm] on the surface.)")
      .def(
          "budget_with",
          [](const haptics::ErrorForecast& forecast, const py::object& contacts) {
            const std::vector<Eigen::Vector3d> list = places_from(contacts);
            const Unlocked unlocked;
            return forecast.budget_with(list);
          },
          arg("contacts"),
          R"(budget_with(contacts: ArrayLike) -> ErrorBudget

The sources of that error.)")
      .def_property_readonly(
          "budget_at_present",
          [](const haptics::ErrorForecast& forecast) { return forecast.budget_at_present(); },
          "The sources of the error with the contacts of the model.")
      .def_property_readonly("at_present", &haptics::ErrorForecast::at_present,
                             "[N] RMS error with the contacts of the model.")
      .def_property_readonly("of_contacts", &haptics::ErrorForecast::of_contacts,
                             "[N] the part of it that more contacts do not reduce.")
      .def_property_readonly("force", &haptics::ErrorForecast::force,
                             "[N] RMS of the forces that the errors belong to.");
}

void add_scaling(py::module_& module) {
  module.def(
      "scale_model",
      [](const Model& model, double factor, const py::object& axis, const std::string& forces) {
        haptics::ScaleModelOptions options{.factor = factor, .forces = scaling(forces)};
        if (!axis.is_none()) options.axis = vector3(axis, "axis");
        const Unlocked unlocked;
        haptics::ScaledModel scaled = haptics::scale_model(model, options);
        return std::pair(std::move(scaled.model), scaled.refit_largest);
      },
      arg("model"), arg("factor"), kw_only(), arg("axis") = py::none(), arg("forces") = "material",
      R"(A model of a larger or smaller object, as `palpate transfer --scale` makes it.

factor: of lengths, about the centre of the surface.
axis: direction along which alone lengths are scaled; None: all directions.
forces: 'material', as for the same material; 'forces', the same forces at scaled displacements;
'feel', the same forces at the same displacements.
Returns the model, and [N] the largest error of fields that had to be fitted again (along an axis).
Raises InvalidInput or SolverError.)");
}

void add_transfer(py::module_& module) {
  py::class_<SurfaceMap>(module, "SurfaceMap", "The result of map_surface().")
      .def_property_readonly(
          "verdict", [](const SurfaceMap& map) { return geometry::to_string(map.verdict); },
          "'sensible', 'distorted' or 'not_sensible'. Read this first.")
      .def_readonly("reason", &SurfaceMap::reason, "The verdict in a sentence, with figures.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            return rows_view(self.cast<SurfaceMap&>().positions, self, View::read_only);
          },
          "[mm] (V, 3) images of the source's vertices on the target.")
      .def_readonly("scale", &SurfaceMap::scale, "Root of the ratio of areas, image over source.")
      .def_readonly("distorted_share", &SurfaceMap::distorted_share,
                    "Share of the source's area that is distorted or folded.")
      .def_readonly("landmark_rms", &SurfaceMap::landmark_rms,
                    "[mm] between images of landmarks and their targets.");
  def_with_options<geometry::SurfaceMapOptions>(
      module,
      "map_surface(source: TriangleMesh, target: TriangleMesh, source_landmarks: ArrayLike, "
      "target_landmarks: ArrayLike, *",
      "SurfaceMap",
      R"(Maps a surface onto another of the same topology, guided by at least three pairs of points.

source_landmarks, target_landmarks: [mm] (L, 3) corresponding points.
Raises InvalidInput or SolverError. Ctrl-C is not heard.)",
      [](const geometry::TriangleMesh& source, const geometry::TriangleMesh& target,
         const py::object& source_landmarks, const py::object& target_landmarks,
         const py::kwargs& keywords) {
        const auto options = options_from<geometry::SurfaceMapOptions>(keywords);
        const geometry::Landmarks landmarks{
            .source = Points(source_landmarks, "source_landmarks").columns(),
            .target = Points(target_landmarks, "target_landmarks").columns()};
        const Unlocked unlocked;
        return geometry::map_surface(source, target, landmarks, options);
      },
      arg("source"), arg("target"), arg("source_landmarks"), arg("target_landmarks"));
  module.def(
      "transfer_model",
      [](const Model& model, const geometry::TriangleMesh& target, const SurfaceMap& map,
         const std::string& forces) {
        const ForceScaling chosen = scaling(forces);
        const Unlocked unlocked;
        return haptics::transfer_model(model, target, map, {.forces = chosen}).model;
      },
      arg("model"), arg("target"), arg("map"), kw_only(), arg("forces") = "feel",
      R"(Gives the feel of a model to another object, as `palpate transfer --onto` does.

map: of model.surface onto target, by map_surface().
forces: see scale_model().
The result is a guess between objects of one kind and similar shape, never a measurement.
Raises InvalidInput or SolverError.)");
}

}  // namespace

void add_derived_models(py::module_& module) {
  add_merging_of_models(module);
  add_reduction(module);
  add_budget(module);
  add_forecast(module);
  add_scaling(module);
  add_transfer(module);
}

}  // namespace palpate::python
