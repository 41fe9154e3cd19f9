// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/pictures/draw_contacts.h"
#include "palpate/pictures/draw_deviation.h"
#include "palpate/pictures/draw_differences.h"
#include "palpate/pictures/draw_displacements.h"
#include "palpate/pictures/draw_distances.h"
#include "palpate/pictures/draw_force_errors.h"
#include "palpate/pictures/draw_force_field.h"
#include "palpate/pictures/draw_forces.h"
#include "palpate/pictures/draw_hues.h"
#include "palpate/pictures/draw_joint_torques.h"
#include "palpate/pictures/draw_labels.h"
#include "palpate/pictures/draw_mesh.h"
#include "palpate/pictures/draw_range_map.h"
#include "palpate/pictures/draw_residuals.h"
#include "palpate/pictures/draw_section.h"
#include "palpate/pictures/draw_stiffness.h"
#include "palpate/pictures/draw_time_line.h"
#include "palpate/pictures/draw_touch.h"

namespace palpate::pictures {

/// The functions that draw, in the module `pictures`.
struct Drawings {
  decltype(&draw_contacts) contacts;
  decltype(&draw_deviation) deviation;
  decltype(&draw_differences) differences;
  decltype(&draw_displacements) displacements;
  decltype(&draw_distances) distances;
  decltype(&draw_force_errors) force_errors;
  decltype(&draw_force_field) force_field;
  decltype(&draw_forces) forces;
  decltype(&draw_hues) hues;
  decltype(&draw_joint_torques) joint_torques;
  decltype(&draw_labels) labels;
  decltype(&draw_mesh) mesh;
  decltype(&draw_range_map) range_map;
  decltype(&draw_residuals) residuals;
  decltype(&draw_section) section;
  decltype(&draw_stiffness) stiffness;
  decltype(&draw_time_line) time_line;
  decltype(&draw_touch) touch;
};

}  // namespace palpate::pictures

extern "C" const palpate::pictures::Drawings palpate_pictures;
