// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/rig_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calibration/lens_calibration.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"

namespace palpate::sensing {
namespace {

std::vector<BundleView> bundle_views(const std::vector<RigView>& views) {
  std::vector<BundleView> result;
  result.reserve(views.size());
  for (const RigView& view : views) {
    result.push_back({view.board, view.camera, Eigen::VectorXd::Ones(view.camera.cols()),
                      view.lit_camera, view.projector,
                      Eigen::VectorXd::Ones(view.projector.cols())});
  }
  return result;
}

/// At most this many points of a view, evenly chosen, start a lens: OpenCV takes long for
/// thousands.
constexpr Eigen::Index kStartPoints = 120;

Eigen::Matrix2Xd thinned(const Eigen::Matrix2Xd& points) {
  const Eigen::Index step = points.cols() / kStartPoints + 1;
  Eigen::Matrix2Xd some(2, (points.cols() + step - 1) / step);
  for (Eigen::Index i = 0; i < some.cols(); ++i) some.col(i) = points.col(i * step);
  return some;
}

/// The lit points in the board's plane [mm].
Eigen::Matrix2Xd lit_on_board(const RigView& view, const geometry::Camera& camera,
                              const Eigen::Isometry3d& T_camera_board) {
  const Eigen::Matrix3Xd points = lit_points(camera, T_camera_board, view.lit_camera);
  if (!points.allFinite())
    throw SolverError("rig calibration: view " + view.name +
                      ": the camera's rays do not meet the board");
  return (T_camera_board.inverse() * points).topRows<2>();
}

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

/// Gives less weight to points whose residuals are long: their share in the sum of squares is that
/// of a residual of kLongest standard deviations.
void set_weights(const Bundle& bundle, std::vector<BundleView>& views) {
  constexpr double kLongest = 3;            // of normal residuals, 1 % are longer
  constexpr double kMedianLength = 1.1774;  // of two normal coordinates [standard deviations]
  constexpr double kLeastLength = 1e-4;     // px: exact numbers have only rounding
  std::vector<BundleResiduals> residuals;
  std::vector<double> camera, projector;
  for (std::size_t v = 0; v < views.size(); ++v) {
    residuals.push_back(bundle_residuals(bundle, views[v], v));
    for (const auto& r : residuals.back().camera.colwise()) camera.push_back(r.norm());
    for (const auto& r : residuals.back().projector.colwise()) projector.push_back(r.norm());
  }
  const auto limit = [=](const std::vector<double>& lengths) {
    return kLongest * std::max(median(lengths) / kMedianLength, kLeastLength);
  };
  const double camera_limit = limit(camera);
  const double projector_limit = limit(projector);
  const auto weigh = [](const Eigen::Matrix2Xd& misses, double longest, Eigen::VectorXd& weight) {
    for (Eigen::Index i = 0; i < misses.cols(); ++i) {
      const double ratio = longest / std::max(misses.col(i).norm(), longest);
      weight[i] = ratio * ratio;
    }
  };
  for (std::size_t v = 0; v < views.size(); ++v) {
    weigh(residuals[v].camera, camera_limit, views[v].camera_weight);
    weigh(residuals[v].projector, projector_limit, views[v].projector_weight);
  }
}

/// Correlation of the residuals of neighbouring lit points: the variance of a mean over many of
/// them, over that of independent ones with the same deviation; >= 1.
///
/// Errors by a board that is not flat, or by a lens of another kind, are alike in neighbours.
double correlation_of(const Bundle& bundle, const std::vector<BundleView>& views) {
  constexpr double kNear = 42;  // px: three and a half cells of a Gray code
  double own = 0;
  double together = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Eigen::Matrix2Xd residual = bundle_residuals(bundle, views[v], v).projector;
    for (Eigen::Index i = 0; i < residual.cols(); ++i) {
      const double weight = views[v].projector_weight[i];
      own += weight * weight * residual.col(i).squaredNorm();
      for (Eigen::Index j = 0; j < i; ++j) {
        const Eigen::Vector2d apart = views[v].lit_camera.col(i) - views[v].lit_camera.col(j);
        if (apart.squaredNorm() > kNear * kNear) continue;
        together +=
            2 * weight * views[v].projector_weight[j] * residual.col(i).dot(residual.col(j));
      }
    }
  }
  return own > 0 ? std::max(1.0, 1 + together / own) : 1;
}

/// Standard deviations of the camera's and the projector's coordinates, from the residuals.
void set_sigmas(BundleOptions& options, const Squares& left, std::size_t views) {
  constexpr double kLeast = 1e-4;  // px: exact numbers must not give infinite weights
  const double lens = 4.0 + options.distortion_terms;
  const double equations = 2 * (left.camera_points + left.projector_points);
  const double parameters = 2 * lens + 6 + 6 * static_cast<double>(views);
  // Each equation bears the same share of the parameters.
  const double share = std::max(1 - parameters / equations, 1 / equations);
  options.camera_sigma =
      std::max(std::sqrt(left.camera / (2 * left.camera_points * share)), kLeast);
  options.projector_sigma =
      std::max(std::sqrt(left.projector / (2 * left.projector_points * share)), kLeast);
}

}  // namespace

Squares sum_squares(const Bundle& bundle, const std::vector<BundleView>& views) {
  Squares sum;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BundleResiduals residuals = bundle_residuals(bundle, views[v], v);
    sum.camera += residuals.camera.colwise().squaredNorm().dot(views[v].camera_weight);
    sum.projector += residuals.projector.colwise().squaredNorm().dot(views[v].projector_weight);
    sum.camera_points += views[v].camera_weight.sum();
    sum.projector_points += views[v].projector_weight.sum();
  }
  return sum;
}

RigFit fit_rig(const std::vector<RigView>& views, const ImageSize& camera_size,
               const ImageSize& projector_size, int distortion_terms) {
  const auto alone = [&](const char* what, const std::vector<Eigen::Matrix2Xd>& board,
                         const std::vector<Eigen::Matrix2Xd>& pixels, const ImageSize& size) {
    try {
      return calibrate_lens(board, pixels, {.width = size.width, .height = size.height},
                            distortion_terms);
    } catch (const SolverError& error) {
      throw SolverError(std::string("rig calibration: ") + what + ": " + error.what());
    }
  };
  std::vector<Eigen::Matrix2Xd> points, seen, lit, shown;
  for (const RigView& view : views) {
    points.push_back(view.board);
    seen.push_back(view.camera);
  }
  const LensCalibration camera = alone("camera", points, seen, camera_size);
  for (std::size_t v = 0; v < views.size(); ++v) {
    lit.push_back(thinned(lit_on_board(views[v], camera.lens, camera.T_lens_board[v])));
    shown.push_back(thinned(views[v].projector));
  }
  const LensCalibration projector = alone("projector", lit, shown, projector_size);

  RigFit fit{{camera.lens, projector.lens, Eigen::Isometry3d::Identity(), camera.T_lens_board},
             bundle_views(views),
             {.distortion_terms = distortion_terms}};
  fit.bundle.T_projector_camera = first_pose(fit.bundle, fit.views, projector);
  set_sigmas(fit.options, sum_squares(fit.bundle, fit.views), views.size());
  // Weights, deviations and residuals depend on each other; after these rounds none changes.
  constexpr int kRounds = 5;
  // The rounds before the last one only need a thousandth of a standard deviation.
  constexpr double kFirstGain = 1e-9;
  for (int round = 0; round < kRounds; ++round) {
    BundleOptions options = fit.options;
    if (round + 1 < kRounds) options.least_gain = kFirstGain;
    fit.bundle = refine_bundle(fit.bundle, fit.views, options);
    set_weights(fit.bundle, fit.views);
    set_sigmas(fit.options, sum_squares(fit.bundle, fit.views), views.size());
    fit.options.projector_sigma *= std::sqrt(correlation_of(fit.bundle, fit.views));
  }
  return fit;
}

}  // namespace palpate::sensing
