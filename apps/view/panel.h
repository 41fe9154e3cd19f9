// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include <string>
#include <string_view>

#include "color_map.h"

namespace palpate::view {

// Parts of the panels of all views.

/// Loads the fonts of the panel, and sets its colours. After the context of ImGui is made.
void set_panel_style();
/// For the number that is read from afar.
[[nodiscard]] ImFont* large_font();
[[nodiscard]] ImFont* bold_font();

/// A colour of theme.h.
[[nodiscard]] ImVec4 panel_color(unsigned rgb, float opacity = 1);
[[nodiscard]] ImU32 ink(unsigned rgb, float opacity = 1);

/// Begins and ends the panel, which takes the right side of the window.
void begin_panel(const std::string& title, const std::string& subtitle);
void end_panel();

/// A heading within it.
void heading(const char* text);
/// A figure: its name on the left, its value on the right.
void figure(const char* name, const std::string& value);
/// A bar with the colours of a map from its low end to its high end.
void color_bar(pictures::ColorMap map);
/// Text of the second rank.
void remark(std::string_view text);
/// A word on a coloured ground.
void badge(const char* word, unsigned rgb);

}  // namespace palpate::view
