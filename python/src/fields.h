// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "bindings.h"
#include "palpate/core/fields.h"

namespace palpate::python {

/// Sets the fields of a list from keyword arguments.
/// \throws py::type_error for a name that no field has, or a value of the wrong type;
/// InvalidInput for a word that is no choice, or a row of the wrong length. Ranges are checked
/// where the options are used.
void set_fields(const FieldList& fields, const py::kwargs& given);

/// A docstring: the signature, the text, and a line for each field.
/// \param call name and first arguments of the signature, "Decoder(rig: Rig".
/// \param result type of what is returned.
[[nodiscard]] std::string described(const std::string& call, const std::string& result,
                                    const std::string& text, const FieldList& list);

/// All lists of options, for the page that describes them: for each struct its name and its
/// fields.
[[nodiscard]] py::list option_lists();

/// Adds a constructor whose docstring has its own signature.
template <typename Class, typename Init, typename... Arguments>
void def_described(Class& to, const std::string& doc, Init&& init, const Arguments&... arguments) {
  py::options own;
  own.disable_function_signatures();
  to.def(std::forward<Init>(init), arguments..., doc.c_str());
}

}  // namespace palpate::python
