// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "force_reading.h"
#include "scene_renderer.h"
#include "surface_renderer.h"

namespace palpate::view {

/// The surface of a model with its contacts, deformed where the tool touches: as recorded surfaces
/// show it if the model has any, otherwise by a drawn dent.
class DentedSurface {
 public:
  /// \param model, query are kept. \param deep [mm] displacement that gets the whole tint of a dent
  DentedSurface(const haptics::Model& model, const geometry::SurfaceQuery& query, double deep);

  /// Says whether the deformed surface is measured or drawn.
  [[nodiscard]] std::string origin_in_words() const;
  [[nodiscard]] bool is_recorded() const { return model_.response.has_value(); }
  /// Sets how it is made of recorded surfaces.
  void set_rule(haptics::ShapeRule rule);
  /// Puts the dent where a reading says; `touches` false: none. \param hurry a dent that takes long
  /// may stay as it is for some pictures
  void show(const ForceReading& reading, bool touches, bool hurry);
  void draw(const Shot& shot, const SurfaceLook& look) const { renderer_.draw(shot, look); }
  /// The contacts, which move with the surface.
  void draw_contacts(const SceneRenderer& scene, const Shot& shot, double size_of_pixel) const;

 private:
  using DentClock = std::chrono::steady_clock;

  VertexRange deform(const ForceReading& reading);
  void color_vertices(const VertexRange& range);
  void put_contacts();

  SurfaceShape shape_;
  haptics::DrawnShapeOptions options_;
  const haptics::Model& model_;
  const geometry::SurfaceQuery& query_;
  geometry::GeodesicSurface geodesics_;  // of the undeformed surface
  haptics::ShapeRule rule_ = haptics::ShapeRule::blended;
  bool is_stale_ = false;                                   // the rule has changed
  double deep_, least_move_;                                // [mm]
  Eigen::Vector3d contact_ = Eigen::Vector3d::Zero();       // [mm] of the dent that is shown
  Eigen::Vector3d displacement_ = Eigen::Vector3d::Zero();  // [mm]
  Eigen::Matrix3Xf contacts_;                               // [mm] on the undeformed surface
  std::vector<geometry::SurfacePoint> nearest_;             // of each contact
  SurfaceRenderer renderer_;
  VertexColors colors_;
  PointSet dots_;
  bool is_dented_ = false;
  DentClock::time_point next_;  // of a dent in a hurry
};

}  // namespace palpate::view
