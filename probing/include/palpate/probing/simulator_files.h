// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "palpate/probing/finite_element_specimen.h"
#include "palpate/probing/material_text.h"

// A solid with its material, as input of simulators. Each has the mesh, the moduli and the supports
// with their moves. Obstacles cannot be described: a solid with any is refused (InvalidInput).
namespace palpate::probing {

/// Input of CalculiX: elements C3D10, Mooney-Rivlin, mm and N. If there is a press, a last step
/// moves the nodes that the tip touches to where `ContactEquilibrium` has them after the press's
/// displacement, and prints the sum of their reactions (RF): the force of the press.
/// \throws SolverError if the press has no equilibrium.
void write_calculix(std::ostream& out, const FiniteElementObject& object,
                    const std::optional<KnownPress>& press);

/// A scene of SOFA 24.06 or later (XML): linear tetrahedra at the corners of the elements,
/// hyperelastic, mm, N and tonnes. It loads `mesh_file`, which `write_linear_gmsh` writes.
void write_sofa(std::ostream& out, const FiniteElementObject& object, const std::string& mesh_file);

/// A model of MuJoCo with a flexcomp of linear tetrahedra, in m and Pa: a Saint Venant-Kirchhoff
/// material with the moduli at small strains. It loads `mesh_file`.
/// \throws InvalidInput if the solid has several regions or supports that move.
void write_mujoco(std::ostream& out, const FiniteElementObject& object,
                  const std::string& mesh_file);

/// The tetrahedra between the corners of the elements, Gmsh 2.2 in ASCII; coordinates times
/// `scale`. The physical group of an element is its region.
void write_linear_gmsh(std::ostream& out, const FiniteElementMesh& mesh, double scale);

}  // namespace palpate::probing
