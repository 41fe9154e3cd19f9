// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "strip_chart.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "panel.h"
#include "theme.h"

namespace palpate::view {
namespace {

constexpr float kBand = 6;  // [px] height of the band of states
constexpr unsigned kLineColors[] = {kForce, kNormal, kTangential};

}  // namespace

StripChart::StripChart(double least) : least_(least) {}

void StripChart::add(const ForceReading& reading, haptics::ContactState state) {
  entries_[next_] = {{static_cast<float>(reading.total), static_cast<float>(reading.normal),
                      static_cast<float>(reading.tangential)},
                     state};
  next_ = (next_ + 1) % kCount;
  quiet_ = state == haptics::ContactState::free ? quiet_ + 1 : 0;
}

double StripChart::top() const {
  double largest = least_;
  for (const Entry& entry : entries_) {
    largest = std::max(largest, static_cast<double>(entry.forces[0]));
  }
  return round_up(largest);
}

std::vector<StripChart::Column> StripChart::columns(Line line, int count) const {
  std::vector<Column> columns(static_cast<std::size_t>(std::max(1, count)));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t begin = c * kCount / columns.size();
    const std::size_t end = std::max(begin + 1, (c + 1) * kCount / columns.size());
    const auto force = [&](std::size_t i) {
      return entries_[(next_ + i) % kCount].forces[static_cast<std::size_t>(line)];
    };
    columns[c] = {force(begin), force(begin)};
    for (std::size_t i = begin + 1; i < end; ++i) {
      columns[c].low = std::min(columns[c].low, force(i));
      columns[c].high = std::max(columns[c].high, force(i));
    }
  }
  return columns;
}

void StripChart::draw(float height) const {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float floor = at.y + height - kBand - 2, room = floor - at.y - 4;
  const auto top_force = static_cast<float>(top());
  for (int second = 1; second < kSeconds; ++second) {
    const float x = at.x + width * static_cast<float>(second) / kSeconds;
    draw.AddLine({x, at.y}, {x, floor}, ink(kLine));
  }
  for (const float part : {0.0F, 0.5F, 1.0F}) {
    draw.AddLine({at.x, floor - part * room}, {at.x + width, floor - part * room}, ink(kLine));
  }
  const int count = std::max(2, static_cast<int>(width));
  for (const Line line : {Line::tangential, Line::normal, Line::total}) {
    const ImU32 rgb = ink(kLineColors[static_cast<std::size_t>(line)]);
    const float thick = line == Line::total ? 2.0F : 1.4F;
    const auto height_of = [&](float force) {
      return std::clamp(floor - force / top_force * room, at.y, floor);
    };
    ImVec2 end{at.x, floor};
    float x = at.x;
    for (const Column& column : columns(line, count)) {
      const ImVec2 low{x, height_of(column.low)}, high{x, height_of(column.high)};
      const bool rises = std::abs(end.y - low.y) < std::abs(end.y - high.y);
      if (x > at.x) draw.AddLine(end, rises ? low : high, rgb, thick);
      if (low.y - high.y > 1) draw.AddLine(low, high, rgb, thick);
      end = rises ? high : low;
      x += width / static_cast<float>(count);
    }
  }
  for (int column = 0; column < count; ++column) {
    const std::size_t i =
        (static_cast<std::size_t>(column) * kCount + kCount / 2) / static_cast<std::size_t>(count);
    const haptics::ContactState state = entries_[(next_ + i) % kCount].state;
    if (state == haptics::ContactState::free) continue;
    const float x = at.x + width * static_cast<float>(column) / static_cast<float>(count);
    draw.AddRectFilled({x, floor + 2}, {x + width / static_cast<float>(count), floor + 2 + kBand},
                       ink(state == haptics::ContactState::stick ? kStick : kSlip));
  }
  draw.AddText({at.x + 4, at.y + 5}, ink(kQuiet), fmt::format("{:g} N", top_force).c_str());
  const std::string span = fmt::format("last {} s", kSeconds);
  draw.AddText({at.x + width - ImGui::CalcTextSize(span.c_str()).x - 4, at.y + 5}, ink(kQuiet),
               span.c_str());
  ImGui::Dummy({width, height});
}

}  // namespace palpate::view
