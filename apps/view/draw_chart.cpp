// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "draw_chart.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "panel.h"
#include "theme.h"
#include "tool_solids.h"

namespace palpate::view {
namespace {

constexpr float kBand = 6;  // [px] height of the band of states
constexpr unsigned kLineColors[] = {kForce, kNormal, kTangential};

}  // namespace

void draw_chart(const StripChart& chart, float height) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float floor = at.y + height - kBand - 2, room = floor - at.y - 4;
  const auto top_force = static_cast<float>(chart.top());
  for (int second = 1; second < StripChart::kSeconds; ++second) {
    const float x = at.x + width * static_cast<float>(second) / StripChart::kSeconds;
    draw.AddLine({x, at.y}, {x, floor}, ink(kLine));
  }
  for (const float part : {0.0F, 0.5F, 1.0F}) {
    draw.AddLine({at.x, floor - part * room}, {at.x + width, floor - part * room}, ink(kLine));
  }
  const int count = std::max(2, static_cast<int>(width));
  using Line = StripChart::Line;
  for (const Line line : {Line::tangential, Line::normal, Line::total}) {
    const ImU32 rgb = ink(kLineColors[static_cast<std::size_t>(line)]);
    const float thick = line == Line::total ? 2.0F : 1.4F;
    const auto height_of = [&](float force) {
      return std::clamp(floor - force / top_force * room, at.y, floor);
    };
    ImVec2 end{at.x, floor};
    float x = at.x;
    for (const StripChart::Column& column : chart.columns(line, count)) {
      const ImVec2 low{x, height_of(column.low)}, high{x, height_of(column.high)};
      const bool rises = std::abs(end.y - low.y) < std::abs(end.y - high.y);
      if (x > at.x) draw.AddLine(end, rises ? low : high, rgb, thick);
      if (low.y - high.y > 1) draw.AddLine(low, high, rgb, thick);
      end = rises ? high : low;
      x += width / static_cast<float>(count);
    }
  }
  const std::vector<haptics::ContactState> states = chart.states(count);
  for (std::size_t c = 0; c < states.size(); ++c) {
    if (states[c] == haptics::ContactState::free) continue;
    const float wide = width / static_cast<float>(count);
    const float x = at.x + wide * static_cast<float>(c);
    draw.AddRectFilled({x, floor + 2}, {x + wide, floor + 2 + kBand}, ink(color_of(states[c])));
  }
  draw.AddText({at.x + 4, at.y + 5}, ink(kQuiet), fmt::format("{:g} N", top_force).c_str());
  const std::string span = fmt::format("last {} s", StripChart::kSeconds);
  draw.AddText({at.x + width - ImGui::CalcTextSize(span.c_str()).x - 4, at.y + 5}, ink(kQuiet),
               span.c_str());
  ImGui::Dummy({width, height});
}

}  // namespace palpate::view
