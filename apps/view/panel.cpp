// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "panel.h"

#include <filesystem>
#include <system_error>

#include "theme.h"
#include "window.h"

namespace palpate::view {
namespace {

constexpr const char* kFonts = "/usr/share/fonts/truetype/dejavu/";  // package fonts-dejavu-core
constexpr float kFontSize = 14, kBoldSize = 17, kLargeSize = 40;     // [px]

struct PanelFonts {
  ImFont *large = nullptr, *bold = nullptr;
};
PanelFonts fonts;

/// The font of a file; that of ImGui, which is plain, if it is not installed.
ImFont* load_font(const char* name, float size) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  const std::string path = std::string(kFonts) + name;
  std::error_code cannot_look;
  if (!std::filesystem::exists(path, cannot_look)) return atlas.AddFontDefault();
  // Latin, Greek, mathematical signs.
  static constexpr ImWchar kRanges[] = {0x20, 0x17f, 0x370, 0x3ff, 0x2010, 0x2265, 0};
  return atlas.AddFontFromFileTTF(path.c_str(), size, nullptr, kRanges);
}

}  // namespace

void set_panel_style() {
  load_font("DejaVuSans.ttf", kFontSize);
  fonts.bold = load_font("DejaVuSans-Bold.ttf", kBoldSize);
  fonts.large = load_font("DejaVuSans-Bold.ttf", kLargeSize);
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.WindowBorderSize = 0;
  style.FrameRounding = 4;
  style.GrabRounding = 4;
  style.WindowPadding = {18, 16};
  style.ItemSpacing = {8, 6};
  style.Colors[ImGuiCol_Text] = panel_color(kText);
  style.Colors[ImGuiCol_FrameBg] = panel_color(kLine, 0.6F);
  style.Colors[ImGuiCol_CheckMark] = panel_color(kForce);
  style.Colors[ImGuiCol_SliderGrab] = panel_color(kForce, 0.45F);
  style.Colors[ImGuiCol_SliderGrabActive] = panel_color(kForce, 0.7F);
  style.Colors[ImGuiCol_PlotHistogram] = panel_color(kForce);
}

ImFont* large_font() { return fonts.large; }
ImFont* bold_font() { return fonts.bold; }

ImVec4 panel_color(unsigned rgb, float opacity) {
  const Eigen::Vector3f c = color(rgb);
  return {c.x(), c.y(), c.z(), opacity};
}

ImU32 ink(unsigned rgb, float opacity) {
  return ImGui::ColorConvertFloat4ToU32(panel_color(rgb, opacity));
}

void begin_panel(const std::string& title, const std::string& subtitle) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x - Window::kPanelWidth, 0});
  ImGui::SetNextWindowSize({Window::kPanelWidth, size.y});
  ImGui::Begin("panel", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                   // `Window` fills it, much faster.
                   ImGuiWindowFlags_NoBackground);
  ImGui::PushFont(bold_font());
  ImGui::TextWrapped("%s", title.c_str());
  ImGui::PopFont();
  remark(subtitle);
}

void end_panel() { ImGui::End(); }

void heading(const char* text) {
  ImGui::Dummy({0, 4});
  ImGui::PushStyleColor(ImGuiCol_Text, panel_color(kQuiet));
  ImGui::TextUnformatted(text);
  ImGui::PopStyleColor();
  ImGui::Separator();
}

void figure(const char* name, const std::string& value) {
  ImGui::TextUnformatted(name);
  const float width = ImGui::CalcTextSize(value.c_str()).x;
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width);
  ImGui::TextUnformatted(value.c_str());
}

void color_bar(pictures::ColorMap map) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  constexpr int kSteps = 64;
  constexpr float kHeight = 14;
  for (int i = 0; i < kSteps; ++i) {
    const pictures::Rgb rgb = pictures::color_at(map, (i + 0.5) / kSteps);
    draw.AddRectFilled({at.x + width * static_cast<float>(i) / kSteps, at.y},
                       {at.x + width * static_cast<float>(i + 1) / kSteps, at.y + kHeight},
                       IM_COL32(rgb[0], rgb[1], rgb[2], 255));
  }
  ImGui::Dummy({width, kHeight});
}

void remark(std::string_view text) {
  ImGui::PushStyleColor(ImGuiCol_Text, panel_color(kQuiet));
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

void badge(const char* word, unsigned rgb) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size = ImGui::CalcTextSize(word);
  constexpr float kAcross = 11, kAlong = 5, kLeast = 74;
  const float width = std::max(kLeast, size.x + 2 * kAcross);
  const float height = size.y + 2 * kAlong;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, {at.x + width, at.y + height}, ink(rgb), height / 2);
  draw.AddText({at.x + (width - size.x) / 2, at.y + kAlong}, ink(kPanel), word);
  ImGui::Dummy({width, height});
}

}  // namespace palpate::view
