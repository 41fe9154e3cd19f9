// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/core/error.h"
#include "palpate/haptics/build_model.h"

namespace palpate::haptics {

/// The options of the fits, with as many bases as the budget allows.
[[nodiscard]] FitOptions fit_options(const BuildOptions& options);

/// "build_model(): PROBLEM": what is wrong with the measurements. Front ends name their file.
[[nodiscard]] InvalidInput wrong_measurements(const std::string& problem);

}  // namespace palpate::haptics
