// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/surface_query.h"

namespace palpate::view {

/// A place of the undeformed surface that the pointer shows.
struct PickedPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< unit, outwards
};

/// The place where a ray meets a surface from outside; none if it meets nothing or the inside.
[[nodiscard]] std::optional<PickedPlace> pick(const geometry::SurfaceQuery& query,
                                              const geometry::TriangleMesh& surface,
                                              const geometry::Ray& ray);

/// The wish of the user for the tool: the mouse as it is now.
struct ToolWish {
  int presses = 0;       ///< that began until now; the next one begins at `at`
  bool pressed = false;  ///< the button is down
  PickedPlace at;        ///< the wanted place of the tool on the undeformed surface
  double depth = 0;      ///< [mm] >= 0 below it
};

/// Turns motions of the mouse into wishes for the tool, on the side of the window.
class ToolAim {
 public:
  /// \param diagonal [mm] of the object
  explicit ToolAim(double diagonal);

  void press(const PickedPlace& place);
  void lift() { wish_.pressed = false; }
  /// Drags to where the ray meets the plane of the press, and from there to the surface: another
  /// part of the object that the ray happens to hit is not jumped to.
  void drag(const geometry::Ray& ray, const geometry::SurfaceQuery& query,
            const geometry::TriangleMesh& surface);
  /// [mm], within `shallowest` and `deepest`.
  void set_depth(double depth);

  [[nodiscard]] const ToolWish& wish() const { return wish_; }
  [[nodiscard]] double shallowest() const;
  [[nodiscard]] double deepest() const;

 private:
  double diagonal_;
  ToolWish wish_;
};

/// The motion of the tool, tick by tick: it follows the wish without jumps while it presses, and
/// lies aside, outside of everything, when nothing is pressed.
///
/// A press begins a little above the surface. The tool comes there from aside in one tick. That is
/// farther than any device moves, so that playback takes it for a fault, forgets the contact, and
/// starts again after some ticks (`PlaybackOptions::hold_ticks`). The tool waits there for that
/// time. Equal requests give equal motions, bit by bit.
class ToolMotion {
 public:
  /// \param diagonal [mm] of the object. \param aside [mm] outside of the object, and farther from
  /// it than `PlaybackOptions::longest_step`.
  ToolMotion(double diagonal, const Eigen::Vector3d& aside);

  /// The place of the tool [mm] after the next tick of 1 ms. Real-time safe.
  [[nodiscard]] Eigen::Vector3d tick(const ToolWish& wish) noexcept;

  static constexpr int kWaitingTicks = 25;  ///< above the surface, before a press

 private:
  enum class Mode { aside, wait, press, lift };

  void begin(const ToolWish& wish) noexcept;

  double diagonal_, gap_;
  Eigen::Vector3d aside_;
  Mode mode_ = Mode::aside;
  int presses_ = 0, waited_ = 0;
  PickedPlace at_;
  double sunk_ = 0;  // [mm] below the surface
};

}  // namespace palpate::view
