// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/rig_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/quantile.h"
#include "setup/rig_jacobian.h"

namespace palpate::sensing {
namespace {

/// A parameter is determined badly iff its standard deviation exceeds this: of a focal length, as a
/// share of it; of a principal point, as a share of the image's width; of the lens distortion, in
/// pixels at the corner of the image; of the translation, as a share of its length.
constexpr double kFocal = 0.002;
constexpr double kCenter = 0.003;
constexpr double kCornerShift = 0.5;
constexpr double kTranslation = 0.003;
/// Distortion is extrapolated beyond the outermost point; warn if that leaves out more than this
/// share of the way from the image's middle to its corner.
constexpr double kLeastReach = 0.7;
/// Distances of the boards: farthest over nearest.
constexpr double kLeastDistances = 1.1;

/// Reach of points from the middle of an image, as a share of the way to its corner.
double share_of_half_diagonal(const geometry::Camera& lens, const std::vector<BundleView>& views,
                              Eigen::Matrix2Xd BundleView::*points) {
  const Eigen::Vector2d middle((lens.width - 1) / 2.0, (lens.height - 1) / 2.0);
  double farthest = 0;
  for (const BundleView& view : views) {
    for (const auto& point : (view.*points).colwise())
      farthest = std::max(farthest, (point - middle).norm());
  }
  return farthest / middle.norm();
}

void add_lens(const char* what, const geometry::Camera& lens, const Eigen::VectorXd& deviation,
              Eigen::Index first, std::vector<std::string>& advice) {
  const double focal = std::max(deviation[first], deviation[first + 1]);
  if (focal > kFocal * lens.fx) {
    advice.push_back(fmt::format(
        "{}: the focal length, {:.0f} px, has a standard deviation of {:.2g} px; add boards tilted "
        "by 30 to 45 degrees, to the left, to the right, up and down",
        what, lens.fx, focal));
  }
  const double center = std::max(deviation[first + 2], deviation[first + 3]);
  if (center > kCenter * lens.width) {
    advice.push_back(fmt::format(
        "{}: the principal point has a standard deviation of {:.2g} px; add boards tilted by 30 to "
        "45 degrees about both axes, also turned by 90 degrees in their plane",
        what, center));
  }
  const double corner = std::hypot(lens.width, lens.height) / 2 / lens.fx;
  const double shift = deviation[first + 4] * std::pow(corner, 3) * lens.fx;
  if (shift > kCornerShift) {
    advice.push_back(fmt::format(
        "{}: the lens distortion k1 has a standard deviation of {:.2g}, {:.1f} px at the corner of "
        "the image; add boards that fill its corners",
        what, deviation[first + 4], shift));
  }
}

}  // namespace

std::vector<std::string> rig_advice(const RigFit& fit, const Eigen::VectorXd& deviation) {
  std::vector<std::string> advice;
  const Bundle& bundle = fit.bundle;
  add_lens("camera", bundle.camera, deviation, 0, advice);
  add_lens("projector", bundle.projector, deviation, kLensParameters, advice);
  const double shift = deviation.tail<3>().maxCoeff();
  const double length = bundle.T_projector_camera.translation().norm();
  if (shift > kTranslation * length) {
    advice.push_back(fmt::format(
        "t: has a standard deviation of {:.2g} mm at a length of {:.0f} mm; add boards at other "
        "distances, tilted by 30 to 45 degrees",
        shift, length));
  }
  const double seen =
      std::max(share_of_half_diagonal(bundle.camera, fit.views, &BundleView::camera),
               share_of_half_diagonal(bundle.camera, fit.views, &BundleView::lit_camera));
  if (seen < kLeastReach) {
    advice.push_back(fmt::format(
        "camera: no board lies beyond {:.0f} % of the way from the middle of the image to its "
        "corner, and the lens distortion is not measured there; add boards near all four corners",
        100 * seen));
  }
  const double shown = share_of_half_diagonal(bundle.projector, fit.views, &BundleView::projector);
  if (shown < kLeastReach) {
    advice.push_back(fmt::format(
        "projector: no board lies beyond {:.0f} % of the way from the middle of the panel to its "
        "corner, and the lens distortion is not measured there; add boards near the corners of its "
        "light",
        100 * shown));
  }
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = 0;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    const Eigen::Vector2d middle = fit.views[v].board.rowwise().mean();
    const double z = (bundle.T_camera_board[v] * Eigen::Vector3d(middle.x(), middle.y(), 0)).z();
    nearest = std::min(nearest, z);
    farthest = std::max(farthest, z);
  }
  if (farthest < kLeastDistances * nearest) {
    advice.push_back(fmt::format(
        "distance: all boards lie between {:.0f} and {:.0f} mm; add boards at the nearest and at "
        "the farthest distance of what you will measure",
        nearest, farthest));
  }
  return advice;
}

std::vector<std::string> uneven_boards(const RigFit& fit, const std::vector<RigView>& views) {
  constexpr double kLowWeight = 0.5;  // residuals above 4.2 standard deviations
  constexpr double kFew = 0.05;       // of the corners
  std::vector<std::string> warnings;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Eigen::VectorXd& weight = fit.views[v].camera_weight;
    const auto low = (weight.array() < kLowWeight).count();
    if (static_cast<double>(low) <= kFew * static_cast<double>(weight.size())) continue;
    const Eigen::Matrix2Xd residual = bundle_residuals(fit.bundle, fit.views[v], v).camera;
    warnings.push_back(fmt::format(
        "{}: {} of {} corners do not lie in the plane of the others, by up to {:.2g} px, and count "
        "less; is the board flat, and nothing in front of it?",
        views[v].name, low, weight.size(), residual.colwise().norm().maxCoeff()));
  }
  return warnings;
}

double relative_depth_deviation(const Rig& rig, const RigFit& fit) {
  constexpr int kAcross = 12;  // places along the image's width and height
  Eigen::Matrix2Xd pixels(2, kAcross * kAcross);
  for (int i = 0; i < kAcross * kAcross; ++i) {
    pixels.col(i) << (i % kAcross + 0.5) / kAcross * rig.camera.width - 0.5,
        (static_cast<double>(i / kAcross) + 0.5) / kAcross * rig.camera.height - 0.5;
  }
  const RayView seen = look_back(rig.camera, pixels);
  const Eigen::Vector3d t = rig.T_projector_camera.translation();
  const Axis axis = std::abs(t.x()) > std::abs(t.y()) ? Axis::x : Axis::y;
  std::vector<double> shares;
  for (const Eigen::Isometry3d& T_camera_board : fit.bundle.T_camera_board) {
    const double w = 1 / T_camera_board.translation().z();
    const PanelView view = panel_view(rig, axis, seen, Eigen::VectorXd::Constant(pixels.cols(), w));
    // dz / z = -dw / w
    for (const double variance : inverse_depth_variance(rig, view))
      if (variance >= 0) shares.push_back(std::sqrt(variance) / w);
  }
  return shares.empty() ? std::numeric_limits<double>::infinity() : median(shares);
}

}  // namespace palpate::sensing
