// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "view_call.h"

namespace palpate::view {

/// Shows a view in a window until the user closes it, or writes its pictures.
/// \throws Error if there is no display, OutputError if a picture cannot be written.
void show_view(const ViewCall& call, const std::function<std::unique_ptr<View>()>& make_view);

}  // namespace palpate::view
