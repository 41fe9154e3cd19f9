// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace palpate::sensing {

/// Joint response of one channel of projector and camera to the projected level:
///
///     value = black + gain light(level),   light(level) close to (level / last level)^gamma
///
/// Values are fractions of the camera's full scale.
struct ResponseCurve {
  double black = 0;            ///< value at level 0: ambient light and the projector's black level
  double gain = 0;             ///< > 0
  double gamma = 1;            ///< > 0, exponent of the best power law
  double gamma_deviation = 0;  ///< standard deviation of gamma
  double misfit = 0;           ///< RMS of light minus the power law
  std::vector<double> levels;  ///< increasing, from 0, at most 1
  std::vector<double> light;   ///< one per level, increasing from 0 to 1
};

struct Response {
  std::vector<ResponseCurve> channels;  ///< one (grey) or three (blue, green, red)
};

/// A camera image of a uniform grey.
struct GreyImage {
  double level = 0;  ///< projected level, in [0, 1]
  cv::Mat image;     ///< 8 or 16 bit, 1 channel or 3 (BGR)
  std::string name;  ///< used in messages
};

struct ResponseOptions {
  /// A pixel is used if its range over the images >= min_range times the widest ranges; in (0, 1).
  double min_range = 0.5;
  /// The images determine a curve if these widest ranges >= min_contrast of full scale; in (0, 1).
  double min_contrast = 0.05;
};

/// Fits the response of each channel to images of a still scene under uniform greys.
///
/// For each level the fit uses the mean over the pixels that are well lit and not clipped in any
/// image; if fewer than a fifth of the lit pixels remain, the brightest levels are dropped first.
/// The curve is exact for other surfaces if either the camera is linear and the projector a power
/// law, or the other way round, because a power law commutes with the reflectance.
/// \throws InvalidInput, naming the image, if a type is wrong, sizes differ, a level is repeated or
/// out of range, fewer than five levels are not clipped, there is no light, or a brighter level
/// looks darker.
[[nodiscard]] Response calibrate_response(const std::vector<GreyImage>& ramp,
                                          const ResponseOptions& options = {});

/// Reads the images `grey_000.png` ... `grey_255.png` (or `gray_`) of a folder; the number is the
/// level in 1/255.
/// \throws FileError if there are none or one cannot be read.
[[nodiscard]] std::vector<GreyImage> read_grey_ramp(const std::filesystem::path& folder);

/// Makes frames proportional to projected level times reflectance: subtracts black and inverts the
/// curve, beyond its last level by the power law. Uses tables for all values of 8 and 16 bit; may
/// be called from several threads.
class Linearizer {
 public:
  /// \throws InvalidInput if the response is not valid.
  explicit Linearizer(const Response& response);
  /// Returns 16 bit with the same channels; full scale stays full scale, so that clipped pixels can
  /// still be recognised.
  /// \throws InvalidInput unless the frame has 8 or 16 bit and the response's number of channels.
  [[nodiscard]] cv::Mat operator()(const cv::Mat& frame) const;

 private:
  std::vector<std::vector<unsigned short>> narrow_;  ///< by channel, for 8 bit
  std::vector<std::vector<unsigned short>> wide_;    ///< for 16 bit
};

/// Linearises a single frame.
[[nodiscard]] cv::Mat linearize(const cv::Mat& frame, const Response& response);

/// Reads a response from OpenCV FileStorage: `response`, one item per channel, with the member
/// names of `ResponseCurve`.
/// \throws FileError naming the file and the key.
[[nodiscard]] Response read_response(const std::filesystem::path& path);
/// Writes a response so that `read_response` reads it back.
/// \throws OutputError if the file cannot be written.
void write_response(const std::filesystem::path& path, const Response& response);

}  // namespace palpate::sensing
