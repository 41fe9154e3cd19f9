// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::web {

/// Text as HTML shows it, also within quotation marks.
[[nodiscard]] std::string html_escaped(const std::string& text);

}  // namespace palpate::web
