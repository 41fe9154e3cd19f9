// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <optional>

#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/response.h"

namespace palpate::sensing {
namespace {

/// Smallest number of levels: a curve needs black, gain, exponent, and some redundancy.
constexpr std::size_t kLeastLevels = 5;
/// Share of the lit pixels that must remain without the clipped ones.
constexpr double kLeastUsable = 0.2;
/// Share of the pixels, from that with the smallest range on, that set the scale.
constexpr double kRangesBelow = 0.95;
/// A level may look darker than the one below by this share of the whole range (flicker, noise).
constexpr double kFlicker = 0.01;
/// Range of exponents for the power law.
constexpr double kLeastGamma = 0.2;
constexpr double kMostGamma = 5;

[[noreturn]] void fail(const std::string& what) {
  throw InvalidInput("calibrate_response: " + what);
}

std::vector<GreyImage> sorted_and_checked(std::vector<GreyImage> ramp,
                                          const ResponseOptions& options) {
  require("ResponseOptions::min_range", options.min_range, above(0).below(1));
  require("ResponseOptions::min_contrast", options.min_contrast, above(0).below(1));
  if (ramp.empty()) fail("there are no images");
  for (const GreyImage& grey : ramp) {
    const cv::Mat& image = grey.image;
    require("calibrate_response: " + grey.name + ": the level", grey.level, at_least(0).at_most(1));
    if (!is_frame(image)) {
      fail(grey.name + ": an image of 8 or 16 bit with 1 or 3 channels is expected");
    }
    if (image.size() != ramp[0].image.size() || image.type() != ramp[0].image.type())
      fail(grey.name + ": differs from " + ramp[0].name + " in size or type");
  }
  std::stable_sort(ramp.begin(), ramp.end(),
                   [](const GreyImage& a, const GreyImage& b) { return a.level < b.level; });
  for (std::size_t i = 1; i < ramp.size(); ++i)
    if (ramp[i].level == ramp[i - 1].level)
      fail(ramp[i].name + ": shows the same level as " + ramp[i - 1].name);
  return ramp;
}

/// Data of one channel, as fractions of full scale.
struct Channel {
  std::vector<double> levels;
  std::vector<std::string> names;
  std::vector<cv::Mat_<float>> images;
};

Channel extract_channel(const std::vector<GreyImage>& ramp, int index) {
  Channel channel;
  for (const GreyImage& grey : ramp) {
    cv::Mat plane;
    cv::extractChannel(grey.image, plane, index);
    plane.convertTo(plane, CV_32F, 1 / full_scale(plane));
    channel.levels.push_back(grey.level);
    channel.names.push_back(grey.name);
    channel.images.emplace_back(plane);
  }
  return channel;
}

/// Pixels, 255 or 0, whose value changes enough from image to image.
cv::Mat find_changing(const Channel& channel, const ResponseOptions& options) {
  cv::Mat_<float> low = channel.images[0].clone();
  cv::Mat_<float> high = low.clone();
  for (const cv::Mat_<float>& image : channel.images) {
    low = cv::min(low, image);
    high = cv::max(high, image);
  }
  if (2 * cv::countNonZero(low >= 1) > static_cast<int>(low.total()))
    fail("even " + channel.names.front() + " is clipped; shorten the exposure");
  cv::Mat_<float> range;
  cv::subtract(high, low, range);
  // Highlights and defective pixels must not set the scale for the others.
  const float widest = quantile(range, kRangesBelow);
  if (!(static_cast<double>(widest) >= options.min_contrast)) {
    fail("from " + channel.names.front() + " to " + channel.names.back() +
         " the images hardly get brighter (by " + std::to_string(widest) +
         " of full scale); the projector's light does not arrive, or the exposure is too short");
  }
  return range >= options.min_range * static_cast<double>(widest);
}

/// Removes clipped pixels from the mask, and the brightest levels if they would leave too few
/// pixels.
void drop_clipped(Channel& channel, cv::Mat& mask) {
  const double lit = cv::countNonZero(mask);
  while (true) {
    cv::Mat usable = mask.clone();
    for (const cv::Mat_<float>& image : channel.images) usable &= image < 1;
    if (cv::countNonZero(usable) >= kLeastUsable * lit) {
      mask = usable;
      return;
    }
    if (channel.levels.size() <= kLeastLevels) {
      fail("even " + channel.names.back() + " is clipped; " + std::to_string(kLeastLevels) +
           " levels that are not are needed. Shorten the exposure");
    }
    channel.levels.pop_back();
    channel.names.pop_back();
    channel.images.pop_back();
  }
}

/// Mean value at each level, increasing.
Eigen::VectorXd mean_values(const Channel& channel, const cv::Mat& mask) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(channel.images.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values[i] = cv::mean(channel.images[static_cast<std::size_t>(i)], mask)[0];
  const double flicker = kFlicker * (values.maxCoeff() - values.minCoeff());
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (values[i] < values[i - 1] - flicker) {
      fail(channel.names[at] + ": looks darker than " + channel.names[at - 1] +
           "; the levels must be those in the names, the exposure fixed and the scene still");
    }
    values[i] = std::max(values[i], values[i - 1]);
  }
  return values;
}

/// value = black + gain level^gamma.
struct PowerLaw {
  double black = 0;
  double gain = 0;
  double gamma = 1;
  double gamma_deviation = 0;
};

/// The best black and gain for one exponent.
PowerLaw fit_line(const Eigen::VectorXd& levels, const Eigen::VectorXd& values, double gamma) {
  Eigen::MatrixX2d basis(levels.size(), 2);
  basis.col(0).setOnes();
  basis.col(1) = levels.array().pow(gamma);
  const Eigen::Vector2d solution = basis.colPivHouseholderQr().solve(values);
  return {.black = solution[0], .gain = solution[1], .gamma = gamma};
}

Eigen::VectorXd misfit(const Eigen::VectorXd& levels, const Eigen::VectorXd& values,
                       const PowerLaw& law) {
  return values.array() - law.black - law.gain * levels.array().pow(law.gamma);
}

PowerLaw fit_power_law(const Eigen::VectorXd& levels, const Eigen::VectorXd& values) {
  // Golden section in the logarithm of the exponent.
  constexpr double kTolerance = 1e-10;
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  const auto cost = [&](double log_gamma) {
    return misfit(levels, values, fit_line(levels, values, std::exp(log_gamma))).squaredNorm();
  };
  double low = std::log(kLeastGamma);
  double high = std::log(kMostGamma);
  while (high - low > kTolerance) {
    const double left = high - ratio * (high - low);
    const double right = low + ratio * (high - low);
    (cost(left) < cost(right) ? high : low) = cost(left) < cost(right) ? right : left;
  }
  PowerLaw law = fit_line(levels, values, std::exp((low + high) / 2));
  Eigen::MatrixX3d jacobian(levels.size(), 3);
  jacobian.col(0).setOnes();
  jacobian.col(1) = levels.array().pow(law.gamma);
  for (Eigen::Index i = 0; i < levels.size(); ++i)
    jacobian(i, 2) = levels[i] > 0 ? law.gain * jacobian(i, 1) * std::log(levels[i]) : 0;
  const double variance = misfit(levels, values, law).squaredNorm() /
                          static_cast<double>(std::max<Eigen::Index>(levels.size() - 3, 1));
  const Eigen::HouseholderQR<Eigen::MatrixX3d> qr(jacobian);
  law.gamma_deviation = std::sqrt(variance) / std::abs(qr.matrixQR()(2, 2));
  return law;
}

ResponseCurve fit_channel(Channel channel, const ResponseOptions& options) {
  cv::Mat mask = find_changing(channel, options);
  drop_clipped(channel, mask);
  const Eigen::VectorXd values = mean_values(channel, mask);
  const Eigen::VectorXd levels =
      Eigen::Map<const Eigen::VectorXd>(channel.levels.data(), values.size());
  const PowerLaw law = fit_power_law(levels, values);
  ResponseCurve curve;
  curve.black = law.black;
  curve.gamma = law.gamma;
  curve.gamma_deviation = law.gamma_deviation;
  if (channel.levels.front() == 0) {
    curve.black = values[0];
  } else {
    curve.levels.push_back(0);
    curve.light.push_back(0);
  }
  curve.gain = values.tail<1>()[0] - curve.black;
  if (!(curve.gain >= options.min_contrast * options.min_range))
    fail("the brightest image that is not clipped, " + channel.names.back() +
         ", is hardly brighter than black; shorten the exposure");
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    curve.levels.push_back(levels[i]);
    curve.light.push_back(std::clamp((values[i] - curve.black) / curve.gain, 0.0, 1.0));
  }
  curve.misfit =
      std::sqrt(misfit(levels, values, law).squaredNorm() / static_cast<double>(values.size())) /
      curve.gain;
  return curve;
}

/// The level in a name such as grey_017.
std::optional<int> level_in(const std::string& stem) {
  if (!stem.starts_with("grey_") && !stem.starts_with("gray_")) return std::nullopt;
  int level = 0;
  const char* const end = stem.data() + stem.size();
  const auto [stop, error] = std::from_chars(stem.data() + 5, end, level);
  if (error != std::errc() || stop != end || level < 0 || level > 255) return std::nullopt;
  return level;
}

}  // namespace

Response calibrate_response(const std::vector<GreyImage>& ramp, const ResponseOptions& options) {
  const std::vector<GreyImage> images = sorted_and_checked(ramp, options);
  if (images.size() < kLeastLevels)
    fail(images.front().name + ": the levels are too few, " + std::to_string(images.size()) +
         "; at least " + std::to_string(kLeastLevels) + " are needed");
  Response response;
  for (int index = 0; index < images[0].image.channels(); ++index)
    response.channels.push_back(fit_channel(extract_channel(images, index), options));
  return response;
}

std::vector<GreyImage> read_grey_ramp(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  if (error) throw FileError(folder.string() + ": no such folder, or it cannot be read");
  std::vector<GreyImage> ramp;
  for (; entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::filesystem::path& path = entry->path();
    if (is_hidden(path) || !has_frame_name(path)) continue;
    if (const auto level = level_in(path.stem().string()))
      ramp.push_back({*level / 255.0, read_frame(path), path.string()});
  }
  if (ramp.empty()) {
    throw FileError(
        folder.string() +
        ": holds no grey ramp; names such as grey_000.png and grey_255.png are expected");
  }
  return ramp;
}

}  // namespace palpate::sensing
