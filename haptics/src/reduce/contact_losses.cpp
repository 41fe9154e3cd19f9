// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/contact_losses.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "build/without_contact.h"
#include "model/contact_places.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/left_out_triangulations.h"
#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {
namespace {

/// The strokes at whose ends a contact has weight.
struct StrokesAtContact {
  std::vector<Stroke> strokes;
  std::vector<StrokeEnd> ends;
  double squares = 0;  // [N²] sum of the squared differences at the ends
};

std::vector<StrokesAtContact> strokes_at_contacts(const BlendedField& field, std::size_t contacts,
                                                  std::span<const Stroke> strokes,
                                                  std::span<const StrokeEnd> ends,
                                                  std::span<const double> differences) {
  std::vector<StrokesAtContact> result(contacts);
  std::size_t end = 0;
  for (const Stroke& stroke : strokes) {
    const std::size_t first = end;
    end += stroke.dragged == stroke.pressed ? 1 : 2;
    std::vector<int> touched;
    double squares = 0;
    for (std::size_t e = first; e < end; ++e) {
      squares += differences[e] * differences[e];
      const geometry::ContactWeights at =
          field.weights(field.surface().closest_point(ends[e].contact).at);
      for (int k = 0; k < at.count; ++k)
        touched.push_back(at.contacts[static_cast<std::size_t>(k)]);
    }
    std::ranges::sort(touched);
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const int contact : touched) {
      StrokesAtContact& of = result[static_cast<std::size_t>(contact)];
      of.strokes.push_back(stroke);
      of.ends.insert(of.ends.end(), ends.begin() + static_cast<std::ptrdiff_t>(first),
                     ends.begin() + static_cast<std::ptrdiff_t>(end));
      of.squares += squares;
    }
  }
  return result;
}

}  // namespace

std::vector<double> contact_losses(const Model& model, std::span<const Stroke> strokes,
                                   std::span<const StrokeEnd> ends,
                                   std::span<const double> differences) {
  const BlendedField field(model);
  const std::vector<StrokesAtContact> at =
      strokes_at_contacts(field, model.contacts.size(), strokes, ends, differences);
  const geometry::LeftOutTriangulations triangulations(
      model.surface, contact_places(model, field.surface()), {.method = model.triangulation});
  std::vector<double> losses(at.size(), std::numeric_limits<double>::infinity());
  parallel_for(at.size(), [&](std::size_t i) {
    const StrokesAtContact& of = at[i];
    try {
      const Model rest = without_contact(model, triangulations, i);
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
