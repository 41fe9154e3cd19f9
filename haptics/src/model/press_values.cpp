// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/press_values.h"

#include <limits>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {

PressValues press_values(const Model& model, double depth) {
  require("press_values(): depth", depth, above(0).finite(), "mm");
  const BlendedField field(model);
  const std::vector<geometry::SurfacePoint> vertices = geometry::vertex_points(model.surface);
  const auto unknown = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(vertices.size()),
                                                 std::numeric_limits<double>::quiet_NaN());
  PressValues values{.force = unknown, .stiffness = unknown, .deviation = unknown};
  parallel_for(unknown.size(), [&](Eigen::Index i) {
    const geometry::SurfacePoint& vertex = vertices[static_cast<std::size_t>(i)];
    if (vertex.triangle < 0) return;
    const Blend at = field.blend(vertex);
    if (at.contacts.count == 0) return;
    const Eigen::Vector3d inwards = at.field_frame.col(2);
    values.force[i] = field.force(at, depth * inwards).dot(inwards);
    values.stiffness[i] = inwards.dot(field.stiffness(at, depth * inwards) * inwards);
    if (const auto deviation = field.deviation(vertex, depth * inwards))
      values.deviation[i] = *deviation;
  });
  return values;
}

std::optional<double> reference_press_depth(const Model& model) {
  if (model.interpolation.reference_depth > 0) return model.interpolation.reference_depth;
  std::vector<double> depths;
  for (const ContactModel& contact : model.contacts)
    if (contact.compliance) depths.push_back(contact.compliance->values[2]);
  return depths.empty() ? std::nullopt : std::optional(median(depths));
}

}  // namespace palpate::haptics
