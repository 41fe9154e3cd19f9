// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/haptics/model.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// The force that a model should give for a displacement at a place of its surface.
struct Query {
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();       ///< [mm] on the undeformed surface
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm] tool minus contact
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< [N] of the tool ON THE OBJECT
};

/// Reads a CSV file (see probing/csv.h) with the columns `cx,cy,cz,dx,dy,dz,fx,fy,fz`: contact,
/// displacement and force.
///
/// \throws FileError naming the line and column, or if there is no row.
[[nodiscard]] std::vector<Query> read_queries(const std::filesystem::path& path);

/// Comparison of the errors with those that a model states (`BlendedField::deviation`).
struct StatedErrors {
  double rms = 0;  ///< [N] root mean square of the stated errors
  /// RMS of the errors, each relative to the stated one: 1 if they are stated correctly
  double ratio = 0;
};

/// Statistics of the lengths |model - query| of the force errors [N].
struct QueryErrors {
  int count = 0;
  double rms = 0;     ///< sqrt(mean |error|^2)
  double median = 0;  ///< quantiles are interpolated linearly
  double p90 = 0;
  std::optional<StatedErrors> stated = std::nullopt;  ///< if the model states errors
  /// Share of the squared forces that the model explains, 1 - sum |error|^2 / sum |force|^2; none
  /// if all forces are zero.
  std::optional<double> explained = std::nullopt;
  /// Factor of the model's forces with which the errors would be least, and the share explained
  /// then: a factor far from 1 with a large share means that the queries have other signs or units.
  /// None where `explained` is none, or if all forces of the model are zero.
  std::optional<double> scale = std::nullopt;
  std::optional<double> explained_if_scaled = std::nullopt;
};

/// `visit` describes the fields.
struct QueryOptions {
  double max_distance = 2;
};

void visit(QueryOptions& options, FieldVisitor& visitor);

/// Compares a model with known forces at places of its surface.
///
/// \throws InvalidInput if there is no query, if a query is not finite or further than max_distance
/// from the surface (naming its index), or if `check_model` throws.
[[nodiscard]] QueryErrors evaluate_queries(const Model& model, std::span<const Query> queries,
                                           const QueryOptions& options = {});

struct ContactError {
  long long contact = 0;  ///< id
  double rms = 0;         ///< [N] sqrt(mean |error|^2) over the samples of the contact
  int samples = 0;
  bool at_border = false;  ///< at the border of the triangulation: predicted from one side only
  /// [N] disagreement of the neighbours: sqrt(mean sum_k w_k |f_k - f|^2) over the samples, where
  /// f_k is the force of the field of neighbour k alone, and w_k its weight
  double spread = 0;
  /// [N] standard deviation of the normal force, at the reference displacement or on average of a
  /// press to the reference depth, that kriging of the neighbours' compliances or strengths
  /// expects; only where neighbours have one
  std::optional<double> expected = std::nullopt;
  /// With the noise of the samples; if the model states errors.
  std::optional<StatedErrors> stated = std::nullopt;
};

/// A place where one more contact would reduce the error most.
struct SuggestedContact {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] a vertex of the surface
  /// [N] as `ContactError::expected`, scaled by how those compare with `rms`
  double expected = 0;
};

struct LeaveOneOut {
  double rms = 0;  ///< [N] sqrt(mean |error|^2) over all samples of all contacts
  std::optional<double>
      interior_rms;                  ///< [N] over the contacts not at the border, if there are any
  std::optional<double> border_rms;  ///< [N] over those at the border, if there are any
  /// With the noise of the samples; if the model states errors.
  std::optional<StatedErrors> stated = std::nullopt;
  std::vector<ContactError> per_contact;  ///< in the order of the model's contacts
  /// The places with the largest expected errors, at least half the spacing of contacts apart from
  /// each other and from contacts, and at most that far from the triangles of contacts.
  std::vector<SuggestedContact> suggested;
};

/// `visit` describes the fields.
struct LeaveOneOutOptions {
  int suggestions = 5;
  /// Called after each contact with the number of contacts done and in all, from one thread at a
  /// time.
  std::function<void(int done, int total)> progress = {};
};

void visit(LeaveOneOutOptions& options, FieldVisitor& visitor);

/// Predicts the samples of each contact from the other contacts (thesis 5.3.3) and compares the
/// prediction with the measurement. If the model depends on the rate, its part of the measured
/// forces, by the contact's own field, is subtracted first. For each contact, the others are
/// triangulated without it, as in `LeftOutModels`, and their compliances or strengths are learnt
/// again. Values estimated from all contacts together stay: the offsets, the noise and the
/// smoothing of curves of contacts that were only pressed, and the stated errors between contacts.
/// Errors are therefore somewhat smaller than those of a model that was fitted without the
/// contact.
///
/// \throws InvalidInput if a contact of the model is missing, at another place or without samples
/// in the acquisition, if the model was fitted to other samples or does not say to which (it was
/// scaled, transferred or merged), if the model has fewer than four contacts, or if `check_model`
/// throws.
[[nodiscard]] LeaveOneOut leave_one_out(const Model& model,
                                        const probing::CheckedAcquisition& acquisition,
                                        const LeaveOneOutOptions& options = {});

}  // namespace palpate::haptics
