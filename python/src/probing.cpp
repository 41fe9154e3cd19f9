// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/acquisition_import.h"
#include "palpate/probing/acquisition_mapping.h"
#include "palpate/probing/acquisition_store.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using probing::CheckedAcquisition;
using probing::Contact;
using probing::Sample;

template <typename Member>
auto rows_of_contacts(Member member) {
  return [member](const CheckedAcquisition& acquisition) {
    return gather_rows(acquisition.contacts(),
                       [&](const Contact& contact) { return contact.*member; });
  };
}
template <typename Member>
auto rows_of_samples(Member member) {
  return [member](const CheckedAcquisition& acquisition) {
    return gather_rows(acquisition.samples(), [&](const Sample& sample) { return sample.*member; });
  };
}
template <typename Scalar, typename Member>
auto numbers_of_samples(Member member) {
  return [member](const CheckedAcquisition& acquisition) {
    return gather<Scalar>(acquisition.samples(),
                          [&](const Sample& sample) { return sample.*member; });
  };
}

void add_acquisition(py::module_& module) {
  py::class_<CheckedAcquisition>(module, "Acquisition",
                                 R"(What an arm measured of one object: C contacts and S samples.

Arrays are copies; samples stand contact by contact. docs/measurements.md describes them.)")
      .def_property_readonly(
          "contact_ids",
          [](const CheckedAcquisition& acquisition) {
            return gather<long long>(acquisition.contacts(),
                                     [](const Contact& contact) { return contact.id; });
          },
          "(C,) int64")
      .def_property_readonly("contacts", rows_of_contacts(&Contact::position),
                             "[mm] (C, 3) places on the undeformed surface.")
      .def_property_readonly("normals", rows_of_contacts(&Contact::normal),
                             "(C, 3) outward unit normals.")
      .def_property_readonly("contact", numbers_of_samples<long long>(&Sample::contact),
                             "(S,) int64 id of each sample's contact.")
      .def_property_readonly("force", rows_of_samples(&Sample::force),
                             "[N] (S, 3) whole force of the tool on the object.")
      .def_property_readonly("a", rows_of_samples(&Sample::a),
                             "[mm] (S, 3) tool position under the normal force alone.")
      .def_property_readonly("b", rows_of_samples(&Sample::b),
                             "[mm] (S, 3) tool position under the whole force.")
      .def_property_readonly("slipped", numbers_of_samples<bool>(&Sample::slipped),
                             "(S,) bool; `b` of these is not used.")
      .def_property_readonly("time", numbers_of_samples<double>(&Sample::time),
                             "[s] (S,) since the acquisition began.")
      .def_property_readonly(
          "probe_radius",
          [](const CheckedAcquisition& acquisition) { return acquisition.records().probe_radius; },
          "[mm] of the ball that touched the object; None: not known.")
      .def_property_readonly(
          "meta", [](const CheckedAcquisition& acquisition) { return acquisition.records().meta; },
          "What else is said of it (a copy).")
      .def("__repr__", [](const CheckedAcquisition& acquisition) {
        return "<palpate.Acquisition: " + std::to_string(acquisition.contacts().size()) +
               " contacts, " + std::to_string(acquisition.samples().size()) + " samples>";
      });
  module.def(
      "read_acquisition",
      [](const fs::path& path) {
        const Unlocked unlocked;
        return probing::read_acquisition(path);
      },
      arg("path"), "Reads a database of measurements (acquisition.db). Raises FileError.");
  module.def(
      "write_acquisition",
      [](const fs::path& path, const CheckedAcquisition& acquisition) {
        const Unlocked unlocked;
        probing::write_acquisition(path, acquisition);
      },
      arg("path"), arg("acquisition"),
      "Writes a database of measurements, as a whole or not at all. Raises OutputError.");
  module.def(
      "import_acquisition",
      [](const std::vector<fs::path>& files, const std::optional<fs::path>& mapping) {
        const Unlocked unlocked;
        return probing::import_acquisition(
                   files, mapping ? probing::read_mapping(*mapping) : probing::AcquisitionMapping{})
            .acquisition;
      },
      arg("files"), arg("mapping") = py::none(),
      R"(Reads contacts and samples from CSV or MAT files, as `palpate probe import` does.

files: usually two tables, of contacts and of samples (docs/measurements.md).
mapping: file (YAML) that says how files of another laboratory are to be read.
Raises FileError or InvalidInput. Ctrl-C is not heard.)");
}

}  // namespace

void add_probing(py::module_& module) { add_acquisition(module); }

}  // namespace palpate::python
