// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/fit_record.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

constexpr const char* kFitRecord = "fits of palpate fit";
// Of the record; raised when the members of a line change. A record without one is older than 2.
constexpr int kFitRecordVersion = 3;

/// The remedy if a run cannot be resumed, for messages.
constexpr const char* kAnew = "Leave out --resume to fit all contacts again";

// JSON has no infinity and no NaN, which a figure of a fit may be.
Json number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

double to_number(const Json& json) {
  if (json.is_number()) return json.get<double>();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto word = json.get<std::string>();
  return word == "inf"    ? kInfinity
         : word == "-inf" ? -kInfinity
                          : std::numeric_limits<double>::quiet_NaN();
}

// Thrown if a record contains an impossible value.
struct Damaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Returns the value, from 0 to `last`, for which `to_string` returns the word.
template <typename Value>
Value to_value(const Json& json, Value last) {
  const auto word = json.get<std::string>();
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    if (word == haptics::to_string(static_cast<Value>(i))) return static_cast<Value>(i);
  }
  throw Damaged(fmt::format("\"{}\" is no word of it", word));
}

Json to_json(const haptics::FitResult& fit) {
  Json bases = Json::array();
  for (const haptics::Multiquadric& base : fit.field.bases) {
    Json numbers = {base.weight, base.epsilon};
    for (const double coordinate : base.center) numbers.push_back(coordinate);
    for (const double coordinate : base.ridge) numbers.push_back(coordinate);
    bases.push_back(numbers);
  }
  return {{"bases", bases},
          {"rms", number(fit.rms)},
          {"iterations", fit.iterations},
          {"stop", haptics::to_string(fit.stop)},
          {"smallest_stiffness", number(fit.smallest_stiffness)},
          {"mode", haptics::to_string(fit.mode)},
          {"passivity", haptics::to_string(fit.certificate.passivity)},
          {"radius", number(fit.certificate.volume.radius)},
          {"chi2", number(fit.chi2)},
          {"outliers", fit.outliers},
          {"noise_floor", number(fit.noise_floor)},
          {"displacement_noise", number(fit.displacement_noise)},
          {"condition", fit.condition ? number(*fit.condition) : Json()},
          {"unmeasured", fit.unmeasured},
          {"shared_local", fit.shared_local}};
}

haptics::FitResult to_fit(const Json& json) {
  haptics::FitResult fit;
  for (const Json& numbers : json.at("bases")) {
    haptics::Multiquadric base{numbers.at(0), numbers.at(1)};
    for (std::size_t i = 0; i < 3; ++i) {
      base.center[static_cast<Eigen::Index>(i)] = numbers.at(2 + i);
      base.ridge[static_cast<Eigen::Index>(i)] = numbers.at(5 + i);
    }
    fit.field.bases.push_back(base);
  }
  try {
    haptics::check_force_field(fit.field, "a field");
  } catch (const InvalidInput& error) {
    throw Damaged(error.what());
  }
  fit.rms = to_number(json.at("rms"));
  fit.iterations = json.at("iterations");
  fit.stop = to_value(json.at("stop"), haptics::FitStop::not_determined);
  fit.smallest_stiffness = to_number(json.at("smallest_stiffness"));
  fit.mode = to_value(json.at("mode"), haptics::FitMode::local);
  fit.certificate.passivity = to_value(json.at("passivity"), haptics::Passivity::undecided);
  fit.certificate.volume.radius = to_number(json.at("radius"));
  fit.chi2 = to_number(json.at("chi2"));
  fit.outliers = json.at("outliers");
  fit.noise_floor = to_number(json.at("noise_floor"));
  fit.displacement_noise = to_number(json.at("displacement_noise"));
  if (!json.at("condition").is_null()) fit.condition = to_number(json.at("condition"));
  fit.unmeasured = json.at("unmeasured");
  fit.shared_local = json.at("shared_local");
  return fit;
}

/// Returns true if a file begins like a record.
bool is_record(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  std::getline(stream, line);
  const Json head = Json::parse(line, nullptr, false);
  return head.is_object() && head.contains("kind") && head["kind"] == kFitRecord;
}

}  // namespace

FitRecord::FitRecord(fs::path file, Json settings)
    : file_(std::move(file)), settings_(std::move(settings)) {}

void FitRecord::check_same(const Json& head) const {
  if (head.at("kind") == kFitRecord && head.value("version", 0) != kFitRecordVersion) {
    throw InvalidInput(fmt::format(
        "{}: was written by another version of palpate, whose record this version cannot read. {}.",
        file_.string(), kAnew));
  }
  check_same_settings(file_, head.at("settings"), settings_, kAnew);
}

void FitRecord::resume() {
  resumed_ = is_there(file_);
  if (!resumed_) return;
  const RunRecord record = read_run_record(file_, kAnew);
  const auto refuse = [&](const std::exception& error) {
    throw FileError(fmt::format("{}: this is not the record of an earlier run ({}). {}.",
                                file_.string(), error.what(), kAnew));
  };
  try {
    check_same(record.head);
    for (const Json& item : record.items)
      fits_[item.at("contact").get<long long>()] = to_fit(item.at("fit"));
  } catch (const Json::exception& error) {
    refuse(error);
  } catch (const Damaged& error) {
    refuse(error);
  }
}

void FitRecord::begin() const {
  if (resumed_ || !is_there(file_) || is_record(file_)) return;
  throw InvalidInput(file_.string() +
                     ": is where finished fits are to be kept, and is no record of such; nothing "
                     "is changed. Choose another output, or remove it.");
}

void FitRecord::add(long long contact, const haptics::FitResult& fit) {
  const auto item = [](long long id, const haptics::FitResult& result) {
    return Json{{"contact", id}, {"fit", to_json(result)}};
  };
  if (!writer_) {
    RunRecord record{
        .head = {{"kind", kFitRecord}, {"version", kFitRecordVersion}, {"settings", settings_}},
        .items = {}};
    for (const auto& [id, earlier] : fits_) record.items.push_back(item(id, earlier));
    writer_.emplace(file_, record);
  }
  writer_->add(item(contact, fit));
}

const haptics::FitResult* FitRecord::find(long long contact) const {
  const auto found = fits_.find(contact);
  return found == fits_.end() ? nullptr : &found->second;
}

void FitRecord::remove() {
  writer_.reset();
  if (is_there(file_)) fs::remove(file_);
}

}  // namespace palpate::apps
