// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace palpate::sensing {

/// The hues under which one projected colour is seen.
struct TrainedColor {
  std::string name;     ///< as in the pattern
  double mean = 0;      ///< rad, circular mean, in [0, 2 pi)
  double variance = 0;  ///< rad^2, mean squared circular difference to the mean
  long pixels = 0;      ///< how many pixels these come from
};

/// What the colour classifier knows (thesis 3.3.2).
struct TrainedColors {
  std::vector<TrainedColor> colors;
};

/// Images of a scene under one projected colour; 8 or 16 bit, 3 channels in OpenCV's order (BGR).
struct NamedImages {
  std::string name;
  std::vector<cv::Mat> images;
  std::vector<std::string> sources{};  ///< for messages: the files, as many as images, or none
};

struct TrainingOptions {
  double min_value =
      0.08;  ///< a pixel counts iff max(R, G, B) >= min_value of full scale; in (0, 1)
  double min_saturation = 0.4;  ///< and its HSV saturation >= min_saturation; in (0, 1)
};

/// Fits a circular mean and variance of the hue to each colour; images of one name count together.
/// \throws InvalidInput on an empty list, an image of another type, an option outside its range, or
/// a colour of which too few pixels are bright and saturated enough.
[[nodiscard]] TrainedColors train_colors(const std::vector<NamedImages>& images,
                                         const TrainingOptions& options = {});

/// The images `<colour>_<anything>.png` of folders, such as `R_flat.png` and `R_sin.png`, by
/// colour. Files that begin with `white_`, `grey_` or `projector_off` show no single colour and are
/// left out. \throws FileError if a folder holds no such image or one cannot be read.
[[nodiscard]] std::vector<NamedImages> read_training_images(
    const std::vector<std::filesystem::path>& folders);

/// Both at once. \throws FileError; InvalidInput.
[[nodiscard]] TrainedColors train_colors_from_folders(
    const std::vector<std::filesystem::path>& folders, const TrainingOptions& options = {});
[[nodiscard]] TrainedColors train_colors_from_folder(const std::filesystem::path& folder,
                                                     const TrainingOptions& options = {});

/// Reads trained colours (OpenCV FileStorage: `colors` with `name`, `mean`, `variance`, `pixels`).
/// \throws FileError naming the file and the place.
[[nodiscard]] TrainedColors read_trained_colors(const std::filesystem::path& path);

/// Writes trained colours as `read_trained_colors` reads them.
/// \throws OutputError.
void write_trained_colors(const std::filesystem::path& path, const TrainedColors& colors);

}  // namespace palpate::sensing
