// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/fit_surface_response.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/geometry/deformation_graph.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/deformed_shape.h"
#include "samples/nearest_contacts.h"

namespace palpate::haptics {
namespace {

// Share of the squared displacements with which responses keep to that of the direction that was
// displaced: it decides across, and changes what was measured by a thousandth.
constexpr double kPriorShare = 1e-3;

// Reach of dents in distances of a contact to the nearest one: beyond, the neighbours show how the
// surface moves.
constexpr double kDentReach = 2;
// Of the mean diagonal of the equations of a dent: places of which no vertex is near are taken from
// those beside them.
constexpr double kDentSmoothing = 1e-3;

constexpr int kPlaces = SurfaceResponse::kDentPlaces;
using DentMatrix = Eigen::Matrix<double, kPlaces, kPlaces>;
using DentVector = Eigen::Vector<double, kPlaces>;

// Sums over the shapes of one contact.
struct Sums {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();  // sum delta delta^T
  Eigen::MatrixXd products;                           // 3 N x 3: sum u delta^T, node by node
  // Least squares of the dent over all vertices.
  DentMatrix dent_matrix = DentMatrix::Zero();
  DentVector dent_vector = DentVector::Zero();
};

RecordedShape checked(RecordedShape shape, const Model& model, std::size_t k) {
  const std::string name = "fit_surface_response(): shape " + std::to_string(k);
  if (shape.contact >= model.contacts.size()) {
    throw InvalidInput(name + " is of contact " + std::to_string(shape.contact) + "; there are " +
                       std::to_string(model.contacts.size()));
  }
  if (shape.vertices.cols() != model.surface.vertices.cols()) {
    throw InvalidInput(name + " has " + std::to_string(shape.vertices.cols()) +
                       " vertices; the model's surface has " +
                       std::to_string(model.surface.vertices.cols()));
  }
  if (!shape.vertices.allFinite() || !shape.displacement.allFinite())
    throw InvalidInput(name + " has a vertex or a displacement that is not finite");
  return shape;
}

// The vertex that follows each node most.
std::vector<Eigen::Index> node_vertices(const geometry::DeformationGraph& graph) {
  std::vector<Eigen::Index> vertices(static_cast<std::size_t>(graph.nodes().cols()), 0);
  std::vector<double> most(vertices.size(), -1);
  for (Eigen::Index v = 0; v < graph.weights().cols(); ++v) {
    for (Eigen::Index k = 0; k < graph.weights().rows(); ++k) {
      const auto node = static_cast<std::size_t>(graph.influences()(k, v));
      if (graph.weights()(k, v) <= most[node]) continue;
      most[node] = graph.weights()(k, v);
      vertices[node] = v;
    }
  }
  return vertices;
}

// Distances along the surface from the contact that was asked for last.
class Distances {
 public:
  Distances(const Model& model, const BlendedField& field, double reach)
      : model_(model), surface_(model.surface), field_(field), reach_(reach) {}

  const Eigen::VectorXd& from(std::size_t contact) {
    if (contact_ == contact) return distances_;
    contact_ = contact;
    const geometry::SurfacePoint place =
        field_.surface().closest_point(model_.contacts[contact].position).at;
    distances_ =
        geometry::geodesic_distance(surface_, {&place, 1}, {.stop_radius = reach_}).distance;
    return distances_;
  }

 private:
  const Model& model_;
  geometry::GeodesicSurface surface_;
  const BlendedField& field_;
  double reach_;
  std::optional<std::size_t> contact_;
  Eigen::VectorXd distances_;
};

// Median distance of a contact to the nearest other one on the same side of the object.
double contact_spacing(const Model& model) {
  std::vector<PressedContact> contacts(model.contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts[i].position = model.contacts[i].position;
    contacts[i].direction = pressing_frame(model.contacts[i]).col(2);
  }
  std::vector<double> nearest;
  for (const std::vector<std::size_t>& near : nearest_contacts(contacts, 1)) {
    if (near.size() > 1)
      nearest.push_back((contacts[near[1]].position - contacts[near[0]].position).norm());
  }
  return nearest.empty() ? geometry::bounding_diagonal(model.surface) : median(nearest);
}

// Adds the vertices of a shape to the equations of its contact's dent.
void add_dent(const RecordedShape& shape, const Eigen::Matrix3Xd& rest,
              const Eigen::VectorXd& distances, double reach, Sums& sums) {
  const double square = shape.displacement.squaredNorm();
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    const double place = distances[v] / reach * kPlaces;
    if (!(place < kPlaces)) continue;
    const auto before = static_cast<int>(place);
    const double share = place - before;
    const double moved = (shape.vertices.col(v) - rest.col(v)).dot(shape.displacement);
    sums.dent_matrix(before, before) += (1 - share) * (1 - share) * square;
    sums.dent_vector[before] += (1 - share) * moved;
    if (before + 1 == kPlaces) continue;  // the dent ends there
    sums.dent_matrix(before, before + 1) += share * (1 - share) * square;
    sums.dent_matrix(before + 1, before) += share * (1 - share) * square;
    sums.dent_matrix(before + 1, before + 1) += share * share * square;
    sums.dent_vector[before + 1] += share * moved;
  }
}

DentVector dent_of(const Sums& sums) {
  // Second differences, with 0 beyond the last place.
  DentMatrix bends = DentMatrix::Zero();
  for (int k = 1; k < kPlaces; ++k) {
    DentVector bend = DentVector::Zero();
    bend[k - 1] = 1;
    bend[k] = -2;
    if (k + 1 < kPlaces) bend[k + 1] = 1;
    bends += bend * bend.transpose();
  }
  const double scale = kDentSmoothing * sums.dent_matrix.trace() / kPlaces;
  return (sums.dent_matrix + scale * bends).ldlt().solve(sums.dent_vector);
}

// The response of each node beside the dent.
Eigen::Matrix<Eigen::half, Eigen::Dynamic, 1> responses_of(const Sums& sums,
                                                           const Eigen::VectorXd& dents_at_nodes) {
  const double total = sums.squares.trace(), prior = kPriorShare * total;
  const Eigen::LDLT<Eigen::Matrix3d> factor(sums.squares + prior * Eigen::Matrix3d::Identity());
  Eigen::Matrix<Eigen::half, Eigen::Dynamic, 1> responses(3 * sums.products.rows());
  for (Eigen::Index n = 0; n < sums.products.rows() / 3; ++n) {
    const Eigen::Matrix3d product =
        sums.products.middleRows<3>(3 * n) - dents_at_nodes[n] * sums.squares;
    const double along = product.trace() / total;
    const Eigen::Matrix3d response =
        factor.solve((product + prior * along * Eigen::Matrix3d::Identity()).transpose())
            .transpose();
    responses.segment<9>(9 * n) = response.reshaped().cast<Eigen::half>();
  }
  return responses;
}

// Distances of vertices.
class Errors {
 public:
  void add(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
    const Eigen::VectorXd squares = (a - b).colwise().squaredNorm();
    sum_ += squares.mean();
    largest_ = std::max(largest_, squares.maxCoeff());
    ++count_;
  }
  [[nodiscard]] double rms() const { return std::sqrt(sum_ / count_); }
  [[nodiscard]] double largest() const { return std::sqrt(largest_); }

 private:
  double sum_ = 0, largest_ = 0;
  int count_ = 0;
};

geometry::SurfacePoint place_of(const BlendedField& field, const ContactModel& contact) {
  return field.surface().closest_point(contact.position).at;
}

}  // namespace

SurfaceResponse fit_surface_response(const Model& model, std::size_t count,
                                     const std::function<RecordedShape(std::size_t)>& shape,
                                     const SurfaceResponseOptions& options) {
  require("SurfaceResponseOptions::nodes", options.nodes,
          at_least(1).at_most(std::numeric_limits<std::uint16_t>::max()));
  if (count == 0) throw InvalidInput("fit_surface_response(): there is no recorded shape");
  const BlendedField field(model);
  const geometry::DeformationGraph graph(model.surface, {.nodes = options.nodes});
  const std::vector<Eigen::Index> at_nodes = node_vertices(graph);
  const Eigen::Matrix3Xd& rest = model.surface.vertices;

  SurfaceResponse response;
  response.reach = kDentReach * contact_spacing(model);
  Distances distances(model, field, response.reach);
  std::vector<Sums> sums(model.contacts.size());
  const auto shapes = static_cast<Eigen::Index>(count);
  response.shape_contacts.resize(shapes);
  response.displacements.resize(Eigen::NoChange, shapes);
  Eigen::MatrixXd moves(3 * graph.nodes().cols(), shapes);
  for (std::size_t k = 0; k < count; ++k) {
    const RecordedShape recorded = checked(shape(k), model, k);
    Sums& of_contact = sums[recorded.contact];
    const Eigen::Matrix3Xd moved = (recorded.vertices - rest)(Eigen::all, at_nodes);
    const auto column = static_cast<Eigen::Index>(k);
    response.shape_contacts[column] = static_cast<int>(recorded.contact);
    response.displacements.col(column) = recorded.displacement.cast<float>();
    moves.col(column) = moved.reshaped();
    if (of_contact.products.size() == 0) of_contact.products.setZero(moved.size(), 3);
    of_contact.squares += recorded.displacement * recorded.displacement.transpose();
    of_contact.products += moved.reshaped() * recorded.displacement.transpose();
    add_dent(recorded, rest, distances.from(recorded.contact), response.reach, of_contact);
  }

  response.nodes = graph.influences().cast<std::uint16_t>();
  response.weights = graph.weights().cast<Eigen::half>();
  response.responses.setZero(9 * graph.nodes().cols(), static_cast<Eigen::Index>(sums.size()));
  response.dents.setZero(kPlaces, static_cast<Eigen::Index>(sums.size()));
  Eigen::MatrixXd dents_at_nodes =
      Eigen::MatrixXd::Zero(graph.nodes().cols(), static_cast<Eigen::Index>(sums.size()));
  bool displaced = false;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (!(sums[c].squares.trace() > 0)) continue;
    const auto column = static_cast<Eigen::Index>(c);
    response.dents.col(column) = dent_of(sums[c]).cast<Eigen::half>();
    dents_at_nodes.col(column) = distances.from(c)(at_nodes).unaryExpr(
        [&](double d) { return dent_at(response, column, d); });
    response.responses.col(column) = responses_of(sums[c], dents_at_nodes.col(column));
    displaced = true;
  }
  if (!displaced) {
    throw InvalidInput("fit_surface_response(): none of the " + std::to_string(count) +
                       " recorded shapes is displaced");
  }
  for (Eigen::Index s = 0; s < shapes; ++s) {
    const Eigen::VectorXd dents = dents_at_nodes.col(response.shape_contacts[s]);
    const Eigen::Vector3d displacement = response.displacements.col(s).cast<double>();
    moves.col(s) -= (displacement * dents.transpose()).reshaped();
  }
  response.moves = moves.cast<Eigen::half>();

  Errors shown, kept;
  const geometry::GeodesicSurface surface(model.surface);
  for (std::size_t k = 0; k < count; ++k) {
    const RecordedShape recorded = checked(shape(k), model, k);
    const geometry::SurfacePoint place = place_of(field, model.contacts[recorded.contact]);
    shown.add(recorded.vertices, measured_shape(surface, response, field.weights(place), place,
                                                recorded.displacement, shape_options(model)));
    kept.add(recorded.vertices,
             recorded_shape(surface, response, place, static_cast<Eigen::Index>(k)));
  }
  response.rms = shown.rms();
  response.largest = shown.largest();
  response.kept_rms = kept.rms();
  response.kept_largest = kept.largest();
  return response;
}

}  // namespace palpate::haptics
