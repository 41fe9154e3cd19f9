// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <utility>

#include "model/document_node.h"
#include "model/field_document.h"
#include "model/field_document_format.h"
#include "model/stored_form.h"
#include "palpate/error.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;
using Node = DocumentNode;

constexpr int kMaxInt = std::numeric_limits<int>::max();

// Walks through a document and keeps nothing, but ends where it is nested deeper than any of ours:
// nlohmann's functions for CBOR and for printing call themselves at each level.
class NestingCheck : public nlohmann::json_sax<json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return enter(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  // What is wrong is said when it is parsed.
  bool parse_error(std::size_t, const std::string&, const json::exception&) override {
    return false;
  }

  [[nodiscard]] bool too_deep() const { return depth_ > kMaxDepth; }

 private:
  static constexpr int kMaxDepth = 32;  // ours have 5

  bool enter() {
    ++depth_;
    return !too_deep();
  }
  bool leave() {
    --depth_;
    return true;
  }

  int depth_ = 0;
};

json parse(const std::string& bytes, ModelEncoding encoding) {
  const bool is_text = encoding == ModelEncoding::json;
  const char* name = is_text ? "JSON" : "CBOR";
  if (bytes.empty()) throw InvalidInput("the file is empty; expected the model's field document");
  try {
    NestingCheck nesting;
    json::sax_parse(bytes, &nesting,
                    is_text ? json::input_format_t::json : json::input_format_t::cbor);
    if (nesting.too_deep())
      throw InvalidInput(std::string("its lists are nested too deeply for a field document in ") +
                         name);
    return is_text ? json::parse(bytes) : json::from_cbor(bytes);
  } catch (const json::exception& error) {
    throw InvalidInput(std::string("not a whole ") + name + " document: " + error.what());
  }
}

Eigen::Vector3d unit_vector_of_version_2(const Node& node) {
  const Eigen::Vector3d result = node.vector();
  if (!(std::abs(result.norm() - 1) <= kFrameTolerance)) node.refuse("a unit vector");
  return result;
}

ForceField to_field_of_version_1(const Node& node) {
  const std::vector<Node> centers = node.at("centers").items(),
                          weights = node.at("weights").items();
  if (centers.size() != weights.size()) node.at("centers").refuse("as many centers as weights");
  const double epsilon = node.at("epsilon").number_above_zero();
  ForceField field;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    field.bases.push_back({weights[k].number(), epsilon, centers[k].vector()});
  }
  return field;
}

// The numbers of a list of N.
template <std::size_t N>
std::array<Node, N> numbers(const Node& node, const char* right) {
  const std::vector<Node> items = node.items();
  if (items.size() != N) node.refuse(right);
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<Node, N>{items[I]...};
  }
  (std::make_index_sequence<N>());
}

Multiquadric to_base_of_version_2(const Node& node) {
  const auto of =
      numbers<8>(node, "eight numbers: weight, epsilon, three of the center, three of the ridge");
  const Multiquadric base{of[0].number(),
                          of[1].number_above_zero(),
                          {of[2].number(), of[3].number(), of[4].number()},
                          {of[5].number(), of[6].number(), of[7].number()}};
  if (!base.ridge.isZero(0) && !(std::abs(base.ridge.norm() - 1) <= kRidgeTolerance)) {
    node.refuse("the last three numbers to be a unit vector, or zeros");
  }
  return base;
}

ForceField to_field_of_version_2(const Node& node) {
  ForceField field;
  for (const Node& base : node.items()) field.bases.push_back(to_base_of_version_2(base));
  return field;
}

Multiquadric to_base(const Node& node) {
  const auto of = numbers<5>(node, "five numbers: weight, epsilon, three of the center");
  return {
      of[0].number(), of[1].number_above_zero(), {of[2].number(), of[3].number(), of[4].number()}};
}

Multiquadric ridge_of(const Node& node) {
  const auto of = numbers<5>(node, "five numbers: weight, offset, three of the slope");
  const StoredRidge ridge{
      of[0].number(), of[1].number(), {of[2].number(), of[3].number(), of[4].number()}};
  // Its epsilon, the inverse, would be beyond all numbers of a document.
  if (!(ridge.slope.stableNorm() >= 1 / kLargestNumber))
    node.refuse("the last three numbers to be a vector of a length of at least 1e-12");
  return to_ridge(ridge);
}

ForceField to_field(const Node& contact, long long version) {
  if (version == 1) return to_field_of_version_1(contact.at("field"));
  if (version == 2) return to_field_of_version_2(contact.at("bases"));
  ForceField field;
  for (const Node& base : contact.at("bases").items()) field.bases.push_back(to_base(base));
  for (const Node& ridge : contact.at("ridges").items()) field.bases.push_back(ridge_of(ridge));
  return field;
}

Eigen::Matrix3d to_frame_of_version_2(const Node& axes) {
  const Eigen::Matrix3d frame = axes.rows().transpose();
  if (!is_rotation(frame, kFrameTolerance))
    axes.refuse("three orthogonal unit vectors, right-handed");
  return frame;
}

Eigen::Matrix3d frame_of(const Node& node) {
  const auto of = numbers<4>(node, "four numbers of a quaternion: w, x, y, z");
  const Eigen::Vector4d quaternion(of[0].number(), of[1].number(), of[2].number(), of[3].number());
  if (quaternion.isZero(0)) node.refuse("four numbers that are not all zero");
  return to_frame(quaternion);
}

Eigen::Vector3d to_unit_vector(const Node& node) {
  const Eigen::Vector3d direction = node.vector();
  if (direction.isZero(0)) node.refuse("three numbers that are not all zero");
  return to_direction(direction).normalized();
}

Interpolation to_interpolation(const Node& node) {
  return {static_cast<BlendRule>(node.at("rule").choice(kBlendRules)),
          node.at("reference_force").number_at_least_zero(), 0};
}

ContactModel to_contact(const Node& node, long long version) {
  ContactModel contact;
  contact.id = node.at("id").integer();
  contact.position = node.at("position").vector();
  const bool is_old = version <= 2;
  contact.frame = is_old ? to_frame_of_version_2(node.at("axes")) : frame_of(node.at("rotation"));
  contact.field = to_field(node, version);
  const Node friction = node.at("friction"), fit = node.at("fit");
  contact.friction = friction.at("coefficient").number_at_least_zero();
  contact.friction_source =
      static_cast<FrictionSource>(friction.at("source").choice(kFrictionSources));
  contact.friction_axis =
      is_old ? unit_vector_of_version_2(friction.at("axis")) : to_unit_vector(friction.at("axis"));
  if (const auto error = friction.find(is_old ? "standard_error" : "error"))
    contact.friction_error = error->number_at_least_zero();
  if (const auto bound = friction.find("lower_bound"))
    contact.friction_lower_bound = bound->number_at_least_zero();
  contact.samples = fit.at("samples").integer_between(0, kMaxInt);
  contact.rms = fit.at("rms").number_at_least_zero();
  contact.fit_stop = fit.at("stop").text();
  if (const auto mode = fit.find("mode")) contact.fit_mode = mode->text();
  if (!is_old) contact.passivity = contact.fit_mode;
  if (const auto passivity = fit.find("passivity")) contact.passivity = passivity->text();
  if (const auto chi2 = fit.find("chi2")) contact.chi2 = chi2->number_at_least_zero();
  if (const auto floor = fit.find("noise_floor"))
    contact.noise_floor = floor->number_at_least_zero();
  if (const auto condition = fit.find("condition"))
    contact.condition = condition->number_at_least_zero();
  if (const auto shared = fit.find("shared_local")) contact.shared_local = shared->truth();
  return contact;
}

std::vector<ContactModel> to_contacts(const Node& node, long long version) {
  const std::vector<Node> items = node.items();
  if (items.size() < 3) node.refuse("at least three contacts");
  std::vector<ContactModel> contacts;
  contacts.reserve(items.size());
  std::unordered_map<long long, std::size_t> places;
  for (const Node& item : items) {
    contacts.push_back(to_contact(item, version));
    const auto [place, is_new] = places.emplace(contacts.back().id, contacts.size() - 1);
    if (is_new) continue;
    item.at("id").refuse("an id of its own; contact " + std::to_string(place->second) +
                         " has this one");
  }
  return contacts;
}

Eigen::Matrix3Xi to_triangles(const Node& node, int contacts) {
  const std::vector<Node> items = node.items();
  Eigen::Matrix3Xi triangles(3, static_cast<Eigen::Index>(items.size()));
  for (std::size_t t = 0; t < items.size(); ++t) {
    const std::vector<Node> corners = items[t].items();
    if (corners.size() != 3) items[t].refuse("three indices of contacts");
    for (std::size_t c = 0; c < 3; ++c) {
      triangles(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(t)) =
          corners[c].integer_between(0, contacts - 1);
    }
  }
  return triangles;
}

geometry::SurfaceWeights to_weights_of_version_1(const Node& node, int contact_count) {
  const std::vector<Node> contacts = node.at("contacts").items(),
                          weights = node.at("weights").items();
  if (contacts.size() != weights.size() || contacts.size() % 3 != 0) {
    node.refuse("three contacts and three weights for each vertex of the surface");
  }
  geometry::SurfaceWeights result;
  const auto count = static_cast<Eigen::Index>(contacts.size() / 3);
  result.contacts.resize(3, count);
  result.weights.resize(3, count);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    result.contacts.data()[i] = contacts[i].integer_between(-1, contact_count - 1);
    result.weights.data()[i] = weights[i].number_at_least_zero();
  }
  return result;
}

long long to_version(const Node& document) {
  document.at("format").expect_text(kFieldFormat);
  const Node node = document.at("version");
  const long long version = node.integer();
  if (version >= 1 && version <= kFieldVersion) return version;
  const std::string known = "1 to " + std::to_string(kFieldVersion);
  if (version < 1) node.refuse(known);
  std::string program = "a newer palpate";
  const auto made = document.find("made");
  if (const auto by = made ? made->find("program") : std::nullopt) program = by->text();
  node.refuse(known + ", the versions that this program reads: the model was made by " + program +
              ", which is needed to read it");
}

FieldDocument to_document(const Node& document) {
  const long long version = to_version(document);
  document.at("units").at("length").expect_text("mm");
  document.at("units").at("force").expect_text("N");
  document.at("surface").expect_text(kSurfaceFile);
  FieldDocument result;
  Model& model = result.model;
  model.contacts = to_contacts(document.at("contacts"), version);
  const auto contact_count = static_cast<int>(model.contacts.size());
  model.triangles = to_triangles(document.at("triangles"), contact_count);
  if (const auto weights = document.find("surface_weights")) {
    result.weights_in_surface = version > 1;
    if (version > 1)
      weights->expect_text(kSurfaceFile);
    else
      model.surface_weights = to_weights_of_version_1(*weights, contact_count);
  }
  if (const auto between = document.find("interpolation"))
    model.interpolation = to_interpolation(*between);
  const Node registration = document.at("registration");
  model.T_surface_acquisition.linear() = registration.at("rotation").rows();
  if (!is_rotation(model.T_surface_acquisition.linear(), kFrameTolerance)) {
    registration.at("rotation").refuse("a rotation");
  }
  model.T_surface_acquisition.translation() = registration.at("translation").vector();
  model.made = document.at("made").texts();
  return result;
}

}  // namespace

FieldDocument read_field_document(const std::string& bytes, ModelEncoding encoding) {
  const json document = parse(bytes, encoding);
  return to_document(DocumentNode(document));
}

}  // namespace palpate::haptics
