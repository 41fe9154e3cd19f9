// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/chromatic_calibration.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "calibration/period_count.h"
#include "calibration/white_view.h"
#include "image/hue.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/sensing/pattern_image.h"
#include "phase/chromatic.h"

namespace palpate::sensing {
namespace {

/// Smallest number of phase measurements for three parameters and their deviations.
constexpr std::size_t kLeastPhases = 30;
/// Below this `separation` only noise separates the parameters.
constexpr double kLeastSeparation = 0.01;
/// Tukey's weights are zero beyond this many robust standard deviations.
constexpr double kTukey = 4.685;
/// Factor from the median absolute deviation to the standard deviation of a Gaussian.
constexpr double kMadToSigma = 1.4826;
/// Smallest deviation of a phase [rad]; keeps the weights defined for perfect images.
constexpr double kLeastPhaseSigma = 1e-6;
constexpr int kMaxSteps = 30;
/// Iteration ends when the compensated phase changes by at most this [rad RMS], a thousandth of the
/// measurement error of a phase.
constexpr double kStepTolerance = 1e-6;
/// The start is searched in steps that change the phase by at most this [rad], far less than the pi
/// at which Gauss-Newton would diverge.
constexpr double kStartStep = 0.5;
/// Residuals within blocks of this many pixels are treated as correlated: slow errors of the lens
/// models and of the light have this size or a larger one.
constexpr int kBlock = 64;

/// A prepared image.
struct PreparedImage {
  WhiteView phases;
  std::vector<Eigen::Vector3d> rays;  ///< (x, y, 1) of the camera at the cells' centres
};

struct Problem {
  const Rig& rig;
  const Pattern& pattern;
  Carrier carrier;
  std::vector<PreparedImage> views;
};

/// Phase difference to green of all cells, and its derivatives by alpha, beta, gamma.
struct Residuals {
  Eigen::VectorXd value;  ///< [rad] in (-pi, pi]
  Eigen::MatrixX3d jacobian;
};

void check_options(const ChromaticCalibrationOptions& options) {
  require("ChromaticCalibrationOptions::min_signal", options.min_signal, above(0).below(1));
  require("ChromaticCalibrationOptions::min_modulation", options.min_modulation, above(0).below(1));
  require("ChromaticCalibrationOptions::min_contrast", options.min_contrast, above(0).below(1));
  require("ChromaticCalibrationOptions::search_range", options.search_range, above(0).at_most(0.2));
}

void check_image(const WhiteImage& white, const geometry::Camera& camera) {
  const cv::Mat& image = white.image;
  if (image.cols != camera.width || image.rows != camera.height || image.channels() != 3) {
    throw InvalidInput(white.name + ": is " + std::to_string(image.cols) + " x " +
                       std::to_string(image.rows) + " px with " + std::to_string(image.channels()) +
                       (image.channels() == 1 ? " channel" : " channels") +
                       "; three channels of the rig's camera, " + std::to_string(camera.width) +
                       " x " + std::to_string(camera.height) + " px, are expected");
  }
  if (white.depth &&
      (white.depth->cols() != camera.width || white.depth->rows() != camera.height)) {
    throw InvalidInput(white.name + ": depth: is " + std::to_string(white.depth->cols()) + " x " +
                       std::to_string(white.depth->rows()) + " px; the camera's size is expected");
  }
}

Problem prepare(const std::vector<WhiteImage>& images, const Rig& rig, const Pattern& pattern,
                const ChromaticCalibrationOptions& options, std::vector<WhiteImageUse>& uses) {
  Problem problem{rig, pattern, expected_carrier(rig, pattern), {}};
  for (const WhiteImage& white : images) {
    check_image(white, rig.camera);
    PreparedImage view{
        measure_white_view(white.image, problem.carrier, rig.color_mixing, pattern, options), {}};
    WhiteImageUse use;
    use.name = white.name;
    const PeriodCount count =
        count_periods(view.phases, problem.carrier, rig, pattern, white.depth);
    use.problem = count.problem;
    if (!white.depth) use.period_deviation = count.deviation;
    use.cells = static_cast<int>(view.phases.cells.size());
    if (use.cells > 0) {
      std::vector<double> depths;
      for (const PhaseCell& cell : view.phases.cells) {
        depths.push_back(cell.depth);
        const Eigen::Vector2d pixel = camera_pixel(cell, problem.carrier);
        view.rays.push_back(geometry::undistort(rig.camera, pixel).homogeneous());
      }
      use.median_depth = median(depths);
      problem.views.push_back(std::move(view));
    }
    uses.push_back(std::move(use));
  }
  return problem;
}

std::size_t count_cells(const Problem& problem) {
  std::size_t count = 0;
  for (const PreparedImage& view : problem.views) count += view.phases.cells.size();
  return count;
}

/// Place at which a channel shows what green shows on a ray: (row, column) of the working image.
Eigen::Vector2d place_in_channel(const Problem& problem, const Eigen::Vector3d& ray, double alpha) {
  const Eigen::Vector2d pixel = geometry::distort(problem.rig.camera, ray.head<2>() / alpha);
  return problem.carrier.transposed ? pixel : Eigen::Vector2d(pixel.y(), pixel.x());
}

/// Derivative of that place by alpha.
Eigen::Vector2d place_by_alpha(const Problem& problem, const Eigen::Vector3d& ray, double alpha) {
  constexpr double kHalfStep = 1e-4;
  return (place_in_channel(problem, ray, alpha + kHalfStep) -
          place_in_channel(problem, ray, alpha - kHalfStep)) /
         (2 * kHalfStep);
}

/// Interpolates a signal bilinearly in re and im, which vary slowly. Zero outside.
std::complex<double> sample(const Demodulated& signal, const Eigen::Vector2d& place) {
  const Eigen::Vector2d corner = place.array().floor();
  if (!(corner.minCoeff() >= 0) || !(corner.x() + 1 < static_cast<double>(signal.re.rows())) ||
      !(corner.y() + 1 < static_cast<double>(signal.re.cols())))
    return 0;
  const auto row = static_cast<long>(corner.x());
  const auto column = static_cast<long>(corner.y());
  const Eigen::Vector2d part = place - corner;
  const auto value = [&](const Plane& plane) {
    const auto at = [&](long down, long right) {
      return static_cast<double>(plane(row + down, column + right));
    };
    const double upper = (1 - part.y()) * at(0, 0) + part.y() * at(0, 1);
    const double lower = (1 - part.y()) * at(1, 0) + part.y() * at(1, 1);
    return (1 - part.x()) * upper + part.x() * lower;
  };
  return {value(signal.re), value(signal.im)};
}

/// Mean phase over a cell of a channel relative to green, at the places where green's pixels appear
/// in the channel.
/// \param center the place of the cell's centre in the channel.
double relative_phase(const WhiteView& view, const Demodulated& channel, const PhaseCell& cell,
                      const Eigen::Vector2d& center, double alpha, double carrier) {
  std::complex<double> sum = 0;
  for (long row = cell.row; row < cell.row + view.cell_size; ++row) {
    for (long column = cell.column; column < cell.column + view.cell_size; ++column) {
      if (view.reliable(row, column) == 0) continue;
      const Eigen::Vector2d pixel(static_cast<double>(row), static_cast<double>(column));
      const Eigen::Vector2d place = center + (pixel - cell.center) / alpha;
      const std::complex<double> green(static_cast<double>(view.green.re(row, column)),
                                       static_cast<double>(view.green.im(row, column)));
      sum += sample(channel, place) * std::polar(1.0, carrier * (place.x() - pixel.x())) *
             std::conj(green);
    }
  }
  return std::arg(sum);
}

/// \param channel 0 red, 1 blue.
Residuals evaluate(const Problem& problem, std::size_t channel, const ChromaticShift& shift) {
  const geometry::Camera& projector = problem.rig.projector;
  const bool along_x = problem.pattern.axis == Axis::x;
  const double focal = along_x ? projector.fx : projector.fy;
  const double axis_pixel = along_x ? projector.cx : projector.cy;  // on the optical axis
  const double per_pixel = kFullTurn / problem.pattern.period;
  const ChromaticLag lag = chromatic_lag(shift, projector, problem.pattern);

  const auto count = static_cast<Eigen::Index>(count_cells(problem));
  Residuals residuals{Eigen::VectorXd(count), Eigen::MatrixX3d(count, 3)};
  Eigen::Index i = 0;
  for (const PreparedImage& view : problem.views) {
    const Demodulated& signal = view.phases.others[channel];
    for (std::size_t k = 0; k < view.phases.cells.size(); ++k, ++i) {
      const PhaseCell& cell = view.phases.cells[k];
      const Eigen::Vector2d center = place_in_channel(problem, view.rays[k], shift.alpha);
      const double difference =
          relative_phase(view.phases, signal, cell, center, shift.alpha, problem.carrier.along) +
          lag.at(cell.pixel);
      residuals.value[i] = std::remainder(difference, kFullTurn);
      const double panel =
          (cell.pixel - axis_pixel - focal * shift.gamma) / shift.beta;  // the channel's
      residuals.jacobian.row(i) << cell.gradient.dot(
          place_by_alpha(problem, view.rays[k], shift.alpha)),
          per_pixel * panel / shift.beta, per_pixel * focal / shift.beta;
    }
  }
  return residuals;
}

/// The shift at which the phases of most cells agree up to whole turns. The residuals are taken as
/// linear in alpha and beta; gamma adds the same phase to all.
ChromaticShift find_start(const Residuals& at_none, double range) {
  const auto steps = [&](int column) {
    const double largest = at_none.jacobian.col(column).cwiseAbs().maxCoeff();
    return std::max(1, static_cast<int>(std::ceil(range * largest / kStartStep)));
  };
  const int alpha_steps = steps(0);
  const int beta_steps = steps(1);
  ChromaticShift start;
  double best = -1;
  for (int a = -alpha_steps; a <= alpha_steps; ++a) {
    for (int b = -beta_steps; b <= beta_steps; ++b) {
      const double alpha = range * a / alpha_steps;
      const double beta = range * b / beta_steps;
      const Eigen::ArrayXd phase =
          at_none.value + alpha * at_none.jacobian.col(0) + beta * at_none.jacobian.col(1);
      const std::complex<double> sum(phase.cos().sum(), phase.sin().sum());
      if (std::abs(sum) <= best) continue;
      best = std::abs(sum);
      start = {
          .alpha = 1 + alpha, .beta = 1 + beta, .gamma = -std::arg(sum) / at_none.jacobian(0, 2)};
    }
  }
  return start;
}

/// Tukey's weights of residuals.
Eigen::VectorXd robust_weights(const Eigen::VectorXd& residuals) {
  std::vector<double> sizes(residuals.data(), residuals.data() + residuals.size());
  for (double& size : sizes) size = std::abs(size);
  const double limit = kTukey * std::max(kMadToSigma * median(sizes), kLeastPhaseSigma);
  const Eigen::ArrayXd inside = (1 - (residuals.array() / limit).square()).max(0);
  return inside.square();
}

double weighted_rms(const Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
  return std::sqrt(values.cwiseAbs2().dot(weights) / weights.sum());
}

/// Index of the correlated group of a cell: image, and block of the image.
std::vector<int> blocks_of_cells(const Problem& problem) {
  std::map<std::tuple<std::size_t, long, long>, int> number;
  std::vector<int> blocks;
  for (std::size_t view = 0; view < problem.views.size(); ++view) {
    for (const PhaseCell& cell : problem.views[view].phases.cells) {
      const std::tuple key(view, cell.row / kBlock, cell.column / kBlock);
      blocks.push_back(number.emplace(key, static_cast<int>(number.size())).first->second);
    }
  }
  return blocks;
}

/// Covariance of the parameters for residuals that are correlated within a block (Liang and Zeger's
/// sandwich): B (sum over blocks of s s^T) B, where B is the inverse normal matrix and s the
/// block's sum of weighted residual times Jacobian row.
Eigen::Matrix3d covariance(const Residuals& residuals, const Eigen::VectorXd& weights,
                           const std::vector<int>& blocks) {
  const Eigen::Matrix3d normal =
      residuals.jacobian.transpose() * weights.asDiagonal() * residuals.jacobian;
  const int count = 1 + *std::max_element(blocks.begin(), blocks.end());
  Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, count);
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    sums.col(blocks[static_cast<std::size_t>(i)]) +=
        weights[i] * residuals.value[i] * residuals.jacobian.row(i).transpose();
  }
  const Eigen::Matrix3d bread = normal.inverse();  // small, and known to be well conditioned
  const double freedom = static_cast<double>(count) / std::max(1, count - 3);
  return freedom * bread * (sums * sums.transpose()) * bread;
}

double separation_of(const Eigen::MatrixX3d& jacobian) {
  const Eigen::MatrixX3d scaled =
      jacobian.array().rowwise() /
      jacobian.colwise().norm().array().max(std::numeric_limits<double>::min());
  const Eigen::Matrix3d gram = scaled.transpose() * scaled;
  return std::sqrt(gram.jacobiSvd().singularValues().minCoeff());
}

/// Reasons why images were not used, for messages.
std::string reasons(const std::vector<WhiteImageUse>& uses) {
  std::string text;
  for (const WhiteImageUse& use : uses) {
    if (!use.problem.empty()) text += "; " + use.name + ": " + use.problem;
  }
  return text;
}

ChannelCalibration calibrate_channel(const Problem& problem, std::size_t channel, double range) {
  const Residuals at_none = evaluate(problem, channel, {});
  ChannelCalibration result;
  result.separation = separation_of(at_none.jacobian);
  ChromaticShift shift = find_start(at_none, range);
  Residuals residuals = evaluate(problem, channel, shift);
  Eigen::VectorXd weights = robust_weights(residuals.value);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::VectorXd roots = weights.cwiseSqrt();
    const Eigen::Vector3d change = (roots.asDiagonal() * residuals.jacobian)
                                       .colPivHouseholderQr()
                                       .solve(-roots.cwiseProduct(residuals.value));
    if (!change.allFinite()) break;
    const double moved = weighted_rms(residuals.jacobian * change, weights);
    shift.alpha += change[0];
    shift.beta += change[1];
    shift.gamma += change[2];
    if (std::abs(shift.alpha - 1) > 2 * range || std::abs(shift.beta - 1) > 2 * range) {
      throw SolverError(
          "calibrate_chromatic: found no shifts within the search range that bring the channels "
          "together; check that rig, pattern and images belong together");
    }
    residuals = evaluate(problem, channel, shift);
    weights = robust_weights(residuals.value);
    if (moved <= kStepTolerance) break;
  }
  const Eigen::Vector3d deviation =
      covariance(residuals, weights, blocks_of_cells(problem)).diagonal().cwiseSqrt();
  result.shift = shift;
  result.deviation = {.alpha = deviation[0], .beta = deviation[1], .gamma = deviation[2]};
  result.rms_before = weighted_rms(at_none.value, weights);
  result.rms_after = weighted_rms(residuals.value, weights);
  result.cells = static_cast<int>((weights.array() > 0).count());
  result.outliers = static_cast<int>(weights.size()) - result.cells;
  return result;
}

}  // namespace

ChromaticCalibration calibrate_chromatic(const std::vector<WhiteImage>& images, const Rig& rig,
                                         const Pattern& pattern,
                                         const ChromaticCalibrationOptions& options) {
  check_rig(rig, "rig");
  check_pattern(pattern, "pattern");
  check_pattern_fits(without_stripes(pattern), rig.projector, "pattern");
  check_options(options);
  if (images.empty()) throw InvalidInput("calibrate_chromatic: no images");
  ChromaticCalibration result;
  const Problem problem = prepare(images, rig, pattern, options, result.images);
  if (count_cells(problem) < kLeastPhases) {
    throw SolverError("calibrate_chromatic: too few reliable phases" + reasons(result.images));
  }
  const double separation = separation_of(evaluate(problem, 0, {}).jacobian);
  if (!(separation > kLeastSeparation)) {
    throw SolverError(
        "calibrate_chromatic: the images do not tell alpha, beta and gamma apart: "
        "surfaces at several distances are needed, the farthest at least a tenth "
        "farther than the nearest" +
        reasons(result.images));
  }
  result.red = calibrate_channel(problem, 0, options.search_range);
  result.blue = calibrate_channel(problem, 1, options.search_range);
  return result;
}

}  // namespace palpate::sensing
