// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/module.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

#include "palpate/core/error.h"

namespace palpate {
namespace {

/// The file of this library.
std::filesystem::path this_library() {
  Dl_info place{};
  if (dladdr(reinterpret_cast<const void*>(&module_symbol), &place) == 0)
    throw Error("the folder of the modules of palpate cannot be found out");
  return place.dli_fname;
}

}  // namespace

const void* module_symbol(const std::string& name) {
  const std::filesystem::path library = this_library();
  const std::filesystem::path file =
      library.parent_path() / ("libpalpate_" + name + PALPATE_MODULE_ENDING);
  // Lazy, as for the libraries of a program: only a few of the many functions are called.
  void* const loaded = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* const symbol =
      loaded == nullptr ? nullptr : dlsym(loaded, ("palpate_" + name).c_str());
  if (symbol == nullptr) {
    throw Unavailable(
        file.string() + ": this module of palpate cannot be loaded: " + dlerror() +
        ". It is installed beside " + library.filename().string() +
        ", with the same version; a build without the package that it needs does not have "
        "it");
  }
  return symbol;
}

}  // namespace palpate
