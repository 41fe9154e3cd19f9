// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "picture.h"

#include "chart.h"

namespace palpate::bench {
namespace {

using namespace pictures;

constexpr int kPictureHeight = 980;
constexpr double kMargin = 20;  ///< px
constexpr double kLegend = 66;  ///< px, two rows
constexpr Rgb kColors[] = {kBlue, kVermilion, kGreen, kPurple, kOrange, kSky, kBlack};

Eigen::Map<const Eigen::VectorXd> view_of(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

void draw_panel(Canvas& canvas, const Box& box, const Panel& panel) {
  pictures::Axis x{kEmptySpan, panel.x_label};
  pictures::Axis y{{0, 0}, panel.y_label};
  std::vector<LegendEntry> legend;
  double least = HUGE_VAL;
  for (const Curve& curve : panel.curves) {
    legend.push_back({curve.name, kColors[legend.size()]});
    x.span.include(view_of(curve.x));
    y.span.include(view_of(curve.y));
    for (const double value : curve.y) least = std::fmin(least, value);
  }
  // Coverage is told by what lacks to all; everything else from nothing on.
  if (least > y.span.high / 2) y.span.low = least;
  y.span.pad();
  y.span.high = std::fmin(y.span.high, panel.most);
  add_legend(canvas, {box.x + box.width / 2, box.y + box.height - kLegend / 2}, box.width, legend);
  Chart chart(canvas, {box.x, box.y, box.width, box.height - kLegend}, x, y);
  chart.add_axes();
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    chart.add_line(view_of(curve.x), view_of(curve.y), kColors[i], 2);
    chart.add_markers(view_of(curve.x), view_of(curve.y), kColors[i], 8);
  }
}

}  // namespace

void draw_panels(const std::filesystem::path& png, const std::string& title,
                 const std::vector<Panel>& panels) {
  Canvas canvas(kPictureHeight, title, "");
  const double width = (Canvas::kWidth - 3 * kMargin) / 2;
  const double height = (canvas.top() - 3 * kMargin) / 2;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Box box{kMargin + static_cast<double>(i % 2) * (width + kMargin),
                  kMargin + (i < 2 ? height + kMargin : 0), width, height};
    draw_panel(canvas, box, panels[i]);
  }
  canvas.write(png);
}

}  // namespace palpate::bench
