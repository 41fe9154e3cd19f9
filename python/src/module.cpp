// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>

#include <regex>
#include <string>

#include "bindings.h"
#include "fields.h"
#include "finishing.h"
#include "palpate/core/error.h"

namespace palpate::python {
namespace {

PyObject* new_error(py::module_& module, const char* name, const char* doc,
                    const py::tuple& bases) {
  const std::string full = std::string("palpate.") + name;
  PyObject* error = PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr);
  if (error == nullptr) throw py::error_already_set();
  module.add_object(name, error);
  return error;
}

/// Options of the library have the names of arguments here: "BuildOptions::rate" is "rate".
std::string with_names_of_arguments(const char* message) {
  static const std::regex prefix("\\b[A-Za-z]+Options::");
  return std::regex_replace(message, prefix, "");
}

// They live as long as the interpreter.
PyObject *base_error, *invalid_input, *file_error, *output_error, *solver_error, *unavailable;

}  // namespace

void add_errors(py::module_& module) {
  const py::handle value(PyExc_ValueError), os(PyExc_OSError), any(PyExc_Exception);
  base_error = new_error(module, "Error", "Root of all errors of Palpate.", py::make_tuple(any));
  const py::handle base(base_error);
  invalid_input = new_error(module, "InvalidInput", "An argument or a value that can be corrected.",
                            py::make_tuple(base, value));
  file_error = new_error(module, "FileError",
                         "A file that cannot be read: missing, truncated, of another format.",
                         py::make_tuple(base, os));
  output_error = new_error(module, "OutputError",
                           "A result that cannot be written; what was there before is kept.",
                           py::make_tuple(base, os));
  solver_error =
      new_error(module, "SolverError", "A numerical method that found no solution for valid input.",
                py::make_tuple(base));
  unavailable = new_error(module, "Unavailable",
                          "A function that this build does not have, or whose package is missing; "
                          "the message names it; the message names it.",
                          py::make_tuple(base));
  // NOLINTNEXTLINE(performance-unnecessary-value-param): it is the type that pybind11 asks for
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const FileError& error) {
      PyErr_SetString(file_error, error.what());
    } catch (const InvalidInput& error) {
      PyErr_SetString(invalid_input, with_names_of_arguments(error.what()).c_str());
    } catch (const OutputError& error) {
      PyErr_SetString(output_error, error.what());
    } catch (const SolverError& error) {
      PyErr_SetString(solver_error, error.what());
    } catch (const Unavailable& error) {
      PyErr_SetString(unavailable, error.what());
    } catch (const Error& error) {
      PyErr_SetString(base_error, error.what());
    }
  });
}

}  // namespace palpate::python

PYBIND11_MODULE(_palpate, module) {
  namespace python = palpate::python;
  module.attr("__version__") = PALPATE_VERSION;
  module.attr("__module__") = "palpate";  // where users find classes and functions
  python::add_errors(module);
  python::add_meshes(module);
  python::add_range_maps(module);
  python::add_surface_functions(module);
  python::add_geodesics(module);
  python::add_clouds(module);
  python::add_scans(module);
  python::add_tracking(module);
  python::add_sensing(module);
  python::add_cameras(module);
  python::add_calibration(module);
  python::add_rig_trial(module);
  python::add_probing(module);
  python::add_stiffness_map(module);
  python::add_arm_placement(module);
  python::add_fitting(module);
  python::add_evaluation(module);
  python::add_derived_models(module);
  python::add_simulation(module);
  python::add_campaigns(module);
  python::add_playback(module);
  python::add_device(module);
  module.def(
      "_option_lists", &python::option_lists,
      "All options: for each struct its name, and for each field what docs/options.md says.");
  python::finish(module);
  pybind11::delattr(module, "__module__");
}
