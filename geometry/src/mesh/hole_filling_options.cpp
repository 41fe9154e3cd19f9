// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Also in a build without CGAL, which fills the holes.
#include "palpate/geometry/hole_filling.h"

namespace palpate::geometry {

void visit(HoleFillingOptions& options, FieldVisitor& visitor) {
  visitor.begin("HoleFillingOptions");
  visitor.real({.name = "max_diameter",
                .description = "Fill holes up to this diameter, the diagonal of their bounding box",
                .unit = "mm",
                .option = "fill_holes"},
               options.max_diameter, above(0));
}

void check_hole_filling(const HoleFillingOptions& options) {
  static_cast<void>(in_range(options));
  require_given("HoleFillingOptions::max_diameter", options.max_diameter.has_value());
}

}  // namespace palpate::geometry
