// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model_io.h"

#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/output_file.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "palpate-model";
constexpr int kVersion = 2;
constexpr const char* kSurface = "surface.ply";
constexpr const char* kContacts = "contacts.ply";
constexpr const char* kDocument = "field.json";
constexpr const char* kBinaryDocument = "field.cbor";
constexpr std::array<const char*, 3> kFrictionSources = {"samples", "other_contacts", "none"};

json to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json to_json(const ContactModel& contact) {
  json centers = json::array(), weights = json::array();
  json ridges = json::array(), epsilons = json::array();
  for (const Multiquadric& base : contact.field.bases) {
    centers.push_back(to_json(base.center));
    ridges.push_back(to_json(base.ridge));
    weights.push_back(base.weight);
    epsilons.push_back(base.epsilon);
  }
  json axes = json::array();
  for (int axis = 0; axis < 3; ++axis)
    axes.push_back(to_json(Eigen::Vector3d(contact.frame.col(axis))));
  return {
      {"id", contact.id},
      {"position", to_json(contact.position)},
      {"axes", axes},
      {"field",
       {{"epsilons", epsilons}, {"centers", centers}, {"ridges", ridges}, {"weights", weights}}},
      {"friction",
       {{"coefficient", contact.friction},
        {"source", kFrictionSources[static_cast<std::size_t>(contact.friction_source)]},
        {"axis", to_json(contact.friction_axis)}}},
      {"fit", {{"samples", contact.samples}, {"rms", contact.rms}, {"stop", contact.fit_stop}}}};
}

json to_json(const geometry::SurfaceWeights& weights) {
  json contacts = json::array(), values = json::array();
  for (Eigen::Index i = 0; i < weights.contacts.size(); ++i) {
    contacts.push_back(weights.contacts.data()[i]);
    values.push_back(weights.weights.data()[i]);
  }
  return {{"contacts", contacts}, {"weights", values}};
}

json to_json(const Model& model) {
  json contacts = json::array(), triangles = json::array(), rows = json::array();
  for (const ContactModel& contact : model.contacts) contacts.push_back(to_json(contact));
  for (const auto& t : model.triangles.colwise()) triangles.push_back({t[0], t[1], t[2]});
  const Eigen::Matrix3d rotation = model.T_surface_acquisition.linear();
  for (int row = 0; row < 3; ++row) rows.push_back(to_json(Eigen::Vector3d(rotation.row(row))));
  json document = {
      {"format", kFormat},
      {"version", kVersion},
      {"units", {{"length", "mm"}, {"force", "N"}}},
      {"surface", kSurface},
      {"contacts", contacts},
      {"triangles", triangles},
      {"registration",
       {{"rotation", rows},
        {"translation", to_json(Eigen::Vector3d(model.T_surface_acquisition.translation()))}}},
      {"made", model.made}};
  if (model.surface_weights.contacts.cols() > 0) {
    document["surface_weights"] = to_json(model.surface_weights);
  }
  return document;
}

/// One value of the document, which knows where it stands.
class Node {
 public:
  Node(const json& value, std::string pointer) : value_(value), pointer_(std::move(pointer)) {}

  [[nodiscard]] Node at(const char* key) const {
    if (!value_.is_object()) refuse("an object");
    const auto found = value_.find(key);
    if (found == value_.end()) refuse(std::string("an object with the member \"") + key + "\"");
    return {*found, pointer_ + "/" + key};
  }
  [[nodiscard]] bool has(const char* key) const {
    return value_.is_object() && value_.contains(key);
  }
  [[nodiscard]] std::vector<Node> items() const {
    if (!value_.is_array()) refuse("an array");
    std::vector<Node> result;
    for (std::size_t i = 0; i < value_.size(); ++i) {
      result.emplace_back(value_[i], pointer_ + "/" + std::to_string(i));
    }
    return result;
  }
  [[nodiscard]] double number() const {
    if (!value_.is_number()) refuse("a number");
    return value_.get<double>();
  }
  [[nodiscard]] long long integer() const {
    if (!value_.is_number_integer()) refuse("a whole number");
    return value_.get<long long>();
  }
  [[nodiscard]] int contact_or_none() const {
    const long long value = integer();
    if (value < -1 || value > std::numeric_limits<int>::max())
      refuse("a whole number from -1 to 2147483647");
    return static_cast<int>(value);
  }
  [[nodiscard]] int small_integer() const {
    const long long value = integer();
    if (value < 0 || value > std::numeric_limits<int>::max())
      refuse("a whole number from 0 to 2147483647");
    return static_cast<int>(value);
  }
  [[nodiscard]] std::string text() const {
    if (!value_.is_string()) refuse("a string");
    return value_.get<std::string>();
  }
  [[nodiscard]] Eigen::Vector3d vector() const {
    const std::vector<Node> entries = items();
    if (entries.size() != 3) refuse("an array of three numbers");
    return {entries[0].number(), entries[1].number(), entries[2].number()};
  }
  [[nodiscard]] Eigen::Matrix3d rows() const {
    const std::vector<Node> entries = items();
    if (entries.size() != 3) refuse("an array of three arrays of three numbers");
    Eigen::Matrix3d result;
    for (int i = 0; i < 3; ++i) result.row(i) = entries[static_cast<std::size_t>(i)].vector();
    return result;
  }
  [[nodiscard]] std::map<std::string, std::string> texts() const {
    if (!value_.is_object()) refuse("an object of strings");
    std::map<std::string, std::string> result;
    for (const auto& [key, value] : value_.items()) {
      result[key] = Node(value, pointer_ + "/" + key).text();
    }
    return result;
  }
  [[noreturn]] void refuse(const std::string& right) const {
    constexpr std::size_t kShownLength = 40;
    std::string found = value_.dump(-1, ' ', true, json::error_handler_t::replace);
    if (found.size() > kShownLength) found = found.substr(0, kShownLength) + "...";
    throw InvalidInput("at " + (pointer_.empty() ? "the top" : pointer_) + ": found " + found +
                       ", expected " + right);
  }

 private:
  const json& value_;
  std::string pointer_;
};

FrictionSource friction_source(const Node& node) {
  const std::string word = node.text();
  for (std::size_t i = 0; i < kFrictionSources.size(); ++i) {
    if (word == kFrictionSources[i]) return static_cast<FrictionSource>(i);
  }
  node.refuse("\"samples\", \"other_contacts\" or \"none\"");
}

ForceField to_force_field(const Node& node) {
  const std::vector<Node> centers = node.at("centers").items(), ridges = node.at("ridges").items(),
                          weights = node.at("weights").items(),
                          epsilons = node.at("epsilons").items();
  const std::size_t count = weights.size();
  if (centers.size() != count || ridges.size() != count || epsilons.size() != count) {
    node.refuse("as many centers, ridges and epsilons as weights");
  }
  ForceField field;
  for (std::size_t k = 0; k < count; ++k) {
    field.bases.push_back(
        {weights[k].number(), epsilons[k].number(), centers[k].vector(), ridges[k].vector()});
  }
  return field;
}

ContactModel to_contact(const Node& node) {
  ContactModel contact;
  contact.id = node.at("id").integer();
  contact.position = node.at("position").vector();
  contact.frame = node.at("axes").rows().transpose();
  contact.field = to_force_field(node.at("field"));
  const Node friction = node.at("friction"), fit = node.at("fit");
  contact.friction = friction.at("coefficient").number();
  contact.friction_source = friction_source(friction.at("source"));
  contact.friction_axis = friction.at("axis").vector();
  contact.samples = fit.at("samples").small_integer();
  contact.rms = fit.at("rms").number();
  contact.fit_stop = fit.at("stop").text();
  return contact;
}

geometry::SurfaceWeights to_weights(const Node& node) {
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
    result.contacts.data()[i] = contacts[i].contact_or_none();
    result.weights.data()[i] = weights[i].number();
  }
  return result;
}

Model to_model(const Node& document) {
  if (document.at("format").text() != kFormat) {
    document.at("format").refuse(std::string("\"") + kFormat + "\"");
  }
  if (document.at("version").integer() != kVersion) {
    document.at("version").refuse(std::to_string(kVersion) +
                                  ", the version that this program reads");
  }
  Model model;
  for (const Node& contact : document.at("contacts").items())
    model.contacts.push_back(to_contact(contact));
  const std::vector<Node> triangles = document.at("triangles").items();
  model.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::vector<Node> corners = triangles[t].items();
    if (corners.size() != 3) triangles[t].refuse("three indices of contacts");
    for (int c = 0; c < 3; ++c) {
      model.triangles(c, static_cast<Eigen::Index>(t)) =
          corners[static_cast<std::size_t>(c)].small_integer();
    }
  }
  if (document.has("surface_weights")) {
    model.surface_weights = to_weights(document.at("surface_weights"));
  }
  const Node registration = document.at("registration");
  model.T_surface_acquisition.linear() = registration.at("rotation").rows();
  model.T_surface_acquisition.translation() = registration.at("translation").vector();
  model.made = document.at("made").texts();
  return model;
}

json parse(const std::filesystem::path& path, bool binary) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad()) throw FileError(path.string() + ": cannot be read");
  if (bytes.empty())
    throw FileError(path.string() + ": the file is empty; expected the model's field document");
  try {
    return binary ? json::from_cbor(bytes) : json::parse(bytes);
  } catch (const json::exception& error) {
    throw FileError(path.string() + ": not a whole " + (binary ? "CBOR" : "JSON") +
                    " document: " + error.what());
  }
}

}  // namespace

Model read_model(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw FileError(folder.string() + ": there is no such folder; expected a model folder with " +
                    kSurface + " and " + kDocument);
  }
  std::filesystem::path path = folder / kDocument;
  const bool binary = !std::filesystem::exists(path, error);
  if (binary) path = folder / kBinaryDocument;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw FileError(folder.string() + ": there is neither " + kDocument + " nor " +
                    kBinaryDocument + " in it; expected a model folder");
  }
  const json document = parse(path, binary);
  try {
    Model model = to_model(Node(document, ""));
    model.surface = geometry::read_mesh(folder / kSurface);
    check_model(model);
    return model;
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& wrong) {
    throw FileError(path.string() + ": " + wrong.what());
  }
}

std::vector<std::filesystem::path> model_entries() {
  return {kSurface, kContacts, kDocument, kBinaryDocument};
}

void write_model(const std::filesystem::path& folder, const Model& model) {
  check_model(model);
  write_folder(folder, model_entries(), [&](const std::filesystem::path& temporary) {
    geometry::write_mesh(temporary / kSurface, model.surface);
    // For other programs' eyes: it says what the document says.
    if (model.triangles.cols() > 0) {
      geometry::write_mesh(temporary / kContacts, contact_mesh(model));
    }
    constexpr int kIndent = 1;
    // JSON is UTF-8; the name of a file in `made` may be anything.
    const std::string document =
        to_json(model).dump(kIndent, ' ', false, json::error_handler_t::replace);
    write_file(temporary / kDocument, [&](std::ostream& out) { out << document << '\n'; });
  });
}

}  // namespace palpate::haptics
