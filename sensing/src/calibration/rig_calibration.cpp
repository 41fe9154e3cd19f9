// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "calibration/lens_calibration.h"
#include "calibration/rig_bundle.h"
#include "palpate/error.h"
#include "palpate/geometry/median.h"
#include "palpate/require.h"

namespace palpate::sensing {
namespace {

/// Smallest number of views: two would determine the parameters without any redundancy.
constexpr std::size_t kLeastViews = 3;
/// A view with fewer points hardly determines its own pose.
constexpr Eigen::Index kLeastPoints = 8;
/// Smallest standard deviation of corners [px]. Otherwise exact data of a board that does not
/// determine the rig would seem to determine it.
constexpr double kLeastCornerSigma = 0.02;
/// Residuals below this [px] never make an outlier.
constexpr double kHarmlessRms = 0.1;

void check(const std::vector<RigView>& views, const RigCalibrationOptions& options) {
  require_one_of("RigCalibrationOptions::distortion_terms", options.distortion_terms, {0, 2, 4, 5});
  require("RigCalibrationOptions::max_residual_ratio", options.max_residual_ratio, above(1));
  require("RigCalibrationOptions::max_focal_deviation", options.max_focal_deviation,
          above(0).below(1));
  require("RigCalibrationOptions::min_tilt_deg", options.min_tilt_deg, above(0), "degrees");
  const auto any = [&](auto lit) {
    return std::any_of(views.begin(), views.end(),
                       [&](const RigView& view) { return (view.*lit).cols() > 0; });
  };
  if (any(&RigView::lit_board) && any(&RigView::lit_camera))
    throw InvalidInput("calibrate_rig: views of both kinds, lit_board and lit_camera, are mixed");
  for (const RigView& view : views) {
    if (view.board.cols() != view.camera.cols() ||
        view.lit_board.cols() + view.lit_camera.cols() != view.projector.cols()) {
      throw InvalidInput("calibrate_rig: view " + view.name +
                         ": the points and their pixels differ in number");
    }
    if (!view.board.allFinite() || !view.camera.allFinite() || !view.lit_board.allFinite() ||
        !view.lit_camera.allFinite() || !view.projector.allFinite()) {
      throw InvalidInput("calibrate_rig: view " + view.name + ": a point is not finite");
    }
  }
}

/// Why a view cannot be used; empty if it can.
std::string what_is_missing(const RigView& view) {
  if (view.camera.cols() == 0) return "the printed board was not found";
  if (view.camera.cols() < kLeastPoints)
    return fmt::format("the camera sees only {} points; at least {} are needed", view.camera.cols(),
                       kLeastPoints);
  if (view.projector.cols() == 0)
    return "no point of it is known in the projector: the projected board was not found, or no "
           "code "
           "could be read";
  if (view.projector.cols() < kLeastPoints)
    return fmt::format(
        "only {} of its points could be read in the projector; at least {} are needed",
        view.projector.cols(), kLeastPoints);
  return {};
}

/// Points of the board that camera pixels see.
Eigen::Matrix2Xd on_board(const Eigen::Matrix2Xd& pixels, const geometry::Camera& camera,
                          const Eigen::Isometry3d& T_camera_board) {
  const Eigen::Isometry3d T_board_camera = T_camera_board.inverse();
  const Eigen::Vector3d eye = T_board_camera.translation();
  Eigen::Matrix2Xd points(2, pixels.cols());
  for (Eigen::Index i = 0; i < pixels.cols(); ++i) {
    const Eigen::Vector3d ray =
        T_board_camera.linear() * geometry::undistort(camera, pixels.col(i)).homogeneous();
    points.col(i) = (eye - eye.z() / ray.z() * ray).head<2>();
  }
  return points;
}

std::vector<BundleView> bundle_views(const std::vector<RigView>& views,
                                     const LensCalibration& camera) {
  std::vector<BundleView> result;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const bool from_camera = views[v].lit_board.cols() == 0;
    result.push_back({views[v].board, views[v].camera,
                      from_camera
                          ? on_board(views[v].lit_camera, camera.lens, camera.T_lens_board[v])
                          : views[v].lit_board,
                      views[v].projector});
    if (!result.back().lit_board.allFinite())
      throw SolverError("rig calibration: view " + views[v].name +
                        ": the camera's rays do not meet the board");
  }
  return result;
}

/// Sums over all views of one bundle.
struct Squares {
  double camera = 0, projector = 0;  ///< px^2
  double camera_points = 0, projector_points = 0;
};

Squares sum_squares(const Bundle& bundle, const std::vector<BundleView>& views) {
  Squares sum;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BundleResiduals residuals = bundle_residuals(bundle, views[v], v);
    sum.camera += residuals.camera.squaredNorm();
    sum.projector += residuals.projector.squaredNorm();
    sum.camera_points += static_cast<double>(residuals.camera.cols());
    sum.projector_points += static_cast<double>(residuals.projector.cols());
  }
  return sum;
}

/// Result of the joint estimate, with its accuracy.
struct RigFit {
  Bundle bundle;
  std::vector<BundleView> views;
  BundleOptions options;
  LensCalibration camera_alone;
};

/// Among the poses of the single views, the one that fits all views best.
Eigen::Isometry3d first_pose(Bundle bundle, const std::vector<BundleView>& views,
                             const LensCalibration& projector) {
  double least = std::numeric_limits<double>::infinity();
  Eigen::Isometry3d best = Eigen::Isometry3d::Identity();
  for (std::size_t v = 0; v < views.size(); ++v) {
    bundle.T_projector_camera = projector.T_lens_board[v] * bundle.T_camera_board[v].inverse();
    const double squares = sum_squares(bundle, views).projector;
    if (squares < least) {
      least = squares;
      best = bundle.T_projector_camera;
    }
  }
  return best;
}

/// Standard deviations of the camera's and the projector's coordinates, from the residuals.
void set_sigmas(BundleOptions& options, const Squares& left, std::size_t views, double least) {
  const double lens = 4.0 + options.distortion_terms;
  const double equations = 2 * (left.camera_points + left.projector_points);
  const double parameters = 2 * lens + 6 + 6 * static_cast<double>(views);
  // Each equation bears the same share of the parameters.
  const double share = std::max(1 - parameters / equations, 1 / equations);
  options.camera_sigma = std::max(std::sqrt(left.camera / (2 * left.camera_points * share)), least);
  options.projector_sigma =
      std::max(std::sqrt(left.projector / (2 * left.projector_points * share)), least);
}

RigFit fit_views(const std::vector<RigView>& views, const ImageSize& camera_size,
                 const ImageSize& projector_size, int distortion_terms) {
  std::vector<Eigen::Matrix2Xd> points;
  std::vector<Eigen::Matrix2Xd> seen;
  std::vector<Eigen::Matrix2Xd> shown;
  for (const RigView& view : views) {
    points.push_back(view.board);
    seen.push_back(view.camera);
    shown.push_back(view.projector);
  }
  RigFit fit;
  fit.options.distortion_terms = distortion_terms;
  fit.options.camera_is_fixed = views.front().lit_board.cols() == 0;
  const auto alone = [&](const char* what, const std::vector<Eigen::Matrix2Xd>& board,
                         const std::vector<Eigen::Matrix2Xd>& pixels, const ImageSize& size) {
    try {
      return calibrate_lens(board, pixels, {.width = size.width, .height = size.height},
                            distortion_terms);
    } catch (const SolverError& error) {
      throw SolverError(std::string("rig calibration: ") + what + ": " + error.what());
    }
  };
  fit.camera_alone = alone("camera", points, seen, camera_size);
  fit.views = bundle_views(views, fit.camera_alone);
  std::vector<Eigen::Matrix2Xd> lit;
  for (const BundleView& view : fit.views) lit.push_back(view.lit_board);
  const LensCalibration projector = alone("projector", lit, shown, projector_size);

  fit.bundle = {fit.camera_alone.lens, projector.lens, Eigen::Isometry3d::Identity(),
                fit.camera_alone.T_lens_board};
  fit.bundle.T_projector_camera = first_pose(fit.bundle, fit.views, projector);
  // Weights and residuals depend on each other; after two rounds neither changes.
  constexpr double kLeastWeightSigma = 1e-4;  // px: exact numbers must not give infinite weights
  fit.options.camera_sigma = std::max(fit.camera_alone.rms, kLeastWeightSigma);
  fit.options.projector_sigma = std::max(projector.rms, kLeastWeightSigma);
  for (int round = 0; round < 3; ++round) {
    fit.bundle = refine_bundle(fit.bundle, fit.views, fit.options);
    set_sigmas(fit.options, sum_squares(fit.bundle, fit.views), views.size(), kLeastWeightSigma);
  }
  return fit;
}

double rms(const Eigen::Matrix2Xd& residuals) {
  return std::sqrt(residuals.squaredNorm() / static_cast<double>(residuals.cols()));
}

/// The worst-fitting view, if it fits much worse than the others.
struct Outlier {
  std::size_t view = 0;
  std::string reason;
};
std::optional<Outlier> find_outlier(const RigFit& fit, double max_ratio) {
  std::vector<double> camera;
  std::vector<double> projector;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    const BundleResiduals residuals = bundle_residuals(fit.bundle, fit.views[v], v);
    camera.push_back(rms(residuals.camera));
    projector.push_back(rms(residuals.projector));
  }
  std::optional<Outlier> worst;
  double worst_ratio = max_ratio;
  const auto look = [&](const std::vector<double>& values, const char* what) {
    for (std::size_t v = 0; v < values.size(); ++v) {
      std::vector<double> others = values;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(v));
      const double usual = geometry::median(std::move(others));
      const double ratio = values[v] / std::max(usual, kHarmlessRms);
      if (ratio <= worst_ratio) continue;
      worst_ratio = ratio;
      worst = Outlier{v, fmt::format("an outlier: its {} residuals are {:.2f} px RMS, those of the "
                                     "other views {:.2f} px",
                                     what, values[v], usual)};
    }
  };
  look(camera, "camera");
  look(projector, "projector");
  return worst;
}

/// Largest angle between two boards [degrees].
double tilt_range(const std::vector<Eigen::Isometry3d>& T_camera_board) {
  double largest = 0;
  for (const auto& a : T_camera_board) {
    for (const auto& b : T_camera_board) {
      const Eigen::Vector3d n = a.linear().col(2);
      const Eigen::Vector3d m = b.linear().col(2);
      largest = std::max(largest, std::atan2(n.cross(m).norm(), n.dot(m)));
    }
  }
  return largest * 180 / std::numbers::pi;
}

CameraDeviation deviation_of(const Eigen::VectorXd& sigmas) {
  CameraDeviation deviation{sigmas[0], sigmas[1], sigmas[2], sigmas[3], {}};
  for (std::size_t i = 0; i < 5; ++i)
    deviation.distortion.at(i) = sigmas[4 + static_cast<Eigen::Index>(i)];
  return deviation;
}

Eigen::VectorXd deviations(const RigFit& fit, const BundleOptions& options) {
  Eigen::VectorXd sigmas = bundle_covariance(fit.bundle, fit.views, options).diagonal().cwiseSqrt();
  if (options.camera_is_fixed)
    for (int i = 0; i < 9; ++i)
      sigmas[i] = fit.camera_alone.deviation.at(static_cast<std::size_t>(i));
  return sigmas;
}

void require_determined(const RigFit& fit, const RigCalibrationOptions& limits) {
  const double tilt = tilt_range(fit.bundle.T_camera_board);
  const auto refuse = [&](const std::string& why) {
    throw SolverError(fmt::format(
        "rig calibration: the views do not determine the rig: {}. The boards are inclined to one "
        "another by at most {:.1f} degrees; add views with the board tilted by 20 to 45 degrees "
        "about both its axes, and fill the image.",
        why, tilt));
  };
  BundleOptions options = fit.options;
  options.camera_sigma = std::max(options.camera_sigma, kLeastCornerSigma);
  options.projector_sigma = std::max(options.projector_sigma, kLeastCornerSigma);
  Eigen::VectorXd sigmas = deviations(fit, options);
  if (options.camera_is_fixed) sigmas.head<9>() *= options.camera_sigma / fit.options.camera_sigma;
  const auto check_focal = [&](const char* what, double sigma, double length) {
    if (sigma <= limits.max_focal_deviation * length) return;
    refuse(fmt::format("the {}'s focal length is {:.0f} px with a standard deviation of {:.2g} px",
                       what, length, sigma));
  };
  check_focal("camera", std::max(sigmas[0], sigmas[1]), fit.bundle.camera.fx);
  check_focal("projector", std::max(sigmas[9], sigmas[10]), fit.bundle.projector.fx);
  if (!(tilt >= limits.min_tilt_deg))
    refuse(fmt::format("they must be tilted differently, by {:.0f} degrees or more",
                       limits.min_tilt_deg));
}

void require_views(std::size_t count, const std::vector<RejectedView>& rejected) {
  if (count >= kLeastViews) return;
  std::string why;
  for (const RejectedView& view : rejected) why += "\n  " + view.name + ": " + view.reason;
  throw SolverError(fmt::format(
      "rig calibration: {} views can be used; at least {} are needed, with the board tilted "
      "differently in each.{}{}",
      count, kLeastViews, why.empty() ? "" : " Rejected:", why));
}

RigCalibration result_of(const RigFit& fit, const std::vector<RigView>& views) {
  RigCalibration result;
  result.rig.camera = fit.bundle.camera;
  result.rig.projector = fit.bundle.projector;
  result.rig.T_projector_camera = fit.bundle.T_projector_camera;
  const Eigen::VectorXd sigmas = deviations(fit, fit.options);
  result.camera_deviation = deviation_of(sigmas.head<9>());
  result.projector_deviation = deviation_of(sigmas.segment<9>(9));
  result.rotation_deviation = sigmas.segment<3>(18);
  result.translation_deviation = sigmas.tail<3>();
  const Squares sum = sum_squares(fit.bundle, fit.views);
  result.camera_rms = std::sqrt(sum.camera / sum.camera_points);
  result.projector_rms = std::sqrt(sum.projector / sum.projector_points);
  result.stereo_rms =
      std::sqrt((sum.camera + sum.projector) / (sum.camera_points + sum.projector_points));
  for (std::size_t v = 0; v < views.size(); ++v) {
    BundleResiduals residuals = bundle_residuals(fit.bundle, fit.views[v], v);
    result.views.push_back({views[v].name, rms(residuals.camera), rms(residuals.projector),
                            fit.bundle.T_camera_board[v], views[v].camera,
                            std::move(residuals.camera), views[v].projector,
                            std::move(residuals.projector)});
  }
  return result;
}

}  // namespace

RigCalibration calibrate_rig(const std::vector<RigView>& views, const ImageSize& camera,
                             const ImageSize& projector, const RigCalibrationOptions& options) {
  check(views, options);
  std::vector<RejectedView> rejected;
  std::vector<RigView> used;
  for (const RigView& view : views) {
    const std::string reason = what_is_missing(view);
    if (reason.empty()) {
      used.push_back(view);
    } else {
      rejected.push_back({view.name, reason});
    }
  }
  while (true) {
    require_views(used.size(), rejected);
    const RigFit fit = fit_views(used, camera, projector, options.distortion_terms);
    const auto outlier = find_outlier(fit, options.max_residual_ratio);
    if (!outlier) {
      require_determined(fit, options);
      RigCalibration result = result_of(fit, used);
      result.rejected = std::move(rejected);
      return result;
    }
    rejected.push_back({used[outlier->view].name, outlier->reason});
    used.erase(used.begin() + static_cast<std::ptrdiff_t>(outlier->view));
  }
}

}  // namespace palpate::sensing
