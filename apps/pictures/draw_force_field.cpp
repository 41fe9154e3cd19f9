// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_force_field.h"

#include <algorithm>
#include <cmath>

#include "canvas.h"
#include "chart.h"
#include "force_field_scene.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr int kFieldPictureHeight = 820;
constexpr double kFieldMargin = 16;    ///< px
constexpr double kSceneWidth = 690;    ///< px, of the panel on the left
constexpr double kHeadingHeight = 26;  ///< px, of a chart
constexpr double kChartGap = 24;       ///< px between the charts

constexpr double kMarkerSize = 5;  ///< px

void check_input(const ContactSamples& samples, const ContactFit& fit) {
  const Eigen::Index count = samples.displacements.cols();
  refuse_unless(count > 0, "displacements", "is empty: there is nothing to draw");
  check_count(samples.forces.cols(), count, "forces");
  check_count(static_cast<Eigen::Index>(samples.on_boundary.size()), count, "on_boundary");
  for (Eigen::Index sample = 0; sample < count; ++sample) {
    const std::string place = "sample " + std::to_string(sample) + " is not finite";
    refuse_unless(samples.displacements.col(sample).allFinite(), "displacements", place);
    refuse_unless(samples.forces.col(sample).allFinite(), "forces", place);
  }
  refuse_unless(static_cast<bool>(fit.field), "field", "there is none");
  refuse_unless(fit.friction_axis.allFinite() && fit.friction_axis.norm() > 0, "friction axis",
                "a finite direction is needed");
  require("ContactFit::friction_coefficient", fit.friction_coefficient, at_least(0).finite());
}

FittedSamples evaluate(const ContactSamples& samples, const ContactFit& fit) {
  FittedSamples contact{samples, Eigen::Matrix3Xd(3, samples.forces.cols()),
                        fit.friction_axis.normalized(), fit.friction_coefficient};
  for (Eigen::Index sample = 0; sample < samples.forces.cols(); ++sample) {
    contact.fitted.col(sample) = fit.field(samples.displacements.col(sample));
    refuse_unless(contact.fitted.col(sample).allFinite(), "field",
                  "is not finite at the displacement of sample " + std::to_string(sample));
  }
  return contact;
}

/// The box below a heading that is written at its top.
Box add_heading(Canvas& canvas, const Box& box, const std::string& heading) {
  canvas.add_text({box.x + box.width / 2, box.y + box.height - kHeadingHeight / 2}, heading,
                  {.size = 17});
  return {box.x, box.y, box.width, box.height - kHeadingHeight};
}

/// Tangential against normal force, samples on the boundary above the others, and the cone's line.
void add_friction_chart(Canvas& canvas, const Box& box, const FittedSamples& contact) {
  const Eigen::Matrix3Xd& forces = contact.samples.forces;
  const Eigen::VectorXd normal = forces.transpose() * contact.axis;
  const Eigen::VectorXd tangential =
      (forces - contact.axis * normal.transpose()).colwise().norm().transpose();
  Axis x{{0, 0}, "normal force (N)"};
  Axis y{{0, 0}, "tangential force (N)"};
  x.span.include(normal);
  y.span.include(tangential);
  x.span.pad();
  y.span.pad();
  Chart chart(
      canvas,
      add_heading(canvas, box,
                  "Friction coefficient " + format_value(contact.friction_coefficient, 0.01)),
      x, y);
  chart.add_axes();
  const auto split = [&contact](const Eigen::VectorXd& values, bool on_boundary) {
    Eigen::VectorXd part = values;
    for (Eigen::Index sample = 0; sample < values.size(); ++sample) {
      if (contact.samples.on_boundary[static_cast<std::size_t>(sample)] != on_boundary) {
        part(sample) = std::nan("");
      }
    }
    return part;
  };
  for (const bool on_boundary : {false, true}) {
    chart.add_markers(split(normal, on_boundary), split(tangential, on_boundary),
                      on_boundary ? kBoundaryColor : kStickingColor,
                      on_boundary ? kMarkerSize + 2 : kMarkerSize);
  }
  // Without friction the line lies on the axis, as far as it goes.
  const double end = contact.friction_coefficient > 0
                         ? std::min(x.span.high, y.span.high / contact.friction_coefficient)
                         : x.span.high;
  chart.add_line(Eigen::Vector2d(0, end), Eigen::Vector2d(0, end * contact.friction_coefficient),
                 kConeColor, 3);
}

/// Each component of each sample, and the line on which a perfect fit lies.
void add_fit_chart(Canvas& canvas, const Box& box, const FittedSamples& contact) {
  const Eigen::VectorXd measured = contact.samples.forces.reshaped();
  const Eigen::VectorXd fitted = contact.fitted.reshaped();
  // As thesis 5.3.1.3: the length of the error vector.
  const double rms =
      std::sqrt((contact.fitted - contact.samples.forces).colwise().squaredNorm().mean());
  Axis x{kEmptySpan, "measured force, each component (N)"};
  Axis y{kEmptySpan, "fitted (N)"};
  x.span.include(measured);
  x.span.include(fitted);
  x.span.pad();
  y.span = x.span;
  Chart chart(
      canvas,
      add_heading(canvas, box, "Fit: root mean square error " + format_value(rms, 0.001) + " N"), x,
      y);
  chart.add_axes();
  chart.add_markers(measured, fitted, kFittedColor, kMarkerSize - 1);
  const Eigen::Vector2d ends(x.span.low, x.span.high);
  chart.add_line(ends, ends, kGrey, 1.5);
}

}  // namespace

void draw_force_field(const std::filesystem::path& png, const ContactSamples& samples,
                      const ContactFit& fit, const std::string& title) {
  check_input(samples, fit);
  const FittedSamples contact = evaluate(samples, fit);
  const auto boundary = std::count(samples.on_boundary.begin(), samples.on_boundary.end(), true);
  Canvas canvas(kFieldPictureHeight, title,
                std::to_string(samples.forces.cols()) + " samples, " + std::to_string(boundary) +
                    " of them on the friction boundary");
  const double height = canvas.top() - kLegendHeight - kFieldMargin;
  const double grid =
      add_force_field_scene(canvas, {0, kFieldMargin, kSceneWidth, height}, contact);
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2},
             Canvas::kWidth - 2 * kFieldMargin,
             {{"measured, sticking", kStickingColor},
              {"measured, about to slip", kBoundaryColor},
              {"fitted", kFittedColor},
              {"friction cone and its axis", kConeColor},
              {"surface at rest, grid " + format_value(grid, grid) + " mm", kPlaneColor}});

  const double x = kSceneWidth + kFieldMargin;
  const double width = Canvas::kWidth - kFieldMargin - x;
  const double chart_height = (height - kChartGap) / 2;
  add_friction_chart(canvas, {x, kFieldMargin + (height + kChartGap) / 2, width, chart_height},
                     contact);
  add_fit_chart(canvas, {x, kFieldMargin, width, chart_height}, contact);
  canvas.write(png);
}

}  // namespace palpate::pictures
