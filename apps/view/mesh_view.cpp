// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh_view.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <optional>
#include <utility>

#include "camera_control.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "panel.h"
#include "scene_renderer.h"
#include "surface_renderer.h"
#include "theme.h"

namespace palpate::view {
namespace {

/// The figures of a mesh on the panel.
struct MeshFigures {
  double area = 0;  // [mm^2]
  /// None for meshes where three triangles share an edge, or two turn against each other.
  std::optional<int> parts, borders;
  std::optional<double> volume;  // [mm^3] of a closed mesh
};

MeshFigures figures_of(const geometry::TriangleMesh& mesh) {
  MeshFigures figures{
      .area = geometry::surface_area(mesh), .parts = {}, .borders = {}, .volume = {}};
  try {
    figures.parts = geometry::connected_components(mesh).count;
    figures.borders = static_cast<int>(geometry::boundary_loops(mesh).size());
    if (*figures.borders == 0) figures.volume = geometry::enclosed_volume(mesh);
  } catch (const InvalidInput&) {  // has no such figures; palpate info says where it is wrong
  }
  return figures;
}

class MeshView final : public View {
 public:
  explicit MeshView(MeshScene scene)
      : scene_(std::move(scene)),
        figures_(figures_of(scene_.file.mesh)),
        extent_(extent_of(scene_.file.mesh)),
        control_(extent_),
        shape_(scene_.file.mesh) {
    renderer_.put(shape_);
    VertexColors colors(4, shape_.positions().cols());
    const Eigen::Vector3f base = 255 * color(kSurface);
    Eigen::Vector4<unsigned char> rgba;
    rgba << base.cast<unsigned char>(), 255;
    colors.colwise() = rgba;
    renderer_.put_colors(colors);
  }

  void resize(int width, int height) override { control_.camera.resize(width, height); }
  void button(MouseButton button, bool down, const Eigen::Vector2d& at, bool shift) override {
    if (down) {
      control_.press(button, at, shift);
    } else {
      control_.release();
    }
  }
  void move(const Eigen::Vector2d& at, bool /*shift*/) override { control_.drag(at); }
  void wheel(double lines) override { control_.wheel(lines); }
  bool key(int key, bool down) override {
    if (!down) return false;
    if (key == GLFW_KEY_E) {
      look_.wireframe = !look_.wireframe;
      return true;
    }
    return control_.key(key);
  }
  void advance(double seconds) override { control_.advance(seconds); }
  void draw(bool hurry) override {
    SceneRenderer::begin();
    SurfaceLook look = look_;
    look.coarse = hurry;
    renderer_.draw(control_.camera.shot(), look);
    scene_renderer_.draw_backdrop();
  }
  void panel() override;
  [[nodiscard]] bool is_moving() const override { return control_.is_turning(); }
  [[nodiscard]] double duration() const override { return 0; }
  void turn() override { control_.turntable = true; }

 private:
  MeshScene scene_;
  MeshFigures figures_;
  Extent extent_;
  CameraControl control_;
  SurfaceShape shape_;
  SurfaceRenderer renderer_;
  SceneRenderer scene_renderer_;
  SurfaceLook look_;
};

void MeshView::panel() {
  const geometry::TriangleMesh& mesh = scene_.file.mesh;
  const Eigen::Vector3d size = extent_.high - extent_.low;
  begin_panel(scene_.name, "mesh");
  heading("Figures");
  figure("vertices", fmt::format("{}", mesh.vertices.cols()));
  figure("triangles", fmt::format("{}", mesh.triangles.cols()));
  figure("size [mm]",
         fmt::format("{:.4g} \u00d7 {:.4g} \u00d7 {:.4g}", size.x(), size.y(), size.z()));
  figure("area [mm\u00b2]", fmt::format("{:.5g}", figures_.area));
  if (figures_.volume) figure("volume [mm\u00b3]", fmt::format("{:.5g}", *figures_.volume));
  if (figures_.parts) figure("parts", fmt::format("{}", *figures_.parts));
  if (figures_.borders) {
    figure("borders", *figures_.borders == 0 ? std::string("none: closed")
                                             : fmt::format("{}", *figures_.borders));
  } else {
    remark("Its triangles do not form a surface everywhere; palpate info says where.");
  }
  if (scene_.file.unit.source == geometry::UnitSource::assumed)
    remark("The file declares no unit: mm are assumed (--unit).");
  heading("View");
  ImGui::Checkbox("edges (E)", &look_.wireframe);
  ImGui::SameLine();
  ImGui::Checkbox("turn (K)", &control_.turntable);
  remark("The left button turns too. " + std::string(kCameraKeys));
  end_panel();
}

}  // namespace

std::unique_ptr<View> make_mesh_view(MeshScene scene) {
  return std::make_unique<MeshView>(std::move(scene));
}

}  // namespace palpate::view
