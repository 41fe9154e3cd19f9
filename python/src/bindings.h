// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <initializer_list>
#include <string>
#include <utility>

#include "palpate/core/error.h"

// Declarations shared by the parts of the module. Each part adds its classes and functions.
namespace palpate::python {

namespace py = pybind11;

void add_errors(py::module_& module);
void add_meshes(py::module_& module);
void add_range_maps(py::module_& module);
void add_surface_functions(py::module_& module);
void add_clouds(py::module_& module);
void add_geodesics(py::module_& module);
void add_scans(py::module_& module);
void add_tracking(py::module_& module);
void add_sensing(py::module_& module);
void add_cameras(py::module_& module);
/// Calibration of a rig.
void add_calibration(py::module_& module);
/// Simulated measurements of a rig.
void add_rig_trial(py::module_& module);
void add_probing(py::module_& module);
void add_stiffness_map(py::module_& module);
void add_arm_placement(py::module_& module);
void add_simulation(py::module_& module);
/// Plans, and arms that probe simulated objects.
void add_campaigns(py::module_& module);
void add_fitting(py::module_& module);
void add_evaluation(py::module_& module);
void add_derived_models(py::module_& module);
void add_playback(py::module_& module);
void add_device(py::module_& module);

/// Options follow `*` and are given by name.
using py::arg;
using py::kw_only;

/// For loops in which the interpreter is not locked.
using Unlocked = py::gil_scoped_release;

/// The value that a word stands for. \throws InvalidInput with the words that are known.
template <typename Value>
[[nodiscard]] Value choose(const char* name, const std::string& word,
                           std::initializer_list<std::pair<const char*, Value>> choices) {
  std::string known;
  for (const auto& [choice, value] : choices) {
    if (word == choice) return value;
    known += (known.empty() ? "'" : ", '") + std::string(choice) + "'";
  }
  throw InvalidInput(std::string(name) + ": is '" + word + "'; it must be one of " + known);
}

/// `_repr_html_` of a class: a function of palpate/_notebook.py.
[[nodiscard]] inline auto drawn_by(const char* function) {
  return [function](const py::object& self) -> py::str {
    return py::module_::import("palpate._notebook").attr(function)(self);
  };
}

}  // namespace palpate::python
