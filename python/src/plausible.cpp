// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "plausible.h"

#include <pybind11/pybind11.h>

#include "palpate/error.h"
#include "palpate/probing/plausibility.h"

namespace palpate::python {

void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition) {
  std::string impossible;
  for (const probing::Finding& finding : probing::find_implausible(acquisition)) {
    const std::string words = probing::message(finding);
    if (finding.impossible)
      impossible += (impossible.empty() ? "" : ". Also, ") + words;
    else if (PyErr_WarnEx(PyExc_UserWarning, (source + ": suspicious: " + words).c_str(), 1) != 0)
      throw pybind11::error_already_set();  // the user made warnings errors
  }
  if (!impossible.empty())
    throw InvalidInput(source + ": these cannot be measurements of an object: " + impossible);
}

}  // namespace palpate::python
