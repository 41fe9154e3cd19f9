// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The functions of the module `pictures`; the rest of it is the library `palpate_drawing`.
#include "drawings.h"

const palpate::pictures::Drawings palpate_pictures{
    .contacts = &palpate::pictures::draw_contacts,
    .deviation = &palpate::pictures::draw_deviation,
    .differences = &palpate::pictures::draw_differences,
    .displacements = &palpate::pictures::draw_displacements,
    .distances = &palpate::pictures::draw_distances,
    .force_errors = &palpate::pictures::draw_force_errors,
    .force_field = &palpate::pictures::draw_force_field,
    .forces = &palpate::pictures::draw_forces,
    .hues = &palpate::pictures::draw_hues,
    .joint_torques = &palpate::pictures::draw_joint_torques,
    .labels = &palpate::pictures::draw_labels,
    .mesh = &palpate::pictures::draw_mesh,
    .range_map = &palpate::pictures::draw_range_map,
    .residuals = &palpate::pictures::draw_residuals,
    .section = &palpate::pictures::draw_section,
    .stiffness = &palpate::pictures::draw_stiffness,
    .time_line = &palpate::pictures::draw_time_line,
    .touch = &palpate::pictures::draw_touch,
};
