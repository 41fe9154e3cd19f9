// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model_view.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_control.h"
#include "dented_surface.h"
#include "draw_chart.h"
#include "force_reading.h"
#include "live_loop.h"
#include "panel.h"
#include "scene_renderer.h"
#include "theme.h"
#include "tick_player.h"
#include "tool_solids.h"

namespace palpate::view {
namespace {

using haptics::ContactState;

constexpr double kArrowLength = 0.36;   // diagonals, of the force at the top of the chart
constexpr double kUnknownBall = 0.014;  // diagonals: radius of a tool whose size is unknown
constexpr double kScaleFollow = 0.3;    // of the way a frame, when the scale changes
constexpr double kWheelDepth = 0.04;    // a line of the wheel
constexpr double kKeyDepth = 1.12;      // a key's factor of the depth
constexpr double kShiftDepth = 0.006;   // a pixel, with Shift
constexpr double kKeySpeed = 0.35;      // of the picture's height a second: an arrow key
constexpr int kWeightsShown = 4;

struct StateWords {
  const char *word, *why;
};
StateWords words_of(ContactState state) {
  switch (state) {
    case ContactState::free:
      return {"Free", "The tool touches nothing."};
    case ContactState::stick:
      return {"Sticks", "The tool holds at the contact."};
    case ContactState::slip:
      break;
  }
  return {"Slips", "The tool slides over the object."};
}

Extent extent_of_model(const haptics::Model& model) {
  Extent extent = extent_of(model.surface);
  extent.facing.setZero();
  for (const haptics::ContactModel& contact : model.contacts) {
    extent.facing -= haptics::pressing_frame(contact).col(2);
  }
  extent.facing /= static_cast<double>(model.contacts.size());
  return extent;
}

class ModelView final : public View {
 public:
  explicit ModelView(ModelScene scene)
      : scene_(std::move(scene)),
        extent_(extent_of_model(scene_.model)),
        field_(scene_.model),
        control_(extent_),
        aim_(extent_.diagonal),
        trial_(try_presses(*scene_.playback, scene_.model, aim_.wish().depth)),
        chart_(trial_.force),
        surface_(scene_.model, field_.surface(), aim_.deepest() / 2),
        scale_{.diagonal = extent_.diagonal,
               .radius = scene_.model.probe_radius.value_or(kUnknownBall * extent_.diagonal),
               .length_of_newton = kArrowLength * extent_.diagonal / trial_.force} {
    aim_.set_depth(trial_.depth);
    if (scene_.played) player_.emplace(std::move(*scene_.played));
    if (!player_ && !scene_.still) {
      loop_ =
          std::make_unique<LiveLoop>(scene_.playback, LiveLoopOptions{.diagonal = extent_.diagonal,
                                                                      .record = scene_.record,
                                                                      .session = scene_.session});
    }
  }

  void close() override {
    if (loop_) tell(loop_->finish());
    loop_.reset();
  }

  void resize(int width, int height) override {
    size_ = {width, height};
    control_.camera.resize(width, height);
  }

  void button(MouseButton button, bool down, const Eigen::Vector2d& at, bool shift) override {
    pointer_ = last_ = at;
    if (!down) {
      if (button == MouseButton::left) lift();
      control_.release();
      return;
    }
    if (button == MouseButton::left && press_at(at)) return;
    control_.press(button, at, shift);
  }

  void move(const Eigen::Vector2d& at, bool shift) override {
    const double down = at.y() - last_.y();
    last_ = at;
    const bool is_deeper = !control_.drag(at) && aim_.wish().pressed && shift;
    if (is_deeper) {
      change_depth(std::exp(down * kShiftDepth));
    } else {
      pointer_ = at;
    }
  }

  void wheel(double lines) override {
    if (aim_.wish().pressed) {
      change_depth(std::exp(lines * kWheelDepth));
    } else {
      control_.wheel(lines);
    }
  }

  bool key(int key, bool down) override {
    switch (key) {
      case GLFW_KEY_LEFT:
        return hold({-1, 0}, 0, down);
      case GLFW_KEY_RIGHT:
        return hold({1, 0}, 0, down);
      case GLFW_KEY_UP:
        return hold({0, -1}, 1, down);
      case GLFW_KEY_DOWN:
        return hold({0, 1}, 1, down);
      case GLFW_KEY_SPACE:
        if (player_) {
          if (down) player_->toggle();
        } else if (!down) {
          lift();
        } else if (!aim_.wish().pressed) {
          press_at(start_aim());
        }
        return true;
      case GLFW_KEY_EQUAL:
      case GLFW_KEY_KP_ADD:
        if (down) change_depth(kKeyDepth);
        return true;
      case GLFW_KEY_MINUS:
      case GLFW_KEY_KP_SUBTRACT:
        if (down) change_depth(1 / kKeyDepth);
        return true;
      default:
        return down && control_.key(key);
    }
  }

  void advance(double seconds) override {
    control_.advance(seconds);
    if (!held_.isZero(0)) {
      const double way = kKeySpeed * size_.y() * seconds;
      pointer_ = (start_aim() + way * held_).cwiseMax(0).cwiseMin(size_.cast<double>());
    }
    if (player_) {
      player_->advance(seconds);
      take_played();
    } else if (loop_) {
      if (aim_.wish().pressed && pointer_) {
        aim_.drag(control_.camera.ray(*pointer_), field_.surface(), scene_.model.surface);
      }
      loop_->set_wish(aim_.wish());
      while (const std::optional<FeltTick> tick = loop_->take()) take(*tick);
    }
    surface_.show(reading_, tick_.state != ContactState::free && reading_.at.triangle >= 0,
                  !scene_.still);
    const double wanted = kArrowLength * extent_.diagonal / chart_.top();
    scale_.length_of_newton += kScaleFollow * (wanted - scale_.length_of_newton);
  }

  void draw(bool hurry) override {
    const Shot shot = control_.camera.shot();
    SceneRenderer::begin();
    surface_.draw(shot, {.wireframe = wireframe_, .coarse = hurry});
    scene_renderer_.draw_backdrop();
    if (show_dots_) surface_.draw_contacts(scene_renderer_, shot, control_.camera.size_of_pixel());
    scene_renderer_.draw(solids(), shot);
  }

  void panel() override;

  [[nodiscard]] bool is_moving() const override {
    const bool felt = tick_.state != ContactState::free || aim_.wish().pressed ||
                      !chart_.is_empty() || !held_.isZero(0);
    return control_.is_turning() || (player_ ? player_->is_playing() : felt);
  }

  void turn() override { control_.turntable = true; }

  [[nodiscard]] double duration() const override { return player_ ? player_->duration() : 0; }

 private:
  bool press_at(const Eigen::Vector2d& at) {
    if (!loop_) return false;
    const std::optional<PickedPlace> hit =
        pick(field_.surface(), scene_.model.surface, control_.camera.ray(at));
    if (!hit) return false;
    aim_.press(*hit);
    return true;
  }

  void lift() { aim_.lift(); }

  /// Keys begin in the middle of the picture.
  Eigen::Vector2d start_aim() {
    if (!pointer_) pointer_ = size_.cast<double>() / 2;
    return *pointer_;
  }

  bool hold(const Eigen::Vector2d& way, int axis, bool down) {
    held_[axis] = down ? way[axis] : 0;
    return true;
  }

  void change_depth(double factor) { aim_.set_depth(aim_.wish().depth * factor); }

  void take(const FeltTick& tick) {
    tick_ = tick;
    reading_ = read_force(field_, tick);
    chart_.add(reading_, tick.state);
  }

  /// Goes on with what is played. If the slider went back, the chart shows what came before.
  void take_played() {
    const TickPlayer::Part part = player_->take(StripChart::kCount);
    if (part.anew) {
      chart_ = StripChart(trial_.force);
      tick_ = {};
      reading_ = {};
    }
    for (const FeltTick& tick : part.ticks) take(tick);
  }

  [[nodiscard]] std::vector<Solid> solids() const {
    if (tick_.state != ContactState::free) return touching_tool(tick_, reading_, scale_);
    if (player_) return player_->time() > 0 ? free_tool(tick_.tool, scale_) : std::vector<Solid>();
    if (!loop_ || !pointer_ || aim_.wish().pressed) return {};
    const std::optional<PickedPlace> hovered =
        pick(field_.surface(), scene_.model.surface, control_.camera.ray(*pointer_));
    return hovered ? hovering_tool(*hovered, scale_) : std::vector<Solid>();
  }

  void panel_of_force();
  void panel_of_fields();
  void panel_of_play();
  static void tell(const haptics::RunReport& report);

  ModelScene scene_;
  Extent extent_;
  haptics::BlendedField field_;
  CameraControl control_;
  ToolAim aim_;
  PressTrial trial_;
  StripChart chart_;
  DentedSurface surface_;
  SceneRenderer scene_renderer_;
  std::unique_ptr<LiveLoop> loop_;    // of the mouse,
  std::optional<TickPlayer> player_;  // or of what is played
  FeltTick tick_;
  ForceReading reading_;
  ToolScale scale_;
  Eigen::Vector2i size_ = Eigen::Vector2i::Ones();
  std::optional<Eigen::Vector2d> pointer_;          // where the tool is wanted
  Eigen::Vector2d last_ = Eigen::Vector2d::Zero();  // of the events
  Eigen::Vector2d held_ = Eigen::Vector2d::Zero();  // by the arrow keys
  bool show_dots_ = true, wireframe_ = false, show_nearest_ = false;
};

void ModelView::panel() {
  const Eigen::Vector3d size = extent_.high - extent_.low;
  begin_panel(scene_.name,
              fmt::format("{:.3g} \u00d7 {:.3g} \u00d7 {:.3g} mm, {} contacts, {} vertices",
                          size.x(), size.y(), size.z(), scene_.model.contacts.size(),
                          scene_.model.surface.vertices.cols()));
  panel_of_force();
  draw_chart(chart_, 120);
  ImGui::TextColored(panel_color(kForce), "force %.3f", reading_.total);
  ImGui::SameLine();
  ImGui::TextColored(panel_color(kNormal), "normal %.3f", reading_.normal);
  ImGui::SameLine();
  ImGui::TextColored(panel_color(kTangential), "tang. %.3f", reading_.tangential);
  panel_of_fields();
  if (player_) {
    panel_of_play();
  } else {
    heading("Depth of a press");
    auto depth = static_cast<float>(aim_.wish().depth);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##depth", &depth, static_cast<float>(aim_.shallowest()),
                           static_cast<float>(aim_.deepest()), "%.2f mm")) {
      aim_.set_depth(static_cast<double>(depth));
    }
    remark(
        "Press and hold to push in, move to drag; meanwhile the wheel changes the depth. "
        "Drag beside the object to turn it.");
  }
  heading("View");
  ImGui::Checkbox("contacts", &show_dots_);
  ImGui::SameLine();
  ImGui::Checkbox("edges", &wireframe_);
  if (surface_.is_recorded() && ImGui::Checkbox("nearest recorded surface", &show_nearest_)) {
    surface_.set_rule(show_nearest_ ? haptics::ShapeRule::nearest : haptics::ShapeRule::blended);
  }
  remark(kCameraKeys);
  remark(fmt::format("1 N is drawn {:.2g} mm long. {}", scale_.length_of_newton,
                     surface_.origin_in_words()));
  if (!scene_.record.empty()) remark("Recording to " + scene_.record.filename().string());
  end_panel();
}

void ModelView::panel_of_force() {
  ImGui::PushFont(large_font());
  ImGui::Text("%.2f N", reading_.total);
  ImGui::PopFont();
  if (reading_.deviation) {
    // Beside the number, at its foot, without moving what is below.
    const ImVec2 end = ImGui::GetItemRectMax();
    ImGui::GetWindowDrawList()->AddText(
        {end.x + 8, end.y - ImGui::GetFontSize() - 6}, ink(kQuiet),
        fmt::format("\u00b1 {:.2g} N", *reading_.deviation).c_str());
  }
  const StateWords words = words_of(tick_.state);
  badge(words.word, color_of(tick_.state));
  ImGui::SameLine();
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + 5);
  remark(words.why);
  // The safety layer may give a device less than what the model says.
  const double given = tick_.commanded.norm();
  constexpr double kTold = 0.005;  // [N]: what the numbers show
  remark(std::abs(given - reading_.total) > kTold
             ? fmt::format("A device would be given {:.2f} N: the safety layer limits it.", given)
             : std::string(" "));
}

void ModelView::panel_of_fields() {
  heading("Fields that contribute");
  std::vector<std::pair<double, int>> shares;
  for (int i = 0; i < reading_.weights.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    shares.emplace_back(reading_.weights.weights[k], reading_.weights.contacts[k]);
  }
  std::ranges::sort(shares, std::greater<>());
  const float line = ImGui::GetTextLineHeightWithSpacing() + 3;
  const float top = ImGui::GetCursorPosY();
  int shown = 0;
  for (const auto& [share, contact] : shares) {
    if (shown++ == kWeightsShown) break;
    const std::string label =
        fmt::format("contact {}: {:.0f} %",
                    scene_.model.contacts[static_cast<std::size_t>(contact)].id, 100 * share);
    ImGui::ProgressBar(static_cast<float>(share), {70, ImGui::GetTextLineHeight()}, "");
    ImGui::SameLine();
    ImGui::TextUnformatted(label.c_str());
  }
  if (shares.empty()) remark("none: the tool touches nothing");
  // The place is kept, so that what is below does not jump.
  ImGui::SetCursorPosY(top + kWeightsShown * line);
  figure("friction coefficient", tick_.state == ContactState::free
                                     ? std::string("-")
                                     : fmt::format("{:.2f}", reading_.friction));
  const Eigen::Vector3d& at = tick_.contact;
  figure("contact [mm]", tick_.state == ContactState::free
                             ? std::string("-")
                             : fmt::format("{:.1f}, {:.1f}, {:.1f}", at.x(), at.y(), at.z()));
}

void ModelView::panel_of_play() {
  heading(scene_.played_words.c_str());
  if (ImGui::Button(player_->is_playing() ? "Pause" : "Play", {64, 0})) player_->toggle();
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  auto seconds = static_cast<float>(player_->time());
  if (ImGui::SliderFloat("##time", &seconds, 0, static_cast<float>(player_->duration()), "%.2f s"))
    player_->seek(static_cast<double>(seconds));
}

void ModelView::tell(const haptics::RunReport& report) {
  const auto ticks = static_cast<double>(std::max(1LL, report.time.ticks));
  spdlog::info(
      "{} ticks at {:.0f} Hz, {} late ({:.3f} %); a tick takes {:.1f} us (median), {:.1f} us (99.9 "
      "%); {}",
      report.time.ticks, report.time.rate, report.time.late,
      100.0 * static_cast<double>(report.time.late) / ticks, report.time.p50, report.time.p999,
      report.not_real_time.empty() ? std::string("real-time scheduling")
                                   : "no real-time scheduling: " + report.not_real_time);
}

}  // namespace

std::unique_ptr<View> make_model_view(ModelScene scene) {
  return std::make_unique<ModelView>(std::move(scene));
}

}  // namespace palpate::view
