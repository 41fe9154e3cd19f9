// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "range_view.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "camera_control.h"
#include "palpate/core/error.h"
#include "palpate/geometry/range_map_mesh.h"
#include "panel.h"
#include "scene_renderer.h"
#include "surface_renderer.h"
#include "theme.h"
#include "window.h"

namespace palpate::view {
namespace {

constexpr float kImageMargin = 0.96F;  // of the picture is filled by an image at first
constexpr double kImageZoom = 1.15;    // a line of the wheel
constexpr double kMostZoom = 64, kLeastZoom = 0.2;
constexpr double kFirstRate = 10;  // [1/s] maps of a sequence
constexpr float kFastestRate = 60;
constexpr double kCursorRounding = 1e-9;  // maps: of the sum of many times
constexpr std::array<const char*, 4> kLayerWords{"depth", "deviation", "reason", "difference"};

class RangeView final : public View {
 public:
  explicit RangeView(RangeScene scene) : scene_(std::move(scene)), layer_(scene_.layer) {
    as_surface_ = scene_.as_surface;
    show_frame();
  }

  void resize(int width, int height) override {
    size_ = {width, height};
    if (control_) control_->camera.resize(width, height);
  }

  void button(MouseButton button, bool down, const Eigen::Vector2d& at, bool shift) override {
    is_held_ = down;
    pointer_ = at;
    if (!control_ || !as_surface_) return;
    if (down) {
      control_->press(button, at, shift);
    } else {
      control_->release();
    }
  }

  void move(const Eigen::Vector2d& at, bool /*shift*/) override {
    if (as_surface_ && control_) {
      control_->drag(at);
    } else if (is_held_) {
      offset_ += at - pointer_.value_or(at);
    }
    pointer_ = at;
  }

  void wheel(double lines) override {
    if (as_surface_ && control_) return control_->wheel(lines);
    const double zoom = std::clamp(zoom_ * std::pow(kImageZoom, lines), kLeastZoom, kMostZoom);
    // The point under the pointer stays there.
    const Eigen::Vector2d from =
        pointer_.value_or(size_.cast<double>() / 2) - size_.cast<double>() / 2;
    offset_ = from + (offset_ - from) * (zoom / zoom_);
    zoom_ = zoom;
  }

  bool key(int key, bool down) override {
    if (!down) return false;
    switch (key) {
      case GLFW_KEY_SPACE:
        toggle_play();
        return true;
      case GLFW_KEY_LEFT:
        step(-1);
        return true;
      case GLFW_KEY_RIGHT:
        step(1);
        return true;
      case GLFW_KEY_HOME:
        go_to(0);
        return true;
      case GLFW_KEY_END:
        go_to(static_cast<double>(scene_.sequence.size()) - 1);
        return true;
      case GLFW_KEY_1:
      case GLFW_KEY_2:
      case GLFW_KEY_3:
      case GLFW_KEY_4:
        set_layer(static_cast<MapLayer>(key - GLFW_KEY_1));
        return true;
      case GLFW_KEY_I:
        set_surface(!as_surface_);
        return true;
      case GLFW_KEY_R:
        zoom_ = 1;
        offset_.setZero();
        [[fallthrough]];
      default:
        return control_ && control_->key(key);
    }
  }

  void advance(double seconds) override {
    if (control_) control_->advance(seconds);
    if (!is_playing_) return;
    const auto last = static_cast<double>(scene_.sequence.size()) - 1;
    if (cursor_ >= last) {
      is_playing_ = false;
      return;
    }
    go_to(std::min(last, cursor_ + seconds * rate_));
  }

  void draw(bool hurry) override {
    SceneRenderer::begin();
    if (as_surface_ && control_ && has_surface_)
      renderer_.draw(control_->camera.shot(),
                     {.wireframe = false, .lit = layer_ != MapLayer::reason, .coarse = hurry});
    scene_renderer_.draw_backdrop();
  }

  void panel() override;
  [[nodiscard]] bool is_moving() const override {
    return is_playing_ || (control_ && control_->is_turning());
  }
  void turn() override {
    if (control_) control_->turntable = true;
  }
  [[nodiscard]] double duration() const override {
    return static_cast<double>(scene_.sequence.size() - 1) / rate_;
  }

 private:
  void toggle_play() {
    is_playing_ = !is_playing_;
    if (is_playing_ && cursor_ >= static_cast<double>(scene_.sequence.size()) - 1) go_to(0);
  }

  void step(int way) {
    is_playing_ = false;
    go_to(std::clamp(std::round(cursor_) + way, 0.0,
                     static_cast<double>(scene_.sequence.size()) - 1));
  }

  void go_to(double cursor) {
    const std::size_t before = frame_number();
    cursor_ = cursor;
    if (frame_number() != before) show_frame();
  }

  [[nodiscard]] std::size_t frame_number() const {
    return static_cast<std::size_t>(std::floor(cursor_ + kCursorRounding));
  }

  void set_layer(MapLayer layer) {
    if (!scene_.sequence.has(layer) || layer == layer_) return;
    layer_ = layer;
    show_frame();
  }

  void set_surface(bool as_surface) {
    as_surface_ = as_surface;
    show_frame();
  }

  /// Reads the map and puts it into the memory of the graphics system. While a window is open, a
  /// map that cannot be read is told in the panel.
  void show_frame() {
    problem_.clear();
    try {
      std::optional<ColorSpan>& span = spans_[static_cast<std::size_t>(layer_)];
      if (!span) span = scene_.sequence.span(layer_);
      frame_ = scene_.sequence.read(frame_number(), layer_);
      colors_ = color_frame(frame_, layer_, *span);
    } catch (const Error& wrong) {
      if (scene_.still) throw;
      problem_ = wrong.what();
      return;
    }
    texture_.put(colors_.bytes.data(), colors_.width, colors_.height);
    known_ = (frame_.map.z > 0).count();
    if (as_surface_) put_surface();
  }

  void put_surface() {
    const geometry::RangeMapMesh meshed = geometry::mesh_range_map(frame_.map);
    has_surface_ = meshed.mesh.triangles.cols() > 0;
    if (!has_surface_) return;
    if (!control_) {
      Extent extent = extent_of(meshed.mesh);
      control_.emplace(extent);
      control_->camera.resize(size_.x(), size_.y());
    }
    VertexColors colors(4, meshed.mesh.vertices.cols());
    for (Eigen::Index v = 0; v < colors.cols(); ++v) {
      const std::size_t pixel =
          4 * static_cast<std::size_t>(meshed.source[static_cast<std::size_t>(v)]);
      colors.col(v) = Eigen::Vector4<unsigned char>::Map(&colors_.bytes[pixel]);
    }
    renderer_.put(SurfaceShape(meshed.mesh));
    renderer_.put_colors(colors);
  }

  void draw_image();
  void panel_of_pixel();
  void panel_of_colors();
  void panel_of_figures();

  RangeScene scene_;
  MapLayer layer_;
  std::array<std::optional<ColorSpan>, 4> spans_;  // by layer
  RangeFrame frame_;
  ColorImage colors_;
  Texture texture_;
  SurfaceRenderer renderer_;
  SceneRenderer scene_renderer_;
  std::optional<CameraControl> control_;
  Eigen::Vector2i size_ = Eigen::Vector2i::Ones();
  std::optional<Eigen::Vector2d> pointer_;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();  // [px] of the image's centre
  double zoom_ = 1;
  // Of the image in the picture, as it was drawn last.
  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();
  double scale_ = 1;
  bool as_surface_ = false, has_surface_ = false, is_held_ = false, is_playing_ = true;
  double cursor_ = 0;  // [maps]
  double rate_ = kFirstRate;
  Eigen::Index known_ = 0;
  std::string problem_;
};

void RangeView::draw_image() {
  const Eigen::Vector2d room = size_.cast<double>() * static_cast<double>(kImageMargin);
  scale_ = zoom_ * std::min(room.x() / colors_.width, room.y() / colors_.height);
  const Eigen::Vector2d whole = scale_ * Eigen::Vector2d(colors_.width, colors_.height);
  corner_ = size_.cast<double>() / 2 + offset_ - whole / 2;
  const ImVec2 low{static_cast<float>(corner_.x()), static_cast<float>(corner_.y())};
  const ImVec2 high{static_cast<float>(corner_.x() + whole.x()),
                    static_cast<float>(corner_.y() + whole.y())};
  // ImGui names a texture by a pointer.
  auto* texture = reinterpret_cast<void*>(static_cast<std::intptr_t>(texture_.name()));  // NOLINT
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.PushClipRect({0, 0}, {static_cast<float>(size_.x()), static_cast<float>(size_.y())});
  draw.AddImage(texture, low, high);
  draw.AddRect(low, high, ink(kQuiet));
  draw.PopClipRect();
}

void RangeView::panel() {
  if (!as_surface_ && problem_.empty()) draw_image();
  begin_panel(scene_.name,
              fmt::format("range map {} of {}: {}", frame_number() + 1, scene_.sequence.size(),
                          scene_.sequence.name(frame_number())));
  if (!problem_.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, panel_color(kSlip));
    ImGui::TextWrapped("%s", problem_.c_str());
    ImGui::PopStyleColor();
  }
  if (scene_.sequence.size() > 1) {
    heading("Sequence");
    if (ImGui::Button(is_playing_ ? "Pause" : "Play", {64, 0})) toggle_play();
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    auto number = static_cast<int>(frame_number()) + 1;
    if (ImGui::SliderInt("##map", &number, 1, static_cast<int>(scene_.sequence.size()))) {
      is_playing_ = false;
      go_to(number - 1);
    }
    auto rate = static_cast<float>(rate_);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##rate", &rate, 1, kFastestRate, "%.0f maps a second"))
      rate_ = static_cast<double>(rate);
  }
  heading("Show");
  for (int i = 0; i < 4; ++i) {
    const auto layer = static_cast<MapLayer>(i);
    if (!scene_.sequence.has(layer)) continue;
    const std::string label =
        fmt::format("{} ({})", kLayerWords[static_cast<std::size_t>(i)], i + 1);
    if (ImGui::RadioButton(label.c_str(), layer_ == layer)) set_layer(layer);
    // Two beside each other.
    if (i % 2 == 0 && i < 3 && scene_.sequence.has(static_cast<MapLayer>(i + 1)))
      ImGui::SameLine(Window::kPanelWidth / 2.0F);
  }
  bool surface = as_surface_;
  if (ImGui::Checkbox("as a surface (I)", &surface)) set_surface(surface);
  panel_of_colors();
  panel_of_figures();
  if (!as_surface_) panel_of_pixel();
  heading("View");
  remark(as_surface_ ? "The left button turns too. " + std::string(kCameraKeys)
                     : std::string("Drag moves, wheel zooms, R whole image"));
  remark("Space plays, arrows go on by one, Home and End");
  end_panel();
}

void RangeView::panel_of_colors() {
  heading(layer_ == MapLayer::reason ? "Why pixels have no depth" : "Colours");
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (layer_ == MapLayer::reason) {
    if (frame_.reasons.size() == 0) return;
    const std::vector<std::string> words = apps::reason_words();
    for (int code = 0; code < sensing::kReasonCount; ++code) {
      const long count = sensing::count(frame_.reasons, static_cast<sensing::Reason>(code));
      if (count == 0) continue;
      const ImVec2 at = ImGui::GetCursorScreenPos();
      const pictures::Rgb& rgb = pictures::kLabelColors[static_cast<std::size_t>(code)];
      draw.AddRectFilled({at.x, at.y + 1}, {at.x + 14, at.y + 15},
                         IM_COL32(rgb[0], rgb[1], rgb[2], 255), 2);
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 22);
      figure(words[static_cast<std::size_t>(code)].c_str(),
             fmt::format("{:.2f} %", 100.0 * static_cast<double>(count) /
                                         static_cast<double>(frame_.reasons.size())));
    }
    return;
  }
  const std::optional<ColorSpan>& span = spans_[static_cast<std::size_t>(layer_)];
  if (!span) return;
  color_bar(span->map);
  const char* form = layer_ == MapLayer::depth ? "{:.1f} mm" : "{:.3f} mm";
  figure(fmt::format(fmt::runtime(form), span->low).c_str(),
         fmt::format(fmt::runtime(form), span->high));
  if (layer_ == MapLayer::difference) {
    remark(
        "Measured minus other. Black: wrong (more than 1 % of the distance off, or no surface "
        "there). Grey: unknown.");
  } else {
    remark("Grey: unknown.");
  }
}

void RangeView::panel_of_figures() {
  heading("Figures");
  const auto pixels = static_cast<double>(frame_.map.z.size());
  figure("pixels", fmt::format("{} \u00d7 {}", frame_.map.z.cols(), frame_.map.z.rows()));
  figure("with a depth",
         fmt::format("{:.1f} %", pixels > 0 ? 100.0 * static_cast<double>(known_) / pixels : 0));
  if (!frame_.score) return;
  const geometry::RangeMapScore& score = *frame_.score;
  figure("of the other's", fmt::format("{:.1f} %", 100 * score.coverage));
  figure("median difference", fmt::format("{:.3f} mm", score.error.median));
  figure("RMS", fmt::format("{:.3f} mm", score.error.rms));
  figure("wrong", fmt::format("{:.2f} %", 100 * score.wrong_share));
}

void RangeView::panel_of_pixel() {
  heading("Under the pointer");
  if (!pointer_ || pointer_->x() >= size_.x()) return remark("-");
  const Eigen::Vector2d place = (*pointer_ - corner_) / scale_;
  const auto col = static_cast<Eigen::Index>(std::floor(place.x()));
  const auto row = static_cast<Eigen::Index>(std::floor(place.y()));
  if (col < 0 || row < 0 || col >= frame_.map.z.cols() || row >= frame_.map.z.rows())
    return remark("-");
  figure("pixel", fmt::format("{}, {}", col, row));
  const auto length = [](float value) {
    return std::isfinite(value) ? fmt::format("{:.3f} mm", value) : std::string("unknown");
  };
  figure("depth", length(frame_.map.z(row, col)));
  if (frame_.deviation.size() > 0) figure("deviation", length(frame_.deviation(row, col)));
  if (frame_.reasons.size() > 0) {
    figure("reason", apps::reason_words()[frame_.reasons(row, col)]);
  }
  if (frame_.score) figure("difference", length(frame_.score->difference(row, col)));
}

}  // namespace

std::unique_ptr<View> make_range_view(RangeScene scene) {
  return std::make_unique<RangeView>(std::move(scene));
}

}  // namespace palpate::view
