// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/error_budget.h"
#include "palpate/haptics/reduce_model.h"

namespace palpate::haptics {

/// Tells how large the error of a model of the same object would be with other contacts.
///
/// The error is the one that the model states (`BlendedField::deviation`), as a root mean square
/// over the ends of random strokes, as many as `reduce_model` chooses with. Its parts change with
/// the contacts:
/// - the errors of the contacts themselves stay the same;
/// - the part that grows with the distance to the contacts takes the distances to the new ones;
/// - the part from the contrast of compliances, which is proportional to their squared difference,
///   grows with the mean squared distance.
class ErrorForecast {
 public:
  /// \param model of the object, or of a similar one.
  /// \param needs which strokes count: the places, forces and depths, and whether the tool slips.
  /// \throws InvalidInput as `reduce_model`, and if a contact states no error.
  explicit ErrorForecast(const Model& model, const ReduceOptions& needs = {});

  /// [N] With the contacts of the model.
  [[nodiscard]] double at_present() const { return present_.stated(); }

  /// [N] With other contacts instead.
  /// \param contacts [mm] places on the surface of the model, or near it; at least three.
  /// \throws InvalidInput or SolverError as `geometry::triangulate_contacts`.
  [[nodiscard]] double with(std::span<const Eigen::Vector3d> contacts) const {
    return budget_with(contacts).stated();
  }

  /// [N] The part that no further contact removes: that of the contacts themselves.
  [[nodiscard]] double of_contacts() const;

  /// The sources of the error with the contacts of the model.
  [[nodiscard]] const ErrorBudget& budget_at_present() const { return present_; }

  /// The sources of the error with other contacts; as `with`.
  [[nodiscard]] ErrorBudget budget_with(std::span<const Eigen::Vector3d> contacts) const;

  /// [N] RMS of the forces at the ends of the strokes.
  [[nodiscard]] double force() const { return force_; }

 private:
  struct Place {
    geometry::ClosestPoint at;
    double growing = 0;  ///< [N^2 mm^-2.5] for each unit of `geometry::error_growth`
  };

  geometry::TriangleMesh surface_;
  geometry::SurfaceQuery query_;
  geometry::ContactTriangulationMethod triangulation_;
  std::vector<Place> places_;
  ErrorBudget present_;
  double reach_ = 0;  ///< [mm^2] mean over the places
  double force_ = 0;
};

}  // namespace palpate::haptics
