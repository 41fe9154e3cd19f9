// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/contact_subset.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "build/surface_refinement.h"
#include "model/contact_places.h"
#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

// The three heaviest contacts of a place. The weight of the fourth one is subtracted, so that
// weights are continuous along the surface where it takes the place of the third.
void set_weights(const geometry::ContactWeights& at, Eigen::Index vertex,
                 geometry::SurfaceWeights& weights) {
  std::vector<std::pair<double, int>> heaviest;
  for (std::size_t k = 0; k < static_cast<std::size_t>(at.count); ++k)
    heaviest.emplace_back(at.weights[k], at.contacts[k]);
  std::ranges::sort(heaviest, std::greater());
  // If four have the same weight, any three will do.
  const bool has_fourth = heaviest.size() > 3 && heaviest[0].first > heaviest[3].first;
  const double fourth = has_fourth ? heaviest[3].first : 0;
  heaviest.resize(3, {0, -1});
  double sum = 0;
  for (auto& [weight, contact] : heaviest) sum += weight = std::max(0.0, weight - fourth);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto& [weight, contact] = heaviest[static_cast<std::size_t>(k)];
    weights.contacts(k, vertex) = weight > 0 ? contact : -1;
    weights.weights(k, vertex) = weight > 0 ? weight / sum : 0;
  }
}

}  // namespace

Model with_contacts(const Model& model, std::span<const std::size_t> kept) {
  Model result{.surface = model.surface,
               .contacts = {},
               .triangles = {},
               .triangulation = model.triangulation,
               .surface_weights = {},
               .interpolation = model.interpolation,
               .probe_radius = model.probe_radius,
               .friction_force = model.friction_force,
               .rate = model.rate,
               .made = model.made};
  for (const std::size_t i : kept) result.contacts.push_back(model.contacts[i]);
  geometry::ContactTriangulation triangulation = geometry::triangulate_contacts(
      model.surface, contact_places(result, geometry::SurfaceQuery(model.surface)),
      {.method = model.triangulation});
  result.triangles = std::move(triangulation.mesh.triangles);
  result.surface_weights = std::move(triangulation.weights);
  return result;
}

Model on_surface(Model model, const geometry::TriangleMesh& surface) {
  const geometry::SurfaceQuery before(model.surface), after(surface);
  const geometry::ContactLocator locator(model.surface, contact_places(model, before),
                                         vertex_weights(model));
  const double size = geometry::bounding_diagonal(surface);
  Eigen::Matrix3Xd inward(3, static_cast<Eigen::Index>(model.contacts.size()));
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    ContactModel& contact = model.contacts[i];
    contact.position = rounded_position(after.closest_point(contact.position).position, size);
    inward.col(static_cast<Eigen::Index>(i)) = contact.frame.col(2);
  }
  model.surface = surface;
  model.response.reset();
  static_cast<void>(refine_surface(inward, model));
  geometry::SurfaceWeights& weights = model.surface_weights;
  weights.contacts.resize(3, model.surface.vertices.cols());
  weights.weights.resize(3, model.surface.vertices.cols());
  for (Eigen::Index v = 0; v < model.surface.vertices.cols(); ++v)
    set_weights(locator.locate(before.closest_point(model.surface.vertices.col(v)).at), v, weights);
  return model;
}

}  // namespace palpate::haptics
