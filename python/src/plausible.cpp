// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "plausible.h"

#include <pybind11/pybind11.h>

#include "palpate/core/error.h"
#include "palpate/probing/plausibility.h"

namespace palpate::python {

namespace {

void warn(const std::string& message) {
  if (PyErr_WarnEx(PyExc_UserWarning, message.c_str(), 1) != 0)
    throw pybind11::error_already_set();  // the user made warnings errors
}

}  // namespace

void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition) {
  std::string impossible;
  for (const probing::Finding& finding : probing::find_implausible(acquisition)) {
    const std::string words = probing::message(finding);
    if (finding.impossible)
      impossible += (impossible.empty() ? "" : ". Also, ") + words;
    else
      warn(source + ": suspicious: " + words);
  }
  if (!impossible.empty())
    throw InvalidInput(source + ": these cannot be measurements of an object: " + impossible);
}

void tell_doubts(const std::string& source, const std::vector<sensing::Doubt>& doubts) {
  if (const std::string why = sensing::impossible_parts(doubts); !why.empty())
    throw InvalidInput(source + ": " + why);
  for (const sensing::Doubt& doubt : doubts) warn(source + ": " + doubt.message);
}

}  // namespace palpate::python
