// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "operations.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <string_view>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/geometry/contact_triangulation.h"

namespace palpate::extremes {
namespace {

/// As many contacts are of different stiffness; then they begin again.
constexpr std::ptrdiff_t kDifferent = 12;

}  // namespace

bool is_large() {
  const char* const size = std::getenv("PALPATE_EXTREMES");
  return size != nullptr && std::string_view(size) == "large";
}

void PrintTo(const Operation& operation, std::ostream* stream) { *stream << operation.name; }

const std::vector<Operation>& all_operations() {
  static const std::vector<Operation> all = [] {
    std::vector<Operation> listed;
    for (std::vector<Operation> part :
         {surface_operations(), cloud_operations(), scan_operations(), sensing_operations(),
          probing_operations(), haptics_operations()})
      std::move(part.begin(), part.end(), std::back_inserter(listed));
    return listed;
  }();
  return all;
}

const std::vector<Operation>& operations() {
  static const std::vector<Operation> chosen = [] {
    std::vector<Operation> of_this_size = all_operations();
    if (!is_large())
      std::erase_if(of_this_size, [](const Operation& one) { return one.only_large; });
    return of_this_size;
  }();
  return chosen;
}

std::vector<geometry::SurfacePoint> contacts_in_order(const Input& input) {
  if (input.contacts.empty()) throw InvalidInput("the operation needs a contact");
  std::vector<geometry::SurfacePoint> contacts = input.contacts;
  for (std::size_t i = 0; i < input.order.contacts.size(); ++i)
    contacts[i] = input.contacts[static_cast<std::size_t>(input.order.contacts[i])];
  return contacts;
}

haptics::Model model_of(const Input& input) {
  haptics::Model model;
  geometry::check_mesh(input.sheet, "surface");
  model.surface = input.sheet;
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(input.sheet);
  const Eigen::Vector3d along = input.place.linear() * Eigen::Vector3d::UnitY();
  for (std::size_t i = 0; i < input.contacts.size(); ++i) {
    const geometry::SurfacePoint& at = input.contacts[i];
    geometry::check_surface_point(input.sheet, at, "contact");
    // The same contact in any order.
    const auto& to = input.order.contacts;
    const auto is_here = [&](int place) { return place == static_cast<int>(i); };
    const auto number = to.empty() ? static_cast<long long>(i)
                                   : std::find_if(to.begin(), to.end(), is_here) - to.begin();
    haptics::ContactModel contact;
    contact.id = number;
    contact.position = geometry::position(input.sheet, at);
    contact.frame.col(2) = -normals.col(at.triangle);
    contact.frame.col(0) = along.cross(contact.frame.col(2)).normalized();
    contact.frame.col(1) = contact.frame.col(2).cross(contact.frame.col(0));
    contact.friction_axis = contact.frame.col(2);
    const double weight = (2 + 0.1 * static_cast<double>(number % kDifferent)) * input.force;
    contact.field.bases = {{weight, 4 * input.length},
                           {weight, 6 * input.length, Eigen::Vector3d::Zero(),
                            Eigen::Vector3d(0.1, 0.2, 1).normalized()}};
    contact.friction = 0.5;
    contact.friction_source = haptics::FrictionSource::samples;
    contact.samples = 20;
    contact.rms = 0.01 * input.force;
    model.contacts.push_back(std::move(contact));
  }
  geometry::ContactTriangulation found =
      geometry::triangulate_contacts(input.sheet, input.contacts);
  model.triangles = std::move(found.mesh.triangles);
  model.surface_weights = std::move(found.weights);
  return model;
}

const Change& no_change() {
  static const Change none = [](const FieldList&) {};
  return none;
}

Result number(std::string name, double value, Kind kind, double tolerance) {
  return {.name = std::move(name),
          .values = Eigen::MatrixXd::Constant(1, 1, value),
          .kind = kind,
          .tolerance = tolerance};
}

Result numbers(std::string name, const Eigen::Ref<const Eigen::VectorXd>& values, Kind kind,
               std::vector<int> Order::*elements, double tolerance) {
  return {.name = std::move(name),
          .values = values.transpose(),
          .kind = kind,
          .elements = elements,
          .tolerance = tolerance};
}

Result places(std::string name, const Eigen::Ref<const Eigen::Matrix3Xd>& values,
              std::vector<int> Order::*elements, double tolerance) {
  return {.name = std::move(name),
          .values = values,
          .kind = kLength,
          .motion = Motion::place,
          .elements = elements,
          .tolerance = tolerance};
}

Result vectors(std::string name, const Eigen::Ref<const Eigen::Matrix3Xd>& values, Kind kind,
               std::vector<int> Order::*elements, double tolerance) {
  return {.name = std::move(name),
          .values = values,
          .kind = kind,
          .motion = Motion::vector,
          .elements = elements,
          .tolerance = tolerance};
}

Result unknown_allowed(Result result) {
  result.may_be_unknown = true;
  return result;
}

Result stating(Result result, double error) {
  result.stated = error;
  return result;
}

Result saying(Result result, std::string_view words) {
  result.words = words;
  return result;
}

}  // namespace palpate::extremes
