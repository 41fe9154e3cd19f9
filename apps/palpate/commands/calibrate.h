// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/command_line.h"

namespace palpate::apps {

// Each function adds one kind of calibration to `palpate calibrate`.
void add_calibrate_chromatic(CLI::App& calibrate, const Settings& settings);
void add_calibrate_colors(CLI::App& calibrate, const Settings& settings);
void add_calibrate_response(CLI::App& calibrate, const Settings& settings);
void add_calibrate_rig(CLI::App& calibrate, const Settings& settings);

}  // namespace palpate::apps
