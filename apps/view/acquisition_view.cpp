// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "acquisition_view.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "camera_control.h"
#include "color_map.h"
#include "panel.h"
#include "sample_arrows.h"
#include "scene_renderer.h"
#include "shared/words.h"
#include "surface_renderer.h"
#include "theme.h"

namespace palpate::view {
namespace {

constexpr double kLongestArrow = 0.14;  // diagonals, of a force that one of a hundred exceeds
constexpr double kBarb = 0.22;          // of an arrow's length: its head
constexpr double kRarely = 0.99;        // of the values that a scale spans
constexpr float kContactSize = 9;       // [px]
constexpr double kPickDistance = 14;    // [px] from a contact that is clicked
constexpr float kShortestScale = 0.1F, kLongestScale = 4;
constexpr float kPlainSurface = 0.82F;  // of the light of the surface, so that arrows stand out

/// The value that one of a hundred exceeds; 1 if all are 0.
template <typename Value>
double usual_top(const std::vector<SampleArrow>& arrows, Value value) {
  std::vector<double> values;
  for (const SampleArrow& arrow : arrows) values.push_back(value(arrow));
  if (values.empty()) return 1;
  std::ranges::sort(values);
  const double top =
      values[static_cast<std::size_t>(kRarely * static_cast<double>(values.size() - 1))];
  return top > 0 ? top : 1;
}

const char* name_of(haptics::PairKind kind) {
  switch (kind) {
    case haptics::PairKind::settled:
      return "normal force alone";
    case haptics::PairKind::held:
      return "held";
    case haptics::PairKind::friction_boundary:
      break;
  }
  return "at the friction boundary";
}
constexpr std::array<pictures::Rgb, 3> kKindColors{pictures::kBlack, pictures::kBlue,
                                                   pictures::kVermilion};

class AcquisitionView final : public View {
 public:
  explicit AcquisitionView(AcquisitionScene scene)
      : scene_(std::move(scene)),
        arrows_(sample_arrows(scene_.acquisition, scene_.model ? &*scene_.model : nullptr)),
        rms_(residual_rms(arrows_)),
        extent_(extent_of_all()),
        control_(extent_),
        top_force_(usual_top(arrows_, [](const SampleArrow& a) { return a.force.norm(); })),
        top_residual_(
            usual_top(arrows_, [](const SampleArrow& a) { return a.residual.value_or(0); })) {
    if (scene_.surface) {
      const SurfaceShape shape(*scene_.surface);
      renderer_.put(shape);
      VertexColors colors(4, shape.positions().cols());
      const Eigen::Vector3f base = 255 * kPlainSurface * color(kSky);
      Eigen::Vector4<unsigned char> rgba;
      rgba << base.cast<unsigned char>(), 255;
      colors.colwise() = rgba;
      renderer_.put_colors(colors);
    }
    put_arrows();
  }

  void resize(int width, int height) override { control_.camera.resize(width, height); }

  void button(MouseButton button, bool down, const Eigen::Vector2d& at, bool shift) override {
    if (!down) return control_.release();
    if (button == MouseButton::left) {
      if (const std::optional<std::size_t> contact = contact_at(at)) return choose(contact);
    }
    control_.press(button, at, shift);
  }
  void move(const Eigen::Vector2d& at, bool /*shift*/) override { control_.drag(at); }
  void wheel(double lines) override { control_.wheel(lines); }
  bool key(int key, bool down) override {
    if (!down) return false;
    const std::size_t count = scene_.acquisition.contacts().size();
    switch (key) {
      case GLFW_KEY_RIGHT:
        choose(chosen_ ? (*chosen_ + 1) % count : 0);
        return true;
      case GLFW_KEY_LEFT:
        choose(chosen_ ? (*chosen_ + count - 1) % count : count - 1);
        return true;
      case GLFW_KEY_HOME:
        choose(std::nullopt);
        return true;
      default:
        return control_.key(key);
    }
  }
  void advance(double seconds) override { control_.advance(seconds); }
  void draw(bool hurry) override {
    const Shot shot = control_.camera.shot();
    SceneRenderer::begin();
    if (scene_.surface && show_surface_)
      renderer_.draw(shot, {.wireframe = false, .coarse = hurry});
    scene_renderer_.draw_backdrop();
    scene_renderer_.draw_lines(lines_, shot);
    scene_renderer_.draw_points(
        dots_, shot, kContactSize,
        static_cast<double>(kContactSize) * control_.camera.size_of_pixel());
  }
  void panel() override;
  [[nodiscard]] bool is_moving() const override { return control_.is_turning(); }
  void turn() override { control_.turntable = true; }
  [[nodiscard]] double duration() const override { return 0; }

 private:
  Extent extent_of_all() const {
    const std::vector<probing::Contact>& contacts = scene_.acquisition.contacts();
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(contacts.size() + arrows_.size()));
    Eigen::Vector3d facing = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      points.col(static_cast<Eigen::Index>(i)) = contacts[i].position;
      facing += contacts[i].normal / static_cast<double>(contacts.size());
    }
    for (std::size_t i = 0; i < arrows_.size(); ++i)
      points.col(static_cast<Eigen::Index>(contacts.size() + i)) = arrows_[i].tool;
    Extent extent = scene_.surface ? extent_of(*scene_.surface) : extent_of(points);
    extent.facing = facing;
    return extent;
  }

  std::optional<std::size_t> contact_at(const Eigen::Vector2d& at) const {
    std::optional<std::size_t> nearest;
    double least = kPickDistance;
    const std::vector<probing::Contact>& contacts = scene_.acquisition.contacts();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const std::optional<Eigen::Vector2d> pixel = control_.camera.pixel(contacts[i].position);
      if (!pixel || (*pixel - at).norm() >= least) continue;
      least = (*pixel - at).norm();
      nearest = i;
    }
    return nearest;
  }

  void choose(std::optional<std::size_t> contact) {
    chosen_ = contact;
    put_arrows();
  }

  [[nodiscard]] pictures::Rgb color_of_arrow(const SampleArrow& arrow) const {
    if (arrow.residual)
      return pictures::color_at(pictures::ColorMap::sequential, *arrow.residual / top_residual_);
    return kKindColors[static_cast<std::size_t>(arrow.kind)];
  }

  /// A shaft and two barbs for each arrow; its tip is where the tool was.
  void put_arrows() {
    std::vector<const SampleArrow*> shown;
    for (const SampleArrow& arrow : arrows_)
      if (!chosen_ || arrow.contact == *chosen_) shown.push_back(&arrow);
    ColoredPoints lines;
    lines.positions.resize(3, 6 * static_cast<Eigen::Index>(shown.size()));
    lines.colors.resize(4, lines.positions.cols());
    const double scale =
        static_cast<double>(length_) * kLongestArrow * extent_.diagonal / top_force_;
    Eigen::Index next = 0;
    for (const SampleArrow* arrow : shown) {
      const Eigen::Vector3d way = scale * arrow->force;
      const Eigen::Vector3d tip = arrow->tool;
      const Eigen::Vector3d side = way.isZero(0)
                                       ? Eigen::Vector3d::Zero().eval()
                                       : Eigen::Vector3d(way.unitOrthogonal() * way.norm());
      const pictures::Rgb rgb = color_of_arrow(*arrow);
      for (const Eigen::Vector3d& end :
           {Eigen::Vector3d(tip - way), Eigen::Vector3d(tip - kBarb * (way + 0.5 * side)),
            Eigen::Vector3d(tip - kBarb * (way - 0.5 * side))}) {
        lines.positions.col(next) = end.cast<float>();
        lines.positions.col(next + 1) = tip.cast<float>();
        lines.colors.col(next) << rgb[0], rgb[1], rgb[2], 220;
        lines.colors.col(next + 1) = lines.colors.col(next);
        next += 2;
      }
    }
    lines_.put(lines);
    put_contacts();
  }

  void put_contacts() {
    const std::vector<probing::Contact>& contacts = scene_.acquisition.contacts();
    ColoredPoints dots;
    dots.positions.resize(3, static_cast<Eigen::Index>(contacts.size()));
    dots.colors.resize(4, dots.positions.cols());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      dots.positions.col(column) = contacts[i].position.cast<float>();
      const Eigen::Vector3f rgb = 255 * color(chosen_ == i ? kSlip : kDot);
      dots.colors.col(column) << rgb.cast<unsigned char>(), 255;
    }
    dots_.put(dots);
  }

  void panel_of_contact();
  void panel_of_arrow_colors();

  AcquisitionScene scene_;
  std::vector<SampleArrow> arrows_;
  std::optional<double> rms_;
  Extent extent_;
  CameraControl control_;
  double top_force_, top_residual_;  // [N]
  SurfaceRenderer renderer_;
  SceneRenderer scene_renderer_;
  PointSet lines_, dots_;
  std::optional<std::size_t> chosen_;
  bool show_surface_ = true;
  float length_ = 1;
};

void AcquisitionView::panel() {
  const std::vector<probing::Sample>& samples = scene_.acquisition.samples();
  begin_panel(scene_.name, fmt::format("acquisition, {} contacts, {} samples",
                                       scene_.acquisition.contacts().size(), samples.size()));
  heading("All contacts");
  figure("slipped", fmt::format("{}", std::ranges::count_if(
                                          samples, [](const auto& s) { return s.slipped; })));
  figure("at the friction boundary",
         fmt::format("{}", std::ranges::count_if(
                               samples, [](const auto& s) { return s.on_friction_boundary; })));
  figure("pairs of force and displacement", fmt::format("{}", arrows_.size()));
  figure("99 % of the forces up to", apps::newtons(top_force_, 2));
  if (rms_) figure("RMS from the model", apps::newtons(*rms_));
  panel_of_contact();
  panel_of_arrow_colors();
  heading("View");
  if (scene_.surface) ImGui::Checkbox("surface", &show_surface_);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##length", &length_, kShortestScale, kLongestScale, "arrows x %.1f",
                         ImGuiSliderFlags_Logarithmic)) {
    put_arrows();
  }
  remark(fmt::format("1 N is drawn {:.2g} mm long. An arrow ends where the tool was.",
                     static_cast<double>(length_) * kLongestArrow * extent_.diagonal / top_force_));
  remark("Click a contact, or Left and Right; Home shows all. " + std::string(kCameraKeys));
  if (!scene_.surface) remark("--surface shows the surface, --model compares the forces.");
  end_panel();
}

void AcquisitionView::panel_of_contact() {
  if (!chosen_) return;
  const probing::Contact& contact = scene_.acquisition.contacts()[*chosen_];
  heading(fmt::format("Contact {}", contact.id).c_str());
  figure("position [mm]", fmt::format("{:.1f}, {:.1f}, {:.1f}", contact.position.x(),
                                      contact.position.y(), contact.position.z()));
  figure("samples", fmt::format("{}", scene_.acquisition.samples_of(*chosen_).size()));
  std::vector<SampleArrow> own;
  std::ranges::copy_if(arrows_, std::back_inserter(own),
                       [&](const SampleArrow& a) { return a.contact == *chosen_; });
  if (const std::optional<double> rms = residual_rms(own)) {
    figure("RMS from the model", apps::newtons(*rms));
  } else if (scene_.model) {
    remark("The model does not have this contact.");
  }
}

void AcquisitionView::panel_of_arrow_colors() {
  heading("Colours of the arrows");
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (!rms_) {
    for (const haptics::PairKind kind : {haptics::PairKind::settled, haptics::PairKind::held,
                                         haptics::PairKind::friction_boundary}) {
      const ImVec2 at = ImGui::GetCursorScreenPos();
      const pictures::Rgb& rgb = kKindColors[static_cast<std::size_t>(kind)];
      draw.AddRectFilled({at.x, at.y + 1}, {at.x + 14, at.y + 15},
                         IM_COL32(rgb[0], rgb[1], rgb[2], 255), 2);
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 22);
      ImGui::TextUnformatted(name_of(kind));
    }
    return;
  }
  color_bar(pictures::ColorMap::sequential);
  figure("0 N", apps::newtons(top_residual_, 3));
  remark("Difference of the model's force from the measured one, at the same displacement.");
}

}  // namespace

std::unique_ptr<View> make_acquisition_view(AcquisitionScene scene) {
  return std::make_unique<AcquisitionView>(std::move(scene));
}

}  // namespace palpate::view
