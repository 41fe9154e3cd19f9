// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace palpate::python {

/// What all functions and classes of the finished module have in common:
/// - Docstrings of functions that return a class of the module name its properties.
/// - Classes without a `__repr__` of their own show their properties, arrays by shape and type.
void finish(pybind11::module_& module);

}  // namespace palpate::python
