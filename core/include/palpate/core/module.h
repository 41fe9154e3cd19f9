// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate {

/// Returns the address of the symbol `palpate_<name>` in the module `name` of palpate. Modules hold
/// code that needs many shared libraries and that most runs do not use. They lie beside this
/// library, and stay loaded after their first use. Any thread may call this.
/// \throws Unavailable if the module is missing, or a library that it needs.
[[nodiscard]] const void* module_symbol(const std::string& name);

}  // namespace palpate
