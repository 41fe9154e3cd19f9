// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "force_reading.h"
#include "scene_renderer.h"
#include "surface_renderer.h"

namespace palpate::view {

/// The surface of a model with its contacts, and a dent where the tool touches.
class DentedSurface {
 public:
  /// \param deep [mm] displacement that gets the whole tint of a dent
  DentedSurface(const haptics::Model& model, const geometry::SurfaceQuery& query, double deep);

  /// Puts the dent where a reading says; `touches` false: none.
  void show(const ForceReading& reading, bool touches);
  void draw(const Shot& shot, const SurfaceLook& look) const { renderer_.draw(shot, look); }
  /// The contacts, which move with the surface.
  void draw_contacts(const SceneRenderer& scene, const Shot& shot, double size_of_pixel) const;

 private:
  void color_vertices(const VertexRange& range);
  void put_contacts();

  SurfaceShape shape_;
  haptics::DrawnShapeOptions options_;
  double deep_;
  Eigen::Matrix3Xf contacts_;                    // [mm] on the undeformed surface
  std::vector<geometry::SurfacePoint> nearest_;  // of each contact
  SurfaceRenderer renderer_;
  VertexColors colors_;
  PointSet dots_;
  bool is_dented_ = false;
};

}  // namespace palpate::view
