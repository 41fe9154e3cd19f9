// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/pybind11.h>

#include <cstdint>

#include "arrays.h"

PYBIND11_MODULE(array_address, module) {
  module.def(
      "seen_at",
      [](const pybind11::object& points) {
        return reinterpret_cast<std::uintptr_t>(
            palpate::python::Points(points, "points").columns().data());
      },
      "Address at which a function that takes points reads them.");
}
