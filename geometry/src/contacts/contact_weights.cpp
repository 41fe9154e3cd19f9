// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "contacts/contact_weights.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <tuple>

#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// Limits of an edge's weight, where 1 is that of two right-angled triangles: a border edge may be
/// opposite an obtuse angle, and a needle may have an infinite cotangent.
constexpr double kLeastConductance = 1e-6;
constexpr double kLargestConductance = 1e6;

/// Largest number of contacts that determine a helper, and their smallest weight; contacts farther
/// away have almost none.
constexpr size_t kContactsOfHelper = 8;
constexpr double kLeastWeight = 1e-3;

double cotangent_opposite(const IntrinsicTriangulation& surface, int h) {
  const double c = surface.length(h);
  const double a = surface.length(IntrinsicTriangulation::next(h));
  const double b = surface.length(IntrinsicTriangulation::previous(h));
  // 0 / 0 of a degenerate triangle carries no information.
  const double area = area_of_lengths(a, b, c);
  return area > 0 ? (a * a + (b - c) * (b + c)) / (4 * area) : 0;
}

double conductance(const IntrinsicTriangulation& surface, int h) {
  double sum = cotangent_opposite(surface, h);
  if (surface.opposite(h) != kNone) {
    sum += cotangent_opposite(surface, surface.opposite(h));
  }
  return std::clamp(sum / 2, kLeastConductance, kLargestConductance);
}

bool is_larger(const ContactWeight& a, const ContactWeight& b) {
  return std::tie(b.weight, a.contact) < std::tie(a.weight, b.contact);
}

void normalise(WeightRow& row) {
  double sum = 0;
  for (const ContactWeight& entry : row) sum += entry.weight;
  for (ContactWeight& entry : row) entry.weight /= sum;
}

}  // namespace

std::vector<WeightRow> spread_weights(const IntrinsicTriangulation& surface,
                                      const std::vector<int>& contact_of_id) {
  std::vector<WeightRow> rows(static_cast<size_t>(surface.id_count()));
  std::vector<int> helpers;
  std::vector<int> index(rows.size(), -1);
  for (int id = 0; id < surface.id_count(); ++id) {
    const auto i = static_cast<size_t>(id);
    if (!surface.is_vertex(id)) continue;
    if (contact_of_id[i] >= 0) {
      rows[i] = {{.contact = contact_of_id[i], .weight = 1}};
    } else {
      index[i] = static_cast<int>(helpers.size());
      helpers.push_back(id);
    }
  }
  if (helpers.empty()) return rows;

  const auto count = static_cast<Eigen::Index>(helpers.size());
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Eigen::Triplet<double>> sources;  // row: helper, column: one of `near`
  std::vector<int> near;                        // contacts next to helpers
  std::vector<int> column(static_cast<size_t>(*std::ranges::max_element(contact_of_id)) + 1, -1);
  std::vector<int> fan;
  for (int row = 0; row < static_cast<int>(helpers.size()); ++row) {
    const int id = helpers[static_cast<size_t>(row)];
    surface.fan(id, fan);
    if (surface.is_boundary(id)) fan.push_back(IntrinsicTriangulation::previous(fan.back()));
    for (const int h : fan) {
      const int other = surface.from(h) == id ? surface.to(h) : surface.from(h);
      const double weight = conductance(surface, h);
      if (other == id) continue;
      entries.emplace_back(row, row, weight);
      const int contact = contact_of_id[static_cast<size_t>(other)];
      if (contact < 0) {
        entries.emplace_back(row, index[static_cast<size_t>(other)], -weight);
        continue;
      }
      int& its_column = column[static_cast<size_t>(contact)];
      if (its_column < 0) {
        its_column = static_cast<int>(near.size());
        near.push_back(contact);
      }
      sources.emplace_back(row, its_column, weight);
    }
  }
  Eigen::SparseMatrix<double> laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseMatrix<double> source(count, static_cast<Eigen::Index>(near.size()));
  source.setFromTriplets(sources.begin(), sources.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(laplacian);
  if (factors.info() != Eigen::Success) {
    throw SolverError(
        "triangulate_contacts: the weights of the helpers have no solution; use voronoi_dual");
  }
  const Eigen::MatrixXd weights = factors.solve(Eigen::MatrixXd(source));
  if (!weights.allFinite() || !(weights.rowwise().maxCoeff().array() > 0).all()) {
    throw SolverError(
        "triangulate_contacts: the weights of a helper are not finite or all 0; use voronoi_dual");
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    WeightRow& row = rows[static_cast<size_t>(helpers[static_cast<size_t>(i)])];
    // Keep the largest even if it is small, for example with a thousand contacts around a helper.
    const double least = std::min(kLeastWeight, weights.row(i).maxCoeff());
    for (Eigen::Index j = 0; j < weights.cols(); ++j) {
      if (weights(i, j) < least) continue;
      row.push_back({.contact = near[static_cast<size_t>(j)], .weight = weights(i, j)});
    }
    std::ranges::sort(row, is_larger);
    if (row.size() > kContactsOfHelper) row.resize(kContactsOfHelper);
    normalise(row);
  }
  return rows;
}

void reduce_to_three(WeightRow& row) {
  std::ranges::sort(row, {}, &ContactWeight::contact);
  size_t kept = 0;
  for (const ContactWeight& entry : row) {
    if (kept > 0 && row[kept - 1].contact == entry.contact) {
      row[kept - 1].weight += entry.weight;
    } else {
      row[kept++] = entry;
    }
  }
  row.resize(kept);
  std::ranges::sort(row, is_larger);
  if (row.size() > 3) {
    const double fourth = row[3].weight;
    row.resize(3);
    if (row[0].weight > fourth) {
      for (ContactWeight& entry : row) entry.weight -= fourth;
    }
  }
  std::erase_if(row, [](const ContactWeight& entry) { return !(entry.weight > 0); });
  normalise(row);
}

}  // namespace palpate::geometry
