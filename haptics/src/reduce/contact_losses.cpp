// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/contact_losses.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/left_out_triangulations.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {
namespace {

/// The strokes at whose ends a contact has weight.
struct StrokesAtContact {
  std::vector<Stroke> strokes;
  std::vector<StrokeEnd> ends;
  double squares = 0;  // [N²] sum of the squared differences at the ends
};

std::vector<StrokesAtContact> strokes_at_contacts(const Model& model,
                                                  std::span<const Stroke> strokes,
                                                  std::span<const StrokeEnd> ends,
                                                  std::span<const double> differences) {
  const BlendedField field(model);
  std::vector<StrokesAtContact> result(model.contacts.size());
  std::size_t end = 0;
  for (const Stroke& stroke : strokes) {
    const std::size_t first = end;
    end += stroke.dragged == stroke.pressed ? 1 : 2;
    std::vector<int> contacts;
    double squares = 0;
    for (std::size_t e = first; e < end; ++e) {
      squares += differences[e] * differences[e];
      const geometry::ContactWeights at =
          field.weights(field.surface().closest_point(ends[e].contact).at);
      for (int k = 0; k < at.count; ++k)
        contacts.push_back(at.contacts[static_cast<std::size_t>(k)]);
    }
    std::ranges::sort(contacts);
    contacts.erase(std::unique(contacts.begin(), contacts.end()), contacts.end());
    for (const int contact : contacts) {
      StrokesAtContact& of = result[static_cast<std::size_t>(contact)];
      of.strokes.push_back(stroke);
      of.ends.insert(of.ends.end(), ends.begin() + static_cast<std::ptrdiff_t>(first),
                     ends.begin() + static_cast<std::ptrdiff_t>(end));
      of.squares += squares;
    }
  }
  return result;
}

std::vector<geometry::SurfacePoint> points_of_contacts(const Model& model) {
  const geometry::SurfaceQuery query(model.surface);
  std::vector<geometry::SurfacePoint> points;
  for (const ContactModel& contact : model.contacts)
    points.push_back(query.closest_point(contact.position).at);
  return points;
}

}  // namespace

std::vector<double> contact_losses(const Model& model, std::span<const Stroke> strokes,
                                   std::span<const StrokeEnd> ends,
                                   std::span<const double> differences) {
  const std::vector<StrokesAtContact> at = strokes_at_contacts(model, strokes, ends, differences);
  const geometry::LeftOutTriangulations left_out(model.surface, points_of_contacts(model),
                                                 {.method = model.triangulation});
  std::vector<double> losses(at.size(), std::numeric_limits<double>::infinity());
  parallel_for(at.size(), [&](std::size_t i) {
    const StrokesAtContact& of = at[i];
    try {
      geometry::ContactTriangulation triangulation = left_out.without(i);
      Model rest = model;
      rest.contacts.erase(rest.contacts.begin() + static_cast<std::ptrdiff_t>(i));
      rest.triangles = std::move(triangulation.mesh.triangles);
      rest.surface_weights = std::move(triangulation.weights);
      double squares = 0;
      for (const double difference : force_differences(of.ends, play_strokes(rest, of.strokes)))
        squares += difference * difference;
      losses[i] = squares - of.squares;
    } catch (const Error&) {
      // The others have no triangulation.
    }
  });
  return losses;
}

}  // namespace palpate::haptics
