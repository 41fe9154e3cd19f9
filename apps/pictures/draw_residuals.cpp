// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_residuals.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr double kImageTitleHeight = 30;  ///< px, above each image
constexpr double kScaleHeight = 50;       ///< px, below each image
constexpr double kChartHeight = 300;      ///< px
constexpr double kMarksHeight = 30;       ///< px, of the chart's legend
constexpr double kArrow = 40;             ///< px, the length of the longest arrow
constexpr std::array<Rgb, 2> kImageColors{kBlue, kVermilion};

void check_input(const std::vector<ResidualImage>& images) {
  refuse_unless(images.size() == 1 || images.size() == kImageColors.size(), "images",
                "one or two are needed");
  for (const ResidualImage& image : images) {
    require(image.title + ": width", image.width, at_least(1), "px");
    require(image.title + ": height", image.height, at_least(1), "px");
    refuse_unless(!image.views.empty(), image.title.c_str(), "there is no view");
    for (const ResidualView& view : image.views) {
      const std::string what = image.title + ", view '" + view.name + "'";
      refuse_unless(view.at.cols() > 0, what.c_str(), "there is no point");
      check_count(view.residual.cols(), view.at.cols(), what.c_str());
      refuse_unless(view.at.allFinite() && view.residual.allFinite(), what.c_str(),
                    "a point or residual is not finite");
    }
  }
}

double rms(const Eigen::Matrix2Xd& residual) {
  return std::sqrt(residual.squaredNorm() / static_cast<double>(residual.cols()));
}

double longest(const ResidualImage& image) {
  double length = 0;
  for (const ResidualView& view : image.views)
    length = std::max(length, view.residual.colwise().norm().maxCoeff());
  return length;
}

/// The frame of the image with its arrows, within `box`.
void add_image(Canvas& canvas, const Box& box, const ResidualImage& image, const Rgb& color) {
  const double scale = std::min(box.width / image.width, box.height / image.height);
  const Box frame{box.x + (box.width - scale * image.width) / 2,
                  box.y + box.height - scale * image.height, scale * image.width,
                  scale * image.height};
  TextStyle bold;
  bold.bold = true;
  canvas.add_text({frame.x + frame.width / 2, frame.y + frame.height + kImageTitleHeight / 2},
                  image.title, bold);
  canvas.add_outline(frame);
  const double length = longest(image);
  const double enlarged = length > 0 ? kArrow / length : 0;
  // Pixel centres are at whole numbers; rows run downwards.
  const auto place = [&](const Eigen::Vector2d& pixel) {
    return Eigen::Vector2d(frame.x + scale * (pixel.x() + 0.5),
                           frame.y + frame.height - scale * (pixel.y() + 0.5));
  };
  for (const ResidualView& view : image.views) {
    Eigen::Matrix2Xd points(2, view.at.cols());
    for (Eigen::Index i = 0; i < view.at.cols(); ++i) {
      points.col(i) = place(view.at.col(i));
      Eigen::Matrix2d line;
      line.col(0) = points.col(i);
      line.col(1) =
          points.col(i) + enlarged * Eigen::Vector2d(view.residual(0, i), -view.residual(1, i));
      canvas.add_line(line, color, 2);
    }
    canvas.add_markers(points, color, 3);
  }
  if (length > 0) {
    const double bar = round_down(length);
    canvas.add_bar({frame.x, frame.y - kScaleHeight + 14}, enlarged * bar,
                   format_value(bar, bar) + " px");
  }
}

/// Dots: the root mean square of each view, in the order given.
void add_view_chart(Canvas& canvas, const Box& box, const std::vector<ResidualImage>& images) {
  std::vector<Eigen::VectorXd> values;
  std::vector<Eigen::VectorXd> numbers;
  Axis x{kEmptySpan, "view", 1};
  Axis y{{0, 0}, "RMS residual (px)"};
  std::vector<LegendEntry> legend;
  for (const ResidualImage& image : images) {
    const auto count = static_cast<Eigen::Index>(image.views.size());
    numbers.emplace_back(Eigen::VectorXd::LinSpaced(count, 1, static_cast<double>(count)));
    values.emplace_back(count);
    for (Eigen::Index i = 0; i < count; ++i)
      values.back()[i] = rms(image.views[static_cast<std::size_t>(i)].residual);
    x.span.include(numbers.back());
    y.span.include(values.back());
    legend.push_back({image.title, kImageColors.at(legend.size()), Mark::dot});
  }
  x.span = {x.span.low - 1, x.span.high + 1};
  if (!(y.span.high > 0)) y.span.high = 1;
  y.span.pad();
  add_legend(canvas, {Canvas::kWidth / 2.0, box.y + box.height - kMarksHeight / 2}, box.width,
             legend);
  Chart chart(canvas, {box.x, box.y, box.width, box.height - kMarksHeight}, x, y);
  chart.add_axes();
  for (std::size_t i = 0; i < values.size(); ++i)
    chart.add_markers(numbers[i], values[i], legend[i].color, 10);
}

}  // namespace

void draw_residuals(const std::filesystem::path& png, const std::vector<ResidualImage>& images,
                    const std::string& title) {
  check_input(images);
  Canvas canvas(Canvas::kHeight, title,
                "line from each dot: seen minus predicted place, enlarged; the bar gives the scale "
                "of the lines");
  add_view_chart(canvas,
                 {kChartMargin, kChartMargin, Canvas::kWidth - 2 * kChartMargin, kChartHeight},
                 images);
  const double low = kChartMargin + kChartHeight + kScaleHeight;
  const auto count = static_cast<double>(images.size());
  const double width = (Canvas::kWidth - (count + 1) * kChartMargin) / count;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const double left = kChartMargin + static_cast<double>(i) * (width + kChartMargin);
    add_image(canvas, {left, low, width, canvas.top() - kImageTitleHeight - low}, images[i],
              kImageColors.at(i));
  }
  canvas.write(png);
}

}  // namespace palpate::pictures
