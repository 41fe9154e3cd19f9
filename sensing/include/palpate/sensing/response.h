// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace palpate::sensing {

/// How one channel of a projector and a camera together answer to the level that is projected:
///
///     value = black + gain light(level),   light(level) nearly (level / last level)^gamma
///
/// values as fractions of the camera's full scale.
struct ResponseCurve {
  double black = 0;            ///< seen at level 0: room light and what the projector leaks
  double gain = 0;             ///< > 0
  double gamma = 1;            ///< > 0, of the power law that fits best
  double gamma_deviation = 0;  ///< its standard deviation
  double misfit = 0;           ///< RMS of light minus the power law
  std::vector<double> levels;  ///< rising, from 0, at most 1
  std::vector<double> light;   ///< as many, rising from 0 to 1
};

struct Response {
  std::vector<ResponseCurve> channels;  ///< one (grey), or three: blue, green, red
};

/// What the camera saw of a uniform grey.
struct GreyImage {
  double level = 0;  ///< projected, in [0, 1]
  cv::Mat image;     ///< 8 or 16 bit, 1 channel or 3 (BGR)
  std::string name;  ///< in messages
};

struct ResponseOptions {
  /// A pixel counts iff its range over the images >= min_range of the widest ranges; in (0, 1).
  double min_range = 0.5;
  /// The images tell a curve iff those widest ranges >= min_contrast of full scale; in (0, 1).
  double min_contrast = 0.05;
};

/// Fits the response of each channel to grey ramps of a still scene.
///
/// The mean over the pixels that the projector lights well and that no image clips is taken for
/// each level; if fewer than a fifth of the lit pixels are left, the brightest levels are dropped
/// first. The curve holds exactly for other surfaces if either the camera is linear and the
/// projector a power law, or the other way round: a power commutes with the reflectance.
/// \throws InvalidInput, naming the image, on a wrong type, sizes that differ, a level twice or out
/// of range, fewer than five levels that are not clipped, no light, or a brighter level that looks
/// darker.
[[nodiscard]] Response calibrate_response(const std::vector<GreyImage>& ramp,
                                          const ResponseOptions& options = {});

/// The images `grey_000.png` ... `grey_255.png` of a folder, the level in 255ths in the name
/// (`gray_` too). \throws FileError if there are none or one cannot be read.
[[nodiscard]] std::vector<GreyImage> read_grey_ramp(const std::filesystem::path& folder);

/// Makes frames proportional to the projected level, times the reflectance: black is taken off and
/// the curve inverted, beyond its last level by the power law. Keeps tables for all values of 8 and
/// 16 bit; may be used in several threads.
class Linearizer {
 public:
  /// \throws InvalidInput if the response is not valid.
  explicit Linearizer(const Response& response);
  /// 16 bit, as many channels; full scale stays full scale, so that clipped pixels can be told.
  /// \throws InvalidInput unless the frame has 8 or 16 bit and the response's number of channels.
  [[nodiscard]] cv::Mat operator()(const cv::Mat& frame) const;

 private:
  std::vector<std::vector<unsigned short>> narrow_;  ///< by channel, for 8 bit
  std::vector<std::vector<unsigned short>> wide_;    ///< for 16 bit
};

/// The same for one frame.
[[nodiscard]] cv::Mat linearize(const cv::Mat& frame, const Response& response);

/// Reads and writes a response (OpenCV FileStorage: `response`, one item a channel, with the names
/// above). \throws FileError naming the file and the key; OutputError.
[[nodiscard]] Response read_response(const std::filesystem::path& path);
void write_response(const std::filesystem::path& path, const Response& response);

}  // namespace palpate::sensing
