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

/// The options that the keyword arguments of a call give; others have their defaults.
template <typename Options>
[[nodiscard]] Options options_from(const py::kwargs& given) {
  Options options;
  set_fields(fields_of(options), given);
  return options;
}

/// The fields of several structs that one call takes.
template <typename... Structs>
[[nodiscard]] FieldList fields_of_all(Structs&... structs) {
  return [&](FieldVisitor& visitor) { (visit(structs, visitor), ...); };
}

/// Adds a function that takes fields as keyword arguments.
/// \param call, result, text as in `described`; `call` begins with the name of the function.
/// \param usual the fields with their defaults.
template <typename Function, typename... Arguments>
void def_with_fields(py::module_& module, const FieldList& usual, const std::string& call,
                     const std::string& result, const std::string& text, Function&& function,
                     const Arguments&... arguments) {
  const std::string doc = described(call, result, text, usual);
  py::options own;
  own.disable_function_signatures();
  module.def(call.substr(0, call.find('(')).c_str(), std::forward<Function>(function), arguments...,
             doc.c_str());
}

/// The same for the fields of a struct of options.
template <typename Options, typename... Rest>
void def_with_options(py::module_& module, Rest&&... rest) {
  Options usual;
  def_with_fields(module, fields_of(usual), std::forward<Rest>(rest)...);
}

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
