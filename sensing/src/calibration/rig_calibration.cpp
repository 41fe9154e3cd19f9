// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "calibration/rig_advice.h"
#include "calibration/rig_fit.h"
#include "calibration/rig_move.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"

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

void check(const std::vector<RigView>& views) {
  for (const RigView& view : views) {
    if (view.board.cols() != view.camera.cols() ||
        view.lit_camera.cols() != view.projector.cols()) {
      throw InvalidInput("calibrate_rig: view " + view.name +
                         ": the points and their pixels differ in number");
    }
    if (!view.board.allFinite() || !view.camera.allFinite() || !view.lit_camera.allFinite() ||
        !view.projector.allFinite()) {
      throw InvalidInput("calibrate_rig: view " + view.name + ": a point is not finite");
    }
  }
}

/// The reason why a view cannot be used; empty if it can.
std::string what_is_missing(const RigView& view) {
  if (view.camera.cols() == 0) {
    return view.projector.cols() == 0
               ? "the printed board was not found"
               : "the printed board was not found, or no corner lies within the light";
  }
  if (view.camera.cols() < kLeastPoints)
    return fmt::format(
        "only {} of its corners lie within the light of the projector; at least {} are needed",
        view.camera.cols(), kLeastPoints);
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
      const double usual = median(others);
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

/// Largest angle between two boards [rad].
double tilt_range(const std::vector<Eigen::Isometry3d>& T_camera_board) {
  double largest = 0;
  for (const auto& a : T_camera_board) {
    for (const auto& b : T_camera_board) {
      const Eigen::Vector3d n = a.linear().col(2);
      const Eigen::Vector3d m = b.linear().col(2);
      largest = std::max(largest, std::atan2(n.cross(m).norm(), n.dot(m)));
    }
  }
  return largest;
}

double in_degrees(double angle) { return angle * 180 / std::numbers::pi; }

CameraDeviation deviation_of(const Eigen::VectorXd& sigmas) {
  CameraDeviation deviation{sigmas[0], sigmas[1], sigmas[2], sigmas[3], {}};
  for (std::size_t i = 0; i < 5; ++i)
    deviation.distortion.at(i) = sigmas[4 + static_cast<Eigen::Index>(i)];
  return deviation;
}

Eigen::VectorXd deviations(const RigFit& fit, const BundleOptions& options) {
  return bundle_covariance(fit.bundle, fit.views, options).diagonal().cwiseSqrt();
}

void require_determined(const RigFit& fit, const RigCalibrationOptions& limits) {
  const double tilt = tilt_range(fit.bundle.T_camera_board);
  const auto refuse = [&](const std::string& why) {
    throw SolverError(fmt::format(
        "rig calibration: the views do not determine the rig: {}. The boards are inclined to one "
        "another by at most {:.1f} degrees; add views with the board tilted by 20 to 45 degrees "
        "about both its axes, and fill the image.",
        why, in_degrees(tilt)));
  };
  BundleOptions options = fit.options;
  options.camera_sigma = std::max(options.camera_sigma, kLeastCornerSigma);
  options.projector_sigma = std::max(options.projector_sigma, kLeastCornerSigma);
  const Eigen::VectorXd sigmas = deviations(fit, options);
  const auto check_focal = [&](const char* what, double sigma, double length) {
    if (sigma <= limits.max_focal_deviation * length) return;
    refuse(fmt::format("the {}'s focal length is {:.0f} px with a standard deviation of {:.2g} px",
                       what, length, sigma));
  };
  check_focal("camera", std::max(sigmas[0], sigmas[1]), fit.bundle.camera.fx);
  check_focal("projector", std::max(sigmas[9], sigmas[10]), fit.bundle.projector.fx);
  if (!(tilt >= limits.min_tilt))
    refuse(fmt::format("they must be tilted differently, by {:.0f} degrees or more",
                       in_degrees(limits.min_tilt)));
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

/// \throws SolverError if the rig moved while the views were taken.
void require_rigid(const RigFit& fit, const std::vector<RigView>& views,
                   const std::function<RigFit(const std::vector<RigView>&)>& fit_again) {
  const double together = projector_rms(fit);
  if (together <= kHarmlessRms) return;
  const std::optional<RigMove> move = find_move(fit, views, kLeastViews, fit_again);
  if (!move) return;
  throw SolverError(fmt::format(
      "rig calibration: camera and projector moved against each other between {} and {}: the {} "
      "views before and the {} after fit each alone to {:.2g} px RMS in the projector, together "
      "only to {:.2g} px. Fasten both and take all views again, or pass only the views of the rig "
      "as it stands now.",
      views[move->views_before - 1].name, views[move->views_before].name, move->views_before,
      views.size() - move->views_before, move->apart_rms, together));
}

RigCalibration result_of(const RigFit& fit, const std::vector<RigView>& views) {
  RigCalibration result;
  result.rig.camera = fit.bundle.camera;
  result.rig.projector = fit.bundle.projector;
  result.rig.T_projector_camera = fit.bundle.T_projector_camera;
  result.rig.covariance = bundle_covariance(fit.bundle, fit.views, fit.options);
  const Eigen::VectorXd sigmas = result.rig.covariance->diagonal().cwiseSqrt();
  result.depth_deviation = relative_depth_deviation(result.rig, fit);
  result.advice = rig_advice(fit, sigmas);
  for (std::string& warning : uneven_boards(fit, views))
    result.advice.push_back(std::move(warning));
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

void visit(RigCalibrationOptions& options, FieldVisitor& visitor) {
  constexpr int kMostTerms = 5;
  visitor.begin("RigCalibrationOptions");
  visitor.whole({"distortion_terms",
                 "Coefficients of each lens distortion to estimate: 0, 2 (k1 k2), 4 (also p1 p2) "
                 "or 5 (also k3; needs boards that reach the corners of the image)"},
                options.distortion_terms, at_least(0).at_most(kMostTerms));
  constexpr bool kExpert = true;
  visitor.real({"max_residual_ratio",
                "Leave out a view whose RMS residual is more than this many times the median of "
                "the others",
                "", kExpert},
               options.max_residual_ratio, above(1));
  visitor.real({"max_focal_deviation",
                "Refuse views that determine a focal length worse: its standard deviation as a "
                "share of itself",
                "", kExpert},
               options.max_focal_deviation, above(0).below(1));
  visitor.real(
      {"min_tilt", "Refuse views unless two boards are tilted relative to each other by this angle",
       "rad", kExpert},
      options.min_tilt, above(0).at_most(std::numbers::pi / 2));
}

void check_rig_calibration(const RigCalibrationOptions& options) {
  static_cast<void>(in_range(options));
  require_one_of("RigCalibrationOptions::distortion_terms", options.distortion_terms, {0, 2, 4, 5});
}

RigCalibration calibrate_rig(const std::vector<RigView>& views, const ImageSize& camera,
                             const ImageSize& projector, const RigCalibrationOptions& options) {
  check_rig_calibration(options);
  check(views);
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
  const std::vector<RigView> readable = used;
  const auto fit_again = [&](const std::vector<RigView>& some) {
    return fit_rig(some, camera, projector, options.distortion_terms);
  };
  while (true) {
    require_views(used.size(), rejected);
    const RigFit fit = fit_again(used);
    const auto outlier = find_outlier(fit, options.max_residual_ratio);
    if (!outlier) {
      // The smaller group of a rig that moved looks like outliers.
      const bool many_outliers = readable.size() - used.size() >= kLeastViews;
      if (many_outliers) {
        require_rigid(fit_again(readable), readable, fit_again);
      } else {
        require_rigid(fit, used, fit_again);
      }
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
