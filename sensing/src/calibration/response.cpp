// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/response.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <ostream>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"

namespace palpate::sensing {
namespace {

/// The reason why a curve cannot be used; empty if it can.
std::string fault_of(const ResponseCurve& curve) {
  if (!std::isfinite(curve.black) || !(curve.gain > 0) || !std::isfinite(curve.gain) ||
      !(curve.gamma > 0) || !std::isfinite(curve.gamma)) {
    return "black must be finite, gain and gamma > 0";
  }
  const std::size_t count = curve.levels.size();
  if (count < 2 || curve.light.size() != count)
    return "levels and light: as many of each, at least two, are expected";
  if (curve.levels.front() != 0 || curve.light.front() != 0 || !(curve.levels.back() <= 1) ||
      curve.light.back() != 1) {
    return "levels must begin at 0 and end at most at 1, light go from 0 to 1";
  }
  for (std::size_t i = 1; i < count; ++i) {
    if (!(curve.levels[i] > curve.levels[i - 1]) || !(curve.light[i] >= curve.light[i - 1]))
      return "levels must rise, and light must not fall";
  }
  return {};
}

/// Level as a function of light. Between measured levels the deviation from the power law is
/// interpolated, because it is much straighter than the curve itself.
class InverseCurve {
 public:
  explicit InverseCurve(const ResponseCurve& curve) : exponent_(1 / curve.gamma) {
    for (std::size_t i = 0; i < curve.levels.size(); ++i) {
      const double root = std::pow(curve.light[i], exponent_);
      // For levels with equal light take the middle one.
      if (!roots_.empty() && !(root > roots_.back())) {
        levels_.back() = (levels_.back() + curve.levels[i]) / 2;
        continue;
      }
      roots_.push_back(root);
      levels_.push_back(curve.levels[i]);
    }
  }

  [[nodiscard]] double operator()(double light) const {
    if (!(light > 0)) return 0;
    const double root = std::pow(light, exponent_);
    if (root >= roots_.back()) return levels_.back() * root / roots_.back();
    const auto above = std::upper_bound(roots_.begin(), roots_.end(), root);
    const auto i = static_cast<std::size_t>(above - roots_.begin());
    const double part = (root - roots_[i - 1]) / (roots_[i] - roots_[i - 1]);
    return levels_[i - 1] + part * (levels_[i] - levels_[i - 1]);
  }

 private:
  double exponent_;
  std::vector<double> roots_;
  std::vector<double> levels_;
};

/// The 16 bit value for each value of 0 ... full_scale.
std::vector<ushort> make_table(const ResponseCurve& curve, int full_scale) {
  const InverseCurve inverse(curve);
  const auto level = [&](int value) {
    return inverse((static_cast<double>(value) / full_scale - curve.black) / curve.gain);
  };
  constexpr double kFull = 65535;
  const double largest = level(full_scale);
  if (!(largest > 0)) throw InvalidInput("linearize: response: black lies above full scale");
  std::vector<ushort> table;
  table.reserve(static_cast<std::size_t>(full_scale) + 1);
  for (int value = 0; value <= full_scale; ++value)
    table.push_back(static_cast<ushort>(std::lround(kFull * level(value) / largest)));
  return table;
}

template <typename Value>
void look_up(const cv::Mat& frame, const std::vector<std::vector<ushort>>& tables, cv::Mat& out) {
  const auto channels = tables.size();
  for (int row = 0; row < frame.rows; ++row) {
    const auto* from = frame.ptr<Value>(row);
    auto* to = out.ptr<ushort>(row);
    for (std::size_t i = 0; i < channels * static_cast<std::size_t>(frame.cols); ++i)
      to[i] = tables[i % channels][from[i]];
  }
}

}  // namespace

Linearizer::Linearizer(const Response& response) {
  for (const ResponseCurve& curve : response.channels) {
    const std::string fault = fault_of(curve);
    if (!fault.empty()) throw InvalidInput("linearize: response: " + fault);
    narrow_.push_back(make_table(curve, 255));
    wide_.push_back(make_table(curve, 65535));
  }
}

cv::Mat Linearizer::operator()(const cv::Mat& frame) const {
  if (frame.empty() || (frame.depth() != CV_8U && frame.depth() != CV_16U))
    throw InvalidInput("linearize: a frame of 8 or 16 bit is expected");
  if (static_cast<std::size_t>(frame.channels()) != wide_.size()) {
    throw InvalidInput("linearize: the frame has " + std::to_string(frame.channels()) +
                       " channels, the response " + std::to_string(wide_.size()));
  }
  cv::Mat out(frame.size(), CV_MAKETYPE(CV_16U, frame.channels()));
  if (frame.depth() == CV_8U) {
    look_up<uchar>(frame, narrow_, out);
  } else {
    look_up<ushort>(frame, wide_, out);
  }
  return out;
}

cv::Mat linearize(const cv::Mat& frame, const Response& response) {
  return Linearizer(response)(frame);
}

Response read_response(const std::filesystem::path& path) {
  const StorageFile file(path);
  Response response;
  for (const YAML::Node& item : file.items(file.child(file.root(), "response"), "response")) {
    const std::string key = "response[" + std::to_string(response.channels.size()) + "]";
    const auto number = [&](const char* name) {
      return file.number(file.child(item, name, key + "."), key + "." + name);
    };
    const auto numbers = [&](const char* name) {
      return file.numbers(file.child(item, name, key + "."), key + "." + name);
    };
    response.channels.push_back({.black = number("black"),
                                 .gain = number("gain"),
                                 .gamma = number("gamma"),
                                 .gamma_deviation = number("gamma_deviation"),
                                 .misfit = number("misfit"),
                                 .levels = numbers("levels"),
                                 .light = numbers("light")});
    const std::string fault = fault_of(response.channels.back());
    if (!fault.empty()) file.fail(key, fault);
  }
  if (response.channels.size() != 1 && response.channels.size() != 3)
    file.fail("response", "one or three channels are expected");
  return response;
}

void write_response(const std::filesystem::path& path, const Response& response) {
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "response"
          << "[";
  for (const ResponseCurve& curve : response.channels) {
    storage << "{"
            << "black" << curve.black << "gain" << curve.gain << "gamma" << curve.gamma
            << "gamma_deviation" << curve.gamma_deviation << "misfit" << curve.misfit << "levels"
            << curve.levels << "light" << curve.light << "}";
  }
  storage << "]";
  const std::string text = storage.releaseAndGetString();
  write_file(path, [&](std::ostream& out) { out << text; });
}

}  // namespace palpate::sensing
