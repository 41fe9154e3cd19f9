// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finishing.h"

#include <pybind11/numpy.h>

#include <cstdlib>
#include <cstring>
#include <regex>
#include <string>

namespace palpate::python {
namespace {

namespace py = pybind11;

/// Longest text of a value that is shown.
constexpr std::size_t kLongest = 60;
/// Largest array whose numbers are shown.
constexpr py::ssize_t kFewNumbers = 4;

std::string name_of(py::handle type) { return py::str(type.attr("__name__")); }

bool is_class(py::handle value) { return PyType_Check(value.ptr()) != 0; }

bool is_error(py::handle type) { return PyExceptionClass_Check(type.ptr()) != 0; }

/// What a class defines itself, in the order of its definition.
py::list members(py::handle type) {
  return py::list(py::module_::import("builtins").attr("vars")(type).attr("items")());
}

/// The properties of a class, after those of its bases.
py::list properties(py::handle type) {
  const py::module_ builtins = py::module_::import("builtins");
  py::list names;
  for (const py::handle base : builtins.attr("reversed")(type.attr("__mro__"))) {
    for (const py::handle member : members(base)) {
      const py::tuple pair = py::reinterpret_borrow<py::tuple>(member);
      if (py::isinstance(pair[1], builtins.attr("property"))) names.append(pair[0]);
    }
  }
  return names;
}

std::string shown_number(py::handle number) {
  return py::str(py::module_::import("builtins").attr("format")(number, ".6g"));
}

std::string shown_array(const py::array& array) {
  if (array.ndim() == 1 && array.size() <= kFewNumbers && array.dtype().kind() == 'f') {
    std::string numbers;
    for (const py::handle number : array)
      numbers += (numbers.empty() ? "" : ", ") + shown_number(number);
    return "[" + numbers + "]";
  }
  return std::string(py::str(array.attr("shape"))) + " " +
         std::string(py::str(array.attr("dtype")));
}

/// A value in a few words.
std::string shown(py::handle value) {
  if (py::isinstance<py::array>(value))
    return shown_array(py::reinterpret_borrow<py::array>(value));
  if (py::isinstance<py::float_>(value)) return shown_number(value);
  const std::string type = name_of(py::type::of(value));
  const bool is_text = py::isinstance<py::str>(value);
  if (!is_text && (py::isinstance<py::sequence>(value) || py::isinstance<py::dict>(value)))
    return type + " of " + std::to_string(py::len(value));
  const std::string text = py::repr(value);
  if (is_text && text.size() > kLongest) return text.substr(0, kLongest) + "..." + text.front();
  return text.starts_with('<') ? type : text;
}

py::str repr_of(const py::object& self) {
  const py::type type = py::type::of(self);
  std::string text;
  for (const py::handle property : properties(type)) {
    const std::string name = py::str(property);
    try {
      const std::string value = shown(self.attr(name.c_str()));
      text += (text.empty() ? ": " : ", ") + name + "=" + value;
    } catch (const py::error_already_set&) {
      continue;  // it has no such value now
    }
  }
  return "<palpate." + name_of(type) + text + ">";
}

/// The definition of a function or method of pybind11; null for anything else.
PyMethodDef* definition(py::handle value) {
  PyObject* function = value.ptr();
  if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_GET_FUNCTION(function);
  if (!PyCFunction_Check(function)) return nullptr;
  return reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
}

/// "Returns a Decimation with mesh, source, distance, tries."; empty if `doc` says what is
/// returned, or if the result is not a class of the module.
std::string returned(const std::string& doc, const py::module_& module) {
  static const std::regex kResult(R"(-> (Optional\[)?(?:palpate\.)?(\w+))");
  const std::string signature = doc.substr(0, doc.find('\n'));
  std::smatch found;
  if (!std::regex_search(signature, found, kResult) || doc.find("Return") != std::string::npos)
    return "";
  const std::string name = found[2];
  if (!py::hasattr(module, name.c_str())) return "";
  const py::object type = module.attr(name.c_str());
  if (!is_class(type)) return "";
  std::string names;
  for (const py::handle property : properties(type))
    names += (names.empty() ? " with " : ", ") + std::string(py::str(property));
  const char* article = std::string("AEIO").find(name.front()) == std::string::npos ? "a " : "an ";
  return (found[1].matched ? "Returns None or " : "Returns ") + (article + name) + names + ".";
}

/// Adds what is returned to the docstring of a function; leaves all other values as they are.
void say_what_is_returned(py::handle value, const py::module_& module) {
  PyMethodDef* const function = definition(value);
  if (function == nullptr || function->ml_flags != (METH_VARARGS | METH_KEYWORDS)) return;
  const std::string doc = function->ml_doc == nullptr ? "" : function->ml_doc;
  const std::string sentence = returned(doc, module);
  if (sentence.empty()) return;
  const std::string whole =
      doc.substr(0, doc.find_last_not_of('\n') + 1) + "\n\n" + sentence + "\n";
  // pybind11 frees it.
  std::free(const_cast<char*>(function->ml_doc));
  function->ml_doc = strdup(whole.c_str());
}

}  // namespace

void finish(py::module_& module) {
  const py::object plain = py::module_::import("builtins").attr("object").attr("__repr__");
  for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(module.attr("__dict__"))) {
    say_what_is_returned(value, module);
    if (!is_class(value) || is_error(value)) continue;
    for (const py::handle member : members(value))
      say_what_is_returned(py::reinterpret_borrow<py::tuple>(member)[1], module);
    if (!plain.is(py::object(value.attr("__repr__")))) continue;  // its own, or that of a base
    py::setattr(value, "__repr__",
                py::cpp_function(&repr_of, py::name("__repr__"), py::is_method(value)));
  }
}

}  // namespace palpate::python
