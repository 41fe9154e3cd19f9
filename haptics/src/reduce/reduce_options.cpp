// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/reduce_model.h"

namespace palpate::haptics {

void visit(ReduceOptions& options, FieldVisitor& visitor) {
  visitor.begin("ReduceOptions");
  visitor.real(
      {"max_error",
       "Allowed error of the force, root mean square over random presses and drags. It includes "
       "the error that the model states for itself. Without it, that error may grow by a tenth; "
       "if the model states none, the force may change by 1 %",
       "N"},
      options.max_error, above(0).finite());
  visitor.real({"max_relative_error",
                "The same, relative to the root mean square of the force; 0.07 is about the least "
                "difference that people feel"},
               options.max_relative_error, above(0).at_most(1));
  visitor.real(
      {"max_surface_error",
       "Allowed distance between the surfaces. Without it and without picture_size: a thousandth "
       "of the diagonal of the surface",
       "mm"},
      options.max_surface_error, at_least(0).finite());
  visitor.real(
      {"picture_size",
       "Pixels along the diagonal of the surface when all of it is shown: the surface may move by "
       "one",
       "px"},
      options.picture_size, at_least(1).finite());
  visitor.real(
      {"max_size", "Allowed size of the model folder; the allowed errors are raised until it holds",
       "bytes"},
      options.max_size, above(0).finite());
  visitor.real(
      {"largest_force",
       "Largest force of a press; nothing is compared beyond it. If neither force nor depth is "
       "limited: as far as most contacts were measured",
       "N"},
      options.largest_force, above(0).finite());
  visitor.real({"largest_depth", "Largest depth of a press", "mm"}, options.largest_depth,
               above(0).finite());
  visitor.flag({"slip", "Compare the forces of drags"}, options.slip);
  visitor.flag({"keep_shapes", "Keep the recorded motion of the surface, if the model has it"},
               options.keep_shapes);
  visitor.whole({"strokes", "Number of random presses that measure the difference", "", true},
                options.strokes, at_least(100).at_most(1'000'000));
  visitor.whole({"seed", "Seed of the random presses", "", true}, options.seed, at_least(0));
}

}  // namespace palpate::haptics
