// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "output_path.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/acquisition_import.h"
#include "palpate/probing/acquisition_mapping.h"
#include "palpate/probing/acquisition_store.h"
#include "plausible.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using probing::AcquisitionMapping;
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

void check_rows(const char* name, py::ssize_t rows, py::ssize_t right, const char* of) {
  if (rows == right) return;
  throw InvalidInput(std::string(name) + ": has " + std::to_string(rows) + " rows; it must have " +
                     std::to_string(right) + ", one for each of the " + of);
}

/// Whole numbers, one for each of `count` elements; without any, 0, 1, 2 ...
std::vector<long long> numbers_or_range(const py::object& given, const char* name,
                                        py::ssize_t count, const char* of) {
  std::vector<long long> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  if (given.is_none()) return numbers;
  const py::array_t<int> read = indices(given, name, 1);
  check_rows(name, read.size(), count, of);
  std::copy(read.data(), read.data() + count, numbers.begin());
  return numbers;
}

/// Real numbers, one for each of `count` samples; without any, zeros.
std::vector<double> reals_or_zeros(const py::object& given, const char* name, py::ssize_t count) {
  std::vector<double> numbers(static_cast<std::size_t>(count));
  if (given.is_none()) return numbers;
  const py::array_t<double> read = real_numbers(given, name);
  if (read.ndim() != 1) throw InvalidInput(std::string(name) + ": must have the shape (S,)");
  check_rows(name, read.size(), count, "samples");
  std::copy(read.data(), read.data() + count, numbers.begin());
  return numbers;
}

CheckedAcquisition new_acquisition(const py::object& contacts, const py::object& normals,
                                   const py::object& contact, const py::object& force,
                                   const py::object& a, const py::object& b, const py::object& ids,
                                   const py::object& group, const py::object& slipped,
                                   const py::object& time,
                                   const std::optional<double>& probe_radius) {
  const Points places(contacts, "contacts"), outward(normals, "normals");
  const Points forces(force, "force"), under_normal(a, "a"), under_whole(b, "b");
  const Eigen::Index contact_count = places.columns().cols(), count = forces.columns().cols();
  check_rows("normals", outward.columns().cols(), contact_count, "contacts");
  check_rows("a", under_normal.columns().cols(), count, "samples");
  check_rows("b", under_whole.columns().cols(), count, "samples");
  const auto contact_ids = numbers_or_range(ids, "contact_ids", contact_count, "contacts");
  const auto touched = numbers_or_range(contact, "contact", count, "samples");
  const auto groups = numbers_or_range(group, "group", count, "samples");
  const auto slips = reals_or_zeros(slipped, "slipped", count);
  const auto times = reals_or_zeros(time, "time", count);
  probing::Acquisition made;
  made.probe_radius = probe_radius;
  for (Eigen::Index i = 0; i < contact_count; ++i) {
    made.contacts.push_back({contact_ids[static_cast<std::size_t>(i)], places.columns().col(i),
                             outward.columns().col(i)});
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    made.samples.push_back({.id = i,
                            .contact = touched[k],
                            .group = groups[k],
                            .force = forces.columns().col(i),
                            .a = under_normal.columns().col(i),
                            .b = under_whole.columns().col(i),
                            .slipped = slips[k] != 0,
                            .time = times[k]});
  }
  return made;
}

CheckedAcquisition imported(const std::vector<fs::path>& files, const std::optional<fs::path>& file,
                            const py::kwargs& keywords) {
  AcquisitionMapping mapping = file ? probing::read_mapping(*file) : AcquisitionMapping{};
  set_fields(fields_of(mapping), keywords);
  const Unlocked unlocked;
  return probing::import_acquisition(files, mapping).acquisition;
}

void add_acquisition(py::module_& module) {
  py::class_<CheckedAcquisition>(module, "Acquisition",
                                 R"(What an arm measured of one object: C contacts and S samples.

Arrays are copies; samples stand contact by contact. docs/measurements.md describes them.)")
      .def(
          py::init(&new_acquisition), arg("contacts"), arg("normals"), arg("contact"), arg("force"),
          arg("a"), arg("b"), kw_only(), arg("contact_ids") = py::none(), arg("group") = py::none(),
          arg("slipped") = py::none(), arg("time") = py::none(), arg("probe_radius") = py::none(),
          R"(Of arrays (copied); what they mean, and their shapes, are those of the properties below.

contact: (S,) the id of each sample's contact. For a press without a drag, `b` is `a`.
contact_ids: None: 0, 1, ...
group: (S,) samples of one contact and one group share their normal force; None: each its own.
slipped, time: None: none slipped; no times.
Raises InvalidInput naming the contact or the sample that is wrong.)")
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
        probing::write_acquisition(output_path(path), acquisition);
      },
      arg("path"), arg("acquisition"),
      "Writes a database of measurements, as a whole or not at all. Raises OutputError.");
  def_with_options<AcquisitionMapping>(
      module,
      "import_acquisition(files: Sequence[str | PathLike], mapping: str | PathLike | None = None, "
      "*",
      "Acquisition",
      R"(Reads contacts and samples from CSV or MAT files, as `palpate probe import` does.

files: usually two tables, of contacts and of samples (docs/measurements.md).
mapping: file (YAML) that says how files of another laboratory are to be read; other arguments change
single fields of it.
Raises FileError, or InvalidInput if these cannot be measurements of an object; warns (UserWarning)
of what is suspicious. Ctrl-C is not heard.)",
      [](const std::vector<fs::path>& files, const std::optional<fs::path>& mapping,
         const py::kwargs& keywords) {
        const CheckedAcquisition acquisition = imported(files, mapping, keywords);
        check_plausible("import_acquisition()", acquisition);
        return acquisition;
      },
      arg("files"), arg("mapping") = py::none());
}

}  // namespace

void add_probing(py::module_& module) { add_acquisition(module); }

}  // namespace palpate::python
