// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace palpate::sensing {

/// Distribution of the hues that the camera sees of one projected colour.
struct TrainedColor {
  std::string name;     ///< as in the pattern
  double mean = 0;      ///< rad, circular mean, in [0, 2 pi)
  double variance = 0;  ///< rad^2, mean squared circular difference to the mean
  long pixels = 0;      ///< number of pixels they were computed from
};

/// Training data of the colour classifier (thesis 3.3.2).
struct TrainedColors {
  std::vector<TrainedColor> colors;
};

/// Images of a scene under one projected colour; 8 or 16 bit, 3 channels in OpenCV's order (BGR).
struct NamedImages {
  std::string name;
  std::vector<cv::Mat> images;
  std::vector<std::string> sources{};  ///< file names for messages: one per image, or none
};

struct TrainingOptions {
  double min_value = 0.08;  ///< use a pixel if max(R, G, B) >= min_value of full scale; in (0, 1)
  double min_saturation = 0.4;  ///< and if its HSV saturation >= min_saturation; in (0, 1)
};

/// Fits a circular mean and variance of the hue to each colour. Images with the same name are
/// pooled.
/// \throws InvalidInput if the list is empty, an image has the wrong type, an option is outside its
/// range, or too few pixels of a colour are bright and saturated enough.
[[nodiscard]] TrainedColors train_colors(const std::vector<NamedImages>& images,
                                         const TrainingOptions& options = {});

/// Reads the images `<colour>_<anything>.png` of folders, such as `R_flat.png` and `R_sin.png`,
/// grouped by colour. Files that begin with `white_`, `grey_` or `projector_off` do not show a
/// single colour and are skipped.
/// \throws FileError if a folder holds no such image or an image cannot be read.
[[nodiscard]] std::vector<NamedImages> read_training_images(
    const std::vector<std::filesystem::path>& folders);

/// Reads training images and trains the colours with them.
/// \throws FileError as `read_training_images`.
/// \throws InvalidInput as `train_colors`.
[[nodiscard]] TrainedColors train_colors_from_folders(
    const std::vector<std::filesystem::path>& folders, const TrainingOptions& options = {});
[[nodiscard]] TrainedColors train_colors_from_folder(const std::filesystem::path& folder,
                                                     const TrainingOptions& options = {});

/// Reads trained colours from OpenCV FileStorage: `colors` with `name`, `mean`, `variance` and
/// `pixels`.
/// \throws FileError naming the file and the place.
[[nodiscard]] TrainedColors read_trained_colors(const std::filesystem::path& path);

/// Writes trained colours so that `read_trained_colors` reads them back.
/// \throws OutputError if the file cannot be written.
void write_trained_colors(const std::filesystem::path& path, const TrainedColors& colors);

}  // namespace palpate::sensing
