// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/trained_colors.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <ostream>
#include <set>

#include "colors/training_hues.h"
#include "files/storage_file.h"
#include "image/hue.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "palpate/sensing/frame.h"

namespace palpate::sensing {
namespace {

/// Smallest number of pixels for a meaningful mean and variance.
constexpr long kLeastHuePixels = 100;

void check_options(const TrainingOptions& options) {
  require("TrainingOptions::min_value", options.min_value, above(0).below(1));
  require("TrainingOptions::min_saturation", options.min_saturation, above(0).below(1));
}

void collect_hues(const cv::Mat& image, const TrainingOptions& options, std::vector<float>& hues) {
  cv::Mat_<cv::Vec3f> bgr;
  image.convertTo(bgr, CV_32F, 1 / full_scale(image));
  for (const cv::Vec3f& pixel : bgr) {
    const float value = std::max({pixel[0], pixel[1], pixel[2]});
    // A channel at full scale is clipped, so the ratio of the channels no longer gives the hue.
    if (static_cast<double>(value) < options.min_value || value >= 1) continue;
    const Hue hue = hue_of(pixel[2], pixel[1], pixel[0]);
    if (static_cast<double>(hue.saturation) >= options.min_saturation) hues.push_back(hue.angle);
  }
}

/// Source of an image, for messages.
std::string place_of(const NamedImages& named) {
  if (named.sources.empty()) return "train_colors: colour " + named.name;
  const std::size_t more = named.sources.size() - 1;
  return named.sources.front() + (more > 0 ? " and " + std::to_string(more) + " more" : "") +
         ": colour " + named.name;
}

TrainedColor fit_hues(const NamedImages& named, const std::vector<float>& hues) {
  if (static_cast<long>(hues.size()) < kLeastHuePixels) {
    throw InvalidInput(place_of(named) + ": only " + std::to_string(hues.size()) +
                       " pixels are bright and saturated enough and not clipped; at least " +
                       std::to_string(kLeastHuePixels) + " are needed");
  }
  double cosines = 0;
  double sines = 0;
  for (const float hue : hues) {
    cosines += std::cos(static_cast<double>(hue));
    sines += std::sin(static_cast<double>(hue));
  }
  TrainedColor color{.name = named.name, .mean = std::atan2(sines, cosines)};
  if (color.mean < 0) color.mean += 2 * std::numbers::pi;
  for (const float hue : hues) {
    const double difference = wrap(static_cast<double>(hue) - color.mean);
    color.variance += difference * difference;
  }
  color.variance /= static_cast<double>(hues.size());
  color.pixels = static_cast<long>(hues.size());
  return color;
}

bool shows_one_color(const std::string& stem) {
  return stem.find('_') != std::string::npos && stem.front() != '_' &&
         !stem.starts_with("white_") && !stem.starts_with("grey_") &&
         !stem.starts_with("projector_off");
}

void add_folder(const std::filesystem::path& folder, std::map<std::string, NamedImages>& images) {
  std::error_code error;
  std::filesystem::directory_iterator entries(folder, error);
  if (error) throw FileError(folder.string() + ": no such folder, or it cannot be read");
  std::set<std::filesystem::path> files;
  for (const auto& entry : entries) {
    if (entry.path().extension() == ".png" && !is_hidden(entry.path()) &&
        shows_one_color(entry.path().stem().string())) {
      files.insert(entry.path());
    }
  }
  if (files.empty()) {
    throw FileError(
        folder.string() +
        ": holds no training image; names such as R_flat.png or R_sin.png are expected");
  }
  for (const auto& file : files) {
    const cv::Mat image = read_frame(file);
    if (image.channels() != 3) throw FileError(file.string() + ": a colour image is expected");
    const std::string stem = file.stem().string();
    NamedImages& named = images[stem.substr(0, stem.find('_'))];
    named.name = stem.substr(0, stem.find('_'));
    named.images.push_back(image);
    named.sources.push_back(file.string());
  }
}

}  // namespace

std::vector<float> training_hues(const NamedImages& named, const TrainingOptions& options) {
  check_options(options);
  std::vector<float> hues;
  for (const cv::Mat& image : named.images) {
    if (image.type() != CV_8UC3 && image.type() != CV_16UC3)
      throw InvalidInput(place_of(named) + ": an image is not 8 or 16 bit with 3 channels");
    collect_hues(image, options, hues);
  }
  return hues;
}

TrainedColors train_colors(const std::vector<NamedImages>& images, const TrainingOptions& options) {
  check_options(options);
  if (images.empty()) throw InvalidInput("train_colors: there are no images");
  std::map<std::string, std::vector<float>> hues;
  for (const NamedImages& named : images) {
    const std::vector<float> more = training_hues(named, options);
    hues[named.name].insert(hues[named.name].end(), more.begin(), more.end());
  }
  TrainedColors result;
  std::set<std::string> done;
  for (const NamedImages& named : images) {
    if (done.insert(named.name).second) result.colors.push_back(fit_hues(named, hues[named.name]));
  }
  return result;
}

std::vector<NamedImages> read_training_images(const std::vector<std::filesystem::path>& folders) {
  std::map<std::string, NamedImages> by_name;
  for (const auto& folder : folders) add_folder(folder, by_name);
  std::vector<NamedImages> images;
  images.reserve(by_name.size());
  for (auto& [name, named] : by_name) images.push_back(std::move(named));
  return images;
}

TrainedColors train_colors_from_folders(const std::vector<std::filesystem::path>& folders,
                                        const TrainingOptions& options) {
  return train_colors(read_training_images(folders), options);
}

TrainedColors train_colors_from_folder(const std::filesystem::path& folder,
                                       const TrainingOptions& options) {
  return train_colors_from_folders({folder}, options);
}

TrainedColors read_trained_colors(const std::filesystem::path& path) {
  const StorageFile file(path);
  TrainedColors result;
  std::set<std::string> names;
  for (const YAML::Node& item : file.items(file.child(file.root(), "colors"), "colors")) {
    const std::string key = "colors[" + std::to_string(result.colors.size()) + "]";
    TrainedColor color;
    color.name = file.text(file.child(item, "name", key + "."), key + ".name");
    color.mean = file.number(file.child(item, "mean", key + "."), key + ".mean");
    color.variance = file.number(file.child(item, "variance", key + "."), key + ".variance");
    color.pixels = file.whole_number(file.child(item, "pixels", key + "."), key + ".pixels");
    if (color.variance < 0) file.fail(key + ".variance", "must be >= 0");
    if (color.pixels < 0) file.fail(key + ".pixels", "must be >= 0");
    if (!names.insert(color.name).second) file.fail(key + ".name", "appears twice");
    result.colors.push_back(color);
  }
  return result;
}

void write_trained_colors(const std::filesystem::path& path, const TrainedColors& colors) {
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "colors"
          << "[";
  for (const TrainedColor& color : colors.colors) {
    // FileStorage supports only integers of 32 bits.
    const int saturated = static_cast<int>(std::min<long>(color.pixels, INT_MAX));
    storage << "{"
            << "name" << color.name << "mean" << color.mean << "variance" << color.variance
            << "pixels" << saturated << "}";
  }
  storage << "]";
  const std::string text = storage.releaseAndGetString();
  write_file(path, [&](std::ostream& out) { out << text; });
}

}  // namespace palpate::sensing
