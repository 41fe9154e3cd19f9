// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "color_map.h"
#include "offscreen_display.h"

class vtkOpenGLRenderWindow;
class vtkRenderer;
class vtkStringOutputWindow;
class vtkOutputWindow;

namespace palpate::pictures {

/// A rectangle of a picture, in px from its lower left corner.
struct Box {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

/// Opaque pixels, starting with the lowest row.
struct Pixels {
  int width = 0;
  int height = 0;
  std::vector<Rgb> colors;
};

/// Around an image, px.
inline constexpr double kImageMargin = 30;

enum class Align { low, middle, high };

struct TextStyle {
  int size = 16;
  Rgb color = {40, 40, 40};
  Align across = Align::middle;
  Align up = Align::middle;
  bool bold = false;
  bool upwards = false;  ///< true if the text runs from bottom to top
};

/// A white picture with flat drawings and 3-D panels, written as PNG.
///
/// Coordinates are px, (0, 0) in the lower left corner. Later drawings cover earlier ones; flat
/// drawings cover the 3-D panels.
class Canvas {
 public:
  static constexpr int kWidth = 1200;
  static constexpr int kHeight = 900;  ///< of most pictures

  /// `title` is drawn at the top, and `subtitle` (may be empty) below it in grey.
  /// \throws OutputError if there is no display to draw on.
  Canvas(int height, const std::string& title, const std::string& subtitle);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// The highest y below the title.
  [[nodiscard]] double top() const { return top_; }

  void add_text(const Eigen::Vector2d& at, const std::string& text, const TextStyle& style = {});
  /// Size of a text in the picture, px.
  [[nodiscard]] Eigen::Vector2d text_size(const std::string& text,
                                          const TextStyle& style = {}) const;
  /// Draws one line through all points, interrupted where a point is not finite.
  void add_line(const Eigen::Ref<const Eigen::Matrix2Xd>& points, const Rgb& color,
                double width = 1);
  void add_markers(const Eigen::Ref<const Eigen::Matrix2Xd>& centers, const Rgb& color,
                   double size);
  void add_rectangle(const Box& box, const Rgb& color);
  void add_outline(const Box& box);
  /// Draws a scale bar with its text above it; `at` is its left end.
  void add_bar(const Eigen::Vector2d& at, double length, const std::string& text);
  void add_pixels(const Eigen::Vector2d& lower_left, const Pixels& pixels);
  /// Adds a panel for 3-D actors.
  [[nodiscard]] vtkRenderer* add_panel(const Box& box);

  /// Writes the picture.
  /// \throws OutputError if it cannot be drawn or written; an existing file is then unchanged.
  void write(const std::filesystem::path& png);

 private:
  OffscreenDisplay display_;  // first member: until the last one is gone it is this one's turn
  vtkSmartPointer<vtkOutputWindow> previous_messages_;
  vtkNew<vtkStringOutputWindow> messages_;
  vtkOpenGLRenderWindow* window_;  // that of all pictures
  vtkNew<vtkRenderer> flat_;
  int height_;
  double top_;
};

}  // namespace palpate::pictures
