// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

namespace palpate::geometry {

/// A part of an edge that the straight lines from one point reach through the same triangles.
///
/// These triangles are laid in the plane of the edge, which runs along the first axis from zero.
struct Window {
  double begin, end;     ///< the part of the edge
  double along, height;  ///< the point: its foot on the line of the edge; its distance from it
  double start;          ///< distance of the point itself from its source
  int source;
  bool forward;        ///< true if the lines enter the triangle whose half-edge runs as the edge
  bool waits = false;  ///< still to be passed on

  /// Distance from the source to a place on the edge.
  [[nodiscard]] double at(double place) const {
    const double aside = place - along;
    return start + std::sqrt(aside * aside + height * height);
  }

  /// The least distance in the window.
  [[nodiscard]] double least() const {
    if (along <= begin) return at(begin);
    return along >= end ? at(end) : start + height;
  }
};

/// The window seen from the other end of an edge of the given length.
[[nodiscard]] inline Window turned(Window window, double length) {
  const double begin = window.begin;
  window.begin = length - window.end;
  window.end = length - begin;
  window.along = length - window.along;
  return window;
}

/// For each edge, the windows that are nearest at some place, sorted and without overlap.
class EdgeWindows {
 public:
  explicit EdgeWindows(size_t edge_count) : of_edge_(edge_count), finished_(edge_count, 0) {}

  [[nodiscard]] std::vector<Window>& of(int edge) { return of_edge_[static_cast<size_t>(edge)]; }
  [[nodiscard]] const std::vector<Window>& of(int edge) const {
    return of_edge_[static_cast<size_t>(edge)];
  }

  /// Adds the parts of a window that are nearer than the known windows, and removes the parts of
  /// these that are farther.
  /// \return the least distance in the added parts; infinite if there are none.
  double add(int edge, const Window& window);

  /// Nothing will be added to an edge any more. \param keep true if its windows are still needed
  void finish(int edge, bool keep);
  [[nodiscard]] bool is_finished(int edge) const {
    return finished_[static_cast<size_t>(edge)] != 0;
  }

 private:
  void append(const Window& window, double begin, double end, int index);
  void append_nearer(const Window& known, int index, const Window& added, double begin, double end);

  std::vector<std::vector<Window>> of_edge_;
  std::vector<char> finished_;  ///< of each edge
  std::vector<Window> parts_;   ///< scratch: replacement for the windows that overlap the one added
  int last_ = 0;                ///< index of the window of the last part
  bool is_added_ = false;
};

}  // namespace palpate::geometry
