// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/finite_element_specimen.h"

namespace palpate::probing {

/// A press that was measured, with which a simulation of the material can be compared. All in the
/// frame of the solid.
struct KnownPress {
  long long contact = 0;                                   ///< id
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [mm] of the contact
  Eigen::Vector3d inward = Eigen::Vector3d::Zero();        ///< unit length, on which the tip came
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm] of the tip since it touched
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< [N] on the object
};

/// The text of a specimen file of the type finite_elements with the materials and the friction of
/// `object`, moves of supports as large as its, and the presses. Other members stay as they are.
/// \param object has the regions and supports that the text states.
/// \throws FileError as `parse_finite_elements` does.
[[nodiscard]] std::string with_material(const std::string& text, const std::string& source,
                                        const FiniteElementObject& object,
                                        const std::vector<KnownPress>& presses);

/// The presses of such a text; none if it has no member "identified".
/// \throws FileError if they are damaged.
[[nodiscard]] std::vector<KnownPress> parse_presses(const std::string& text,
                                                    const std::string& source);

}  // namespace palpate::probing
