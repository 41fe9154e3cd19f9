// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <vector>

#include "model/field_document.h"
#include "model/field_document_format.h"
#include "model/stored_form.h"
#include "palpate/core/error.h"
#include "palpate/haptics/model_io.h"

namespace palpate::haptics {
namespace {

using Json = nlohmann::ordered_json;

// Whole numbers are written without ".0", except -0. A number that the reader would refuse is an
// error.
Json to_json(double value) {
  if (!(std::abs(value) <= documents::kLargestDocumentNumber)) {
    throw InvalidInput("field_document(): the model has a number of " + Json(value).dump() +
                       ", or a ridge makes it; the document holds none beyond 1e12");
  }
  constexpr double kExact = 0x1p53;  // below it every whole number is a double
  const bool is_whole = std::trunc(value) == value && std::abs(value) < kExact;
  if (is_whole && !(value == 0 && std::signbit(value))) return static_cast<std::int64_t>(value);
  return value;
}

Json to_json(const Eigen::Vector3d& v) { return {to_json(v.x()), to_json(v.y()), to_json(v.z())}; }

Json to_json(const Eigen::Matrix3d& rows) {
  Json result = Json::array();
  for (int i = 0; i < 3; ++i) result.push_back(to_json(Eigen::Vector3d(rows.row(i))));
  return result;
}

Json to_json(const Multiquadric& base) {
  Json result = {to_json(base.weight), to_json(base.epsilon)};
  for (const double coordinate : base.center) result.push_back(to_json(coordinate));
  return result;
}

Json to_json(const StoredRidge& ridge) {
  Json result = {to_json(ridge.weight), to_json(ridge.offset)};
  for (const double entry : ridge.slope) result.push_back(to_json(entry));
  return result;
}

// Writes the shortened form if it stands for the same base, so that a rounded model is read back
// unchanged. Any other base is written with all digits.
Json ridge_to_json(const Multiquadric& base) {
  const StoredRidge stored = to_stored(base), shortened = rounded(stored);
  return to_json(to_ridge(shortened) == base ? shortened : stored);
}

template <typename Vector>
Json numbers_to_json(const Vector& vector) {
  Json result = Json::array();
  for (const double entry : vector) result.push_back(to_json(entry));
  return result;
}

Json frame_to_json(const Eigen::Matrix3d& frame) {
  const Eigen::Vector4d stored = to_quaternion(frame), shortened = rounded(stored);
  return numbers_to_json(to_frame(shortened) == frame ? shortened : stored);
}

Json axis_to_json(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d stored = to_direction(axis), shortened = rounded(stored);
  return to_json(shortened.normalized() == axis ? shortened : stored);
}

// Omits figures that are not known.
void put(Json& object, const char* key, const std::optional<double>& figure) {
  if (figure) object[key] = to_json(*figure);
}

template <typename Value>
void put_word(Json& object, const char* key, const std::optional<Value>& value) {
  if (value) object[key] = to_string(*value);
}

Json to_json(const ContactCompliance& compliance) {
  Json trend = Json::array();
  for (const auto& derivative : compliance.trend.colwise())
    trend.push_back(numbers_to_json(derivative));
  return {{"direction", to_json(compliance.direction)},
          {"values", numbers_to_json(compliance.values)},
          {"trend", trend}};
}

Json to_json(const ContactStrength& strength) {
  return {{"value", to_json(strength.value)}, {"trend", numbers_to_json(strength.trend)}};
}

Json to_json(const ContactUncertainty& uncertainty) {
  return {{"force", to_json(uncertainty.force)},
          {"displacement", to_json(uncertainty.displacement)},
          {"across", to_json(uncertainty.across)},
          {"between", to_json(uncertainty.between)}};
}

Json friction_to_json(const ContactModel& contact) {
  Json friction = {{"coefficient", to_json(contact.friction)},
                   {"lower_bound", to_json(contact.friction_lower_bound)},
                   {"source", to_string(contact.friction_source)},
                   {"axis", axis_to_json(contact.friction_axis)}};
  put(friction, "error", contact.friction_error);
  if (contact.load_exponent != 0) friction["load_exponent"] = to_json(contact.load_exponent);
  return friction;
}

Json fit_to_json(const ContactModel& contact) {
  Json fit = {{"samples", contact.samples}, {"rms", to_json(contact.rms)}};
  put_word(fit, "stop", contact.fit_stop);
  put_word(fit, "mode", contact.fit_mode);
  put_word(fit, "passivity", contact.passivity);
  put(fit, "chi2", contact.chi2);
  put(fit, "noise_floor", contact.noise_floor);
  put(fit, "condition", contact.condition);
  if (contact.shared_local) fit["shared_local"] = true;
  return fit;
}

Json to_json(const ContactModel& contact) {
  Json bases = Json::array(), ridges = Json::array();
  for (const Multiquadric& base : contact.field.bases) {
    if (base.ridge.isZero(0))
      bases.push_back(to_json(base));
    else
      ridges.push_back(ridge_to_json(base));
  }
  Json result = {{"id", contact.id},
                 {"position", to_json(contact.position)},
                 {"rotation", frame_to_json(contact.frame)},
                 {"bases", bases},
                 {"ridges", ridges}};
  if (contact.compliance) result["compliance"] = to_json(*contact.compliance);
  if (contact.strength) result["strength"] = to_json(*contact.strength);
  if (contact.uncertainty) result["uncertainty"] = to_json(*contact.uncertainty);
  result["friction"] = friction_to_json(contact);
  result["fit"] = fit_to_json(contact);
  return result;
}

Json to_json(const Interpolation& interpolation) {
  Json result = {{"rule", to_string(interpolation.rule)}};
  if (interpolation.rule == BlendRule::compliances)
    result["reference_force"] = to_json(interpolation.reference_force);
  else if (interpolation.reference_depth > 0)
    result["reference_depth"] = to_json(interpolation.reference_depth);
  else
    return result;
  result["reach"] = to_json(interpolation.reach);
  return result;
}

Json to_json(const std::vector<RateTerm>& rate) {
  Json result = Json::array();
  for (const RateTerm& term : rate)
    result.push_back({{"share", to_json(term.share)}, {"time", to_json(term.time)}});
  return result;
}

Json to_json(const PressingOffsets& offsets) {
  return {{"force_found", offsets.force_found},
          {"force_offset", to_json(offsets.force)},
          {"force_offset_error", to_json(offsets.force_error)},
          {"along_pressing", offsets.along_direction},
          {"touch_found", offsets.touch_found},
          {"touch_offset", to_json(offsets.touch)},
          {"touch_offset_error", to_json(offsets.touch_error)},
          {"touch_offset_spread", to_json(offsets.touch_spread)},
          {"surface_slope", to_json(offsets.height_slope)},
          {"surface_slope_error", to_json(offsets.height_slope_error)},
          {"hysteresis", to_json(offsets.hysteresis)},
          {"hysteresis_error", to_json(offsets.hysteresis_error)}};
}

// Writes an object as text, member by member: a line for a short member, a line for each list item.
class TextWriter {
 public:
  explicit TextWriter(std::ostream& stream) : stream_(stream) {}

  void begin(int) { stream_ << '{'; }
  void member(const char* key, const Json& value) {
    name(key);
    stream_ << text(value);
  }
  void begin_list(const char* key, std::size_t) {
    name(key);
    stream_ << '[';
    separator_ = "\n";
  }
  void item(const Json& value) {
    stream_ << separator_ << text(value);
    separator_ = ",\n";
  }
  void end_list() {
    stream_ << "\n]";
    separator_ = ",\n";
  }
  void end() { stream_ << "}\n"; }

 private:
  void name(const char* key) {
    stream_ << separator_ << '"' << key << "\":";
    separator_ = ",\n";
  }
  // JSON is UTF-8, but a file name in `made` may be in any encoding.
  static std::string text(const Json& value) {
    return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  std::ostream& stream_;
  const char* separator_ = "";
};

// Writes the same in CBOR (RFC 8949): a head gives the type and size of what follows it.
class CborWriter {
 public:
  explicit CborWriter(std::ostream& stream) : stream_(stream) {}

  void begin(int members) { put(static_cast<char>(0xA0 | members)); }  // fewer than 24
  void member(const char* key, const Json& value) {
    put(Json(key));
    put(value);
  }
  void begin_list(const char* key, std::size_t size) {
    put(Json(key));
    put(static_cast<char>(0x9B));  // a list with its size in eight bytes
    for (int shift = 56; shift >= 0; shift -= 8) put(static_cast<char>(size >> shift & 0xFF));
  }
  void item(const Json& value) { put(value); }
  void end_list() {}
  void end() {}

 private:
  void put(char byte) { stream_.put(byte); }
  void put(const Json& value) {
    bytes_.clear();
    Json::to_cbor(value, bytes_);
    stream_.write(reinterpret_cast<const char*>(bytes_.data()),
                  static_cast<std::streamsize>(bytes_.size()));
  }

  std::ostream& stream_;
  std::vector<std::uint8_t> bytes_;
};

// Texts of CBOR and JSON are UTF-8, but a file name may be in any encoding.
Json valid_texts(const std::map<std::string, std::string>& texts) {
  const std::string text = Json(texts).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(text);
}

template <typename Writer>
void write(Writer writer, const Model& model) {
  constexpr int kMembers = 10;
  writer.begin(kMembers + (model.probe_radius ? 1 : 0) + (model.friction_force != 0 ? 1 : 0) +
               (model.rate.empty() ? 0 : 1) + (model.noise ? 1 : 0) +
               (model.samples_fingerprint ? 1 : 0) + (model.pressing_offsets ? 1 : 0));
  writer.member("format", kFieldFormat);
  writer.member("version", kFieldVersion);
  writer.member("units", {{"length", "mm"}, {"force", "N"}});
  writer.member("made", valid_texts(model.made));
  writer.member("surface", kSurfaceFile);
  writer.member(
      "registration",
      {{"rotation", to_json(Eigen::Matrix3d(model.T_surface_acquisition.linear()))},
       {"translation", to_json(Eigen::Vector3d(model.T_surface_acquisition.translation()))}});
  if (model.probe_radius) writer.member("probe_radius", to_json(*model.probe_radius));
  writer.member("interpolation", to_json(model.interpolation));
  if (model.friction_force != 0) writer.member("friction_force", to_json(model.friction_force));
  if (!model.rate.empty()) writer.member("rate", to_json(model.rate));
  if (model.noise) {
    writer.member("noise", {{"force", to_json(model.noise->force)},
                            {"displacement", to_json(model.noise->displacement)}});
  }
  if (model.samples_fingerprint) writer.member("samples_fingerprint", *model.samples_fingerprint);
  if (model.pressing_offsets) writer.member("pressing_offsets", to_json(*model.pressing_offsets));
  writer.member("triangulation", to_string(model.triangulation));
  writer.begin_list("contacts", model.contacts.size());
  for (const ContactModel& contact : model.contacts) writer.item(to_json(contact));
  writer.end_list();
  writer.begin_list("triangles", static_cast<std::size_t>(model.triangles.cols()));
  for (const auto& t : model.triangles.colwise()) writer.item({t[0], t[1], t[2]});
  writer.end_list();
  writer.end();
}

}  // namespace

void write_field_document(std::ostream& stream, const Model& model, ModelEncoding encoding) {
  if (encoding == ModelEncoding::json)
    write(TextWriter(stream), model);
  else
    write(CborWriter(stream), model);
}

}  // namespace palpate::haptics
