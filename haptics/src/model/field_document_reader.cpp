// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>
#include <utility>

#include "model/document_contact.h"
#include "model/field_document.h"
#include "model/field_document_format.h"
#include "palpate/core/error.h"
#include "palpate/documents/document_node.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

using documents::refuse;
using Document = documents::Document;
using Node = documents::DocumentNode;
using json = documents::Json;

constexpr int kMaxInt = std::numeric_limits<int>::max();

Interpolation to_interpolation(const Node& node) {
  Interpolation result{.rule = choice(node.at("rule"), kBlendRules)};
  if (result.rule == BlendRule::compliances) {
    result.reference_force = node.at("reference_force").number_above_zero();
  } else if (const auto depth = node.find("reference_depth")) {
    result.reference_depth = depth->number_above_zero();
  } else {
    return result;
  }
  result.reach = node.at("reach").number_at_least_zero();
  return result;
}

std::vector<RateTerm> to_rate(const Node& node) {
  std::vector<RateTerm> rate;
  for (const Node& term : node.items()) {
    rate.push_back({.share = term.at("share").number_above_zero(),
                    .time = term.at("time").number_above_zero()});
  }
  if (rate.size() > DelayedDisplacements::kMost) node.refuse("at most two terms");
  return rate;
}

std::string to_fingerprint(const Node& node) {
  if (!is_fingerprint(node.text())) node.refuse("16 hexadecimal digits in lower case");
  return node.text();
}

PressingOffsets to_offsets(const Node& node) {
  PressingOffsets offsets;
  offsets.force_found = node.at("force_found").truth();
  offsets.force = node.at("force_offset").vector();
  const std::vector<Node> errors = node.at("force_offset_error").items();
  if (errors.size() != 3) node.at("force_offset_error").refuse("three numbers >= 0");
  for (std::size_t i = 0; i < 3; ++i)
    offsets.force_error(static_cast<Eigen::Index>(i)) = errors[i].number_at_least_zero();
  offsets.along_direction = node.at("along_pressing").truth();
  offsets.touch_found = node.at("touch_found").truth();
  offsets.touch = node.at("touch_offset").number();
  offsets.touch_error = node.at("touch_offset_error").number_at_least_zero();
  offsets.touch_spread = node.at("touch_offset_spread").number_at_least_zero();
  offsets.height_slope = node.at("surface_slope").number();
  offsets.height_slope_error = node.at("surface_slope_error").number_at_least_zero();
  offsets.hysteresis = node.at("hysteresis").number();
  if (!(offsets.hysteresis < 1)) node.at("hysteresis").refuse("a number < 1");
  offsets.hysteresis_error = node.at("hysteresis_error").number_at_least_zero();
  return offsets;
}

std::string pointer_to(const char* list, std::size_t index) {
  return std::string("/") + list + "/" + std::to_string(index);
}

// Collects contacts and triangles as they are parsed. An error is kept until `take`, because the
// document may state further on that it has another version, which explains it.
class Lists {
 public:
  static constexpr const char* kContacts = "contacts";
  static constexpr const char* kTriangles = "triangles";

  [[nodiscard]] static bool has(const std::string& key) {
    return key == kContacts || key == kTriangles;
  }

  void begin(const std::string& key) {
    if (key == kContacts) {
      contacts_.emplace();
      index_of_.clear();
    } else {
      triangles_.emplace();
    }
  }

  void add(const std::string& key, json value) {
    if (!error_.empty()) return;
    try {
      if (key == kContacts)
        add_contact({std::move(value), pointer_to(kContacts, contacts_->size())});
      else
        add_triangle({std::move(value), pointer_to(kTriangles, triangles_->size())});
    } catch (const InvalidInput& wrong) {
      error_ = wrong.what();
    }
  }

  // Moves the lists into the model. `document` has all other members.
  void take(const Node& document, Model& model) {
    if (!error_.empty()) throw InvalidInput(error_);
    if (!contacts_) static_cast<void>(document.at(kContacts).items());
    if (!triangles_) static_cast<void>(document.at(kTriangles).items());
    const std::size_t count = contacts_->size();
    if (count < 3)
      refuse("/contacts", "an array of " + std::to_string(count), "at least three contacts");
    model.contacts = std::move(*contacts_);
    model.triangles.resize(3, static_cast<Eigen::Index>(triangles_->size()));
    for (std::size_t t = 0; t < triangles_->size(); ++t) {
      const Eigen::Vector3i& corners = (*triangles_)[t];
      for (int c = 0; c < 3; ++c) {
        if (corners[c] < static_cast<int>(count)) continue;
        refuse(pointer_to(kTriangles, t) + "/" + std::to_string(c), std::to_string(corners[c]),
               "a whole number from 0 to " + std::to_string(count - 1));
      }
      model.triangles.col(static_cast<Eigen::Index>(t)) = corners;
    }
  }

 private:
  void add_contact(const Document& part) {
    const Node node(part);
    ContactModel contact = to_contact(node);
    const auto [other, is_new] = index_of_.emplace(contact.id, contacts_->size());
    if (!is_new) {
      node.at("id").refuse("an id of its own; contact " + std::to_string(other->second) +
                           " has this one");
    }
    contacts_->push_back(std::move(contact));
  }

  void add_triangle(const Document& part) {
    const std::vector<Node> corners = Node(part).items();
    if (corners.size() != 3) Node(part).refuse("three indices of contacts");
    Eigen::Vector3i& triangle = triangles_->emplace_back();
    for (std::size_t c = 0; c < 3; ++c)
      triangle[static_cast<Eigen::Index>(c)] = corners[c].integer_between(0, kMaxInt);
  }

  std::optional<std::vector<ContactModel>> contacts_;
  std::optional<std::vector<Eigen::Vector3i>> triangles_;
  std::unordered_map<long long, std::size_t> index_of_;  ///< of the contact of an id
  std::string error_;                                    ///< the first; empty = none
};

// Handles the events of nlohmann's parser. Only one item of the long lists is in memory as JSON at
// a time, because 1e5 contacts as a whole would take gigabytes, and more time than everything else.
class DocumentHandler : public nlohmann::json_sax<json> {
 public:
  explicit DocumentHandler(Lists& lists) : lists_(lists) {}

  bool null() override { return take(nullptr); }
  bool boolean(bool value) override { return take(value); }
  bool number_integer(number_integer_t value) override { return take(value); }
  bool number_unsigned(number_unsigned_t value) override { return take(value); }
  bool number_float(number_float_t value, const string_t&) override { return take(value); }
  bool string(string_t& value) override { return take(std::move(value)); }
  bool binary(binary_t& value) override { return take(json::binary(std::move(value))); }
  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& value) override {
    (containers_.empty() ? member_ : key_) = std::move(value);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const json::exception& error) override {
    // Without "[json.exception.parse_error.101] ", which begins it.
    const std::string what = error.what();
    const std::size_t end = what.find("] ");
    error_ = end == std::string::npos ? what : what.substr(end + 2);
    return false;
  }

  [[nodiscard]] const std::string& error() const { return error_; }
  /// The members other than the lists, or the value found in place of an object.
  [[nodiscard]] Document rest() && { return {std::move(rest_), ""}; }

 private:
  // Limits the recursion of the CBOR parser, which calls itself at each level.
  static constexpr int kMaxDepth = 32;  // field documents have 6

  bool open(json container) {
    if (depth_ == kMaxDepth) {
      error_ = "its lists are nested too deeply for a field document";
      return false;
    }
    if (depth_ == 0 && container.is_object()) {
      is_object_ = true;
    } else if (is_object_ && depth_ == 1 && container.is_array() && Lists::has(member_)) {
      in_list_ = true;
      lists_.begin(member_);
    } else {
      containers_.push_back(&insert(std::move(container)));
    }
    ++depth_;
    return true;
  }

  bool close() {
    --depth_;
    if (in_list_ && depth_ == 1) {
      in_list_ = false;
    } else if (!containers_.empty()) {
      containers_.pop_back();
      if (containers_.empty()) finish();
    }
    return true;
  }

  bool take(json value) {
    insert(std::move(value));
    if (containers_.empty()) finish();
    return true;
  }

  json& insert(json value) {
    if (containers_.empty()) return part_ = std::move(value);
    json& container = *containers_.back();
    if (container.is_array()) return container.emplace_back(std::move(value));
    return container[std::move(key_)] = std::move(value);
  }

  // Called when a member, or an item of a list, is complete.
  void finish() {
    if (in_list_)
      lists_.add(member_, std::move(part_));
    else if (is_object_)
      rest_[member_] = std::move(part_);
    else
      rest_ = std::move(part_);
  }

  Lists& lists_;
  json rest_ = json::object();
  bool is_object_ = false;         ///< the document is an object, as it should be
  bool in_list_ = false;           ///< of contacts or triangles
  int depth_ = 0;                  ///< lists and objects that are open
  std::string member_;             ///< of the document
  json part_;                      ///< a member or an item of a list, as far as it is read
  std::vector<json*> containers_;  ///< in `part_` that are open, from the outside to the inside
  std::string key_;                ///< in the innermost of them
  std::string error_;
};

Document parse(const std::string& bytes, ModelEncoding encoding, Lists& lists) {
  const bool is_text = encoding == ModelEncoding::json;
  if (bytes.empty()) throw InvalidInput("the file is empty; expected the model's field document");
  DocumentHandler handler(lists);
  const auto format = is_text ? json::input_format_t::json : json::input_format_t::cbor;
  if (!json::sax_parse(bytes, &handler, format)) {
    throw InvalidInput(std::string("not a whole ") + (is_text ? "JSON" : "CBOR") +
                       " document: " + handler.error());
  }
  return std::move(handler).rest();
}

void check_version(const Node& document) {
  document.at("format").expect_text(kFieldFormat);
  const Node node = document.at("version");
  const long long version = node.integer();
  if (version == kFieldVersion) return;
  const std::string known = std::to_string(kFieldVersion);
  if (version < kFieldVersion) node.refuse(known);
  std::string program = "a newer palpate";
  const auto made = document.find("made");
  if (const auto by = made ? made->find("program") : std::nullopt) program = by->text();
  node.refuse(known + ", the version that this program reads: the model was made by " + program +
              ", which is needed to read it");
}

}  // namespace

Model read_field_document(const std::string& bytes, ModelEncoding encoding) {
  Lists lists;
  const Document part = parse(bytes, encoding, lists);
  const Node document(part);
  check_version(document);
  document.at("units").at("length").expect_text("mm");
  document.at("units").at("force").expect_text("N");
  document.at("surface").expect_text(kSurfaceFile);
  Model model;
  lists.take(document, model);
  model.interpolation = to_interpolation(document.at("interpolation"));
  if (const auto force = document.find("friction_force")) {
    model.friction_force = force->number_above_zero();
  } else {
    for (std::size_t i = 0; i < model.contacts.size(); ++i) {
      if (model.contacts[i].load_exponent == 0) continue;
      refuse(pointer_to(Lists::kContacts, i) + "/friction/load_exponent",
             "an exponent without its reference", "the document to have 'friction_force'");
    }
  }
  if (const auto rate = document.find("rate")) model.rate = to_rate(*rate);
  if (const auto noise = document.find("noise")) {
    model.noise = MeasurementNoise{noise->at("force").number_at_least_zero(),
                                   noise->at("displacement").number_at_least_zero()};
  }
  const Node registration = document.at("registration");
  model.T_surface_acquisition.linear() = registration.at("rotation").rows();
  if (!is_rotation(model.T_surface_acquisition.linear(), kFrameTolerance))
    registration.at("rotation").refuse("a rotation");
  model.T_surface_acquisition.translation() = registration.at("translation").vector();
  if (const auto radius = document.find("probe_radius"))
    model.probe_radius = radius->number_above_zero();
  if (const auto method = choice(document.find("triangulation"), kTriangulations))
    model.triangulation = *method;
  if (const auto fingerprint = document.find("samples_fingerprint"))
    model.samples_fingerprint = to_fingerprint(*fingerprint);
  if (const auto offsets = document.find("pressing_offsets"))
    model.pressing_offsets = to_offsets(*offsets);
  model.made = document.at("made").texts();
  return model;
}

}  // namespace palpate::haptics
