// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/command_line.h"

namespace palpate::apps {

void add_capture(CLI::App& app, const Settings& settings);

// Each function adds one kind of recording to `palpate capture`.
void add_capture_calibration(CLI::App& capture, const Settings& settings);
void add_capture_list(CLI::App& capture, const Settings& settings);
void add_capture_sequence(CLI::App& capture, const Settings& settings);
void add_capture_stills(CLI::App& capture, const Settings& settings);

}  // namespace palpate::apps
