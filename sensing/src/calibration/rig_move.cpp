// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/rig_move.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"
#include "setup/lens_jacobian.h"

namespace palpate::sensing {
namespace {

/// The rig moved if the residuals of all views together are this many times those of the groups:
/// errors of a lens model or a board differ less between a few views and all.
constexpr double kMovedRatio = 2;

/// The normal equations of the small move of the projector that explains the residuals of some
/// views best, with everything else as it is.
struct MoveFit {
  Eigen::Matrix<double, kMoveParameters, kMoveParameters> normal = decltype(normal)::Zero();
  Eigen::Matrix<double, kMoveParameters, 1> right = decltype(right)::Zero();

  void add(const MoveFit& other) {
    normal += other.normal;
    right += other.right;
  }
  /// Reduction of the sum of squares by the best move [px^2].
  [[nodiscard]] double gain() const {
    return right.dot(normal.completeOrthogonalDecomposition().solve(right));
  }
};

MoveFit move_fit(const Bundle& bundle, const BundleView& view, std::size_t index) {
  const Eigen::Matrix3Xd lit =
      lit_points(bundle.camera, bundle.T_camera_board[index], view.lit_camera);
  const LensView shown = look(bundle.projector, bundle.T_projector_camera * lit);
  const Eigen::VectorXd left = (view.projector - shown.predicted).reshaped();
  return {shown.by_move.transpose() * shown.by_move, shown.by_move.transpose() * left};
}

/// The number of views before the split in two that explains most.
std::size_t best_split(const RigFit& fit, std::size_t least_views) {
  std::vector<MoveFit> of_views;
  MoveFit after;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    of_views.push_back(move_fit(fit.bundle, fit.views[v], v));
    after.add(of_views.back());
  }
  MoveFit before;
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v + least_views < of_views.size(); ++v) {
    before.add(of_views[v]);
    after.normal -= of_views[v].normal;
    after.right -= of_views[v].right;
    const double gain = before.gain() + after.gain();
    if (v + 1 < least_views || gain <= most) continue;
    most = gain;
    best = v + 1;
  }
  return best;
}

}  // namespace

double projector_rms(const RigFit& fit) {
  double squares = 0;
  double points = 0;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    squares += bundle_residuals(fit.bundle, fit.views[v], v).projector.squaredNorm();
    points += static_cast<double>(fit.views[v].projector.cols());
  }
  return std::sqrt(squares / points);
}

std::optional<RigMove> find_move(
    const RigFit& fit, const std::vector<RigView>& views, std::size_t least_views,
    const std::function<RigFit(const std::vector<RigView>&)>& fit_again) {
  if (views.size() < 2 * least_views) return std::nullopt;
  const std::size_t split = best_split(fit, least_views);
  const auto middle = views.begin() + static_cast<std::ptrdiff_t>(split);
  try {
    const double apart = std::max(projector_rms(fit_again({views.begin(), middle})),
                                  projector_rms(fit_again({middle, views.end()})));
    if (kMovedRatio * apart < projector_rms(fit)) return RigMove{split, apart};
  } catch (const SolverError&) {
    // A group that does not determine the rig proves nothing.
  }
  return std::nullopt;
}

}  // namespace palpate::sensing
