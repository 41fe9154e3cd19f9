// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// Stand-ins for threads, words and other libraries, which a page does not have.
#include "geodesic/geodesic_methods.h"
#include "palpate/core/error.h"
#include "palpate/core/fields.h"
#include "palpate/core/idle_fields.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/contact_triangulation.h"

namespace palpate {

void parallel_ranges(std::ptrdiff_t count, std::ptrdiff_t /*grain*/,
                     const std::function<void(std::ptrdiff_t begin, std::ptrdiff_t end)>& body) {
  if (count > 0) body(0, count);
}

// Without words: nobody could read them.
void require(std::string_view /*name*/, double value, const Interval& range,
             std::string_view /*unit*/) {
  if (!range.contains(value)) throw InvalidInput("");
}

void require(std::string_view name, const std::optional<double>& value, const Interval& range,
             std::string_view unit) {
  if (value) require(name, *value, range, unit);
}

// Options of a page are the usual ones.
void require_in_range(const FieldList& /*fields*/) {}
void refuse_idle(const FieldList& /*fields*/, const FieldList& /*usual*/,
                 std::string_view /*cause*/, std::initializer_list<std::string_view> /*idle*/) {}

namespace geometry {

// Models come with their weights (`to_bytes`), and pages draw by fast marching.
SurfaceWeights project_weights(const TriangleMesh& /*surface*/, const TriangleMesh& /*contacts*/) {
  throw Unavailable("");
}

GeodesicDistance exact_geodesic_distance(const GeodesicSurface& /*surface*/,
                                         std::span<const SurfacePoint> /*sources*/,
                                         const GeodesicOptions& /*options*/) {
  throw Unavailable("");
}

}  // namespace geometry
}  // namespace palpate

// A page has no exceptions: what would throw stops the program, and the page says so.
extern "C" {
void* __cxa_allocate_exception(std::size_t /*size*/) { __builtin_trap(); }
void __cxa_throw(void* /*thrown*/, void* /*type*/, void (* /*destroy*/)(void*)) {
  __builtin_trap();
}
}
