// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/rig_bundle.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "palpate/core/error.h"
#include "setup/lens_jacobian.h"

namespace palpate::sensing {
namespace {

constexpr int kLens = kLensParameters;
constexpr int kMove = kMoveParameters;
constexpr int kShared = 2 * kLens + kMove;  ///< parameters of all views: camera, projector, pose
constexpr int kProjector = kLens;           ///< first column of the projector
constexpr int kPose = 2 * kLens;            ///< first column of R and t

using SharedVector = Eigen::Matrix<double, kShared, 1>;
using MoveVector = Eigen::Matrix<double, kMove, 1>;

Eigen::Matrix3Xd in_space(const Eigen::Isometry3d& T, const Eigen::Matrix2Xd& plane) {
  return (T.linear().leftCols<2>() * plane).colwise() + T.translation();
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// The points at which rays of the camera meet the board: 3 x N in the camera's frame.
Eigen::Matrix3Xd on_board(const Eigen::Matrix3Xd& rays, const Eigen::Isometry3d& T_camera_board) {
  const Eigen::Vector3d normal = T_camera_board.linear().col(2);
  const Eigen::RowVectorXd scale =
      normal.dot(T_camera_board.translation()) * (normal.transpose() * rays).cwiseInverse();
  return rays.array().rowwise() * scale.array();
}

/// Derivatives of the lit points on the board, in the camera's frame, by the board's pose and the
/// camera's parameters. A point is X = s d with the ray d and s = (n t) / (n d).
void lit_rows(const LensView& shown, const RayView& seen, const Eigen::Matrix3Xd& points,
              const Bundle& bundle, std::size_t index, Eigen::Ref<Eigen::MatrixXd> rows) {
  const Eigen::Vector3d n = bundle.T_camera_board[index].linear().col(2);
  const Eigen::Matrix3d& R = bundle.T_projector_camera.linear();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Matrix<double, 2, 3> by_point = shown.by_move.block<2, 3>(2 * i, 3) * R;
    const Eigen::Vector3d ray = seen.rays.col(i);
    const double s = points(2, i);
    const double facing = n.dot(ray);
    // When the ray turns, the point also slides along it, so that it stays on the board.
    const Eigen::Matrix3d slide = Eigen::Matrix3d::Identity() - ray * n.transpose() / facing;
    const Eigen::Vector2d along = by_point * ray / facing;
    rows.block<2, 3>(2 * i, 0) = -s * along * n.cross(ray).transpose();
    rows.block<2, 3>(2 * i, 3) = along * n.transpose();
    rows.block<2, kLens>(2 * i, kMove) =
        s * (by_point * slide).leftCols<2>() * seen.by_lens.middleRows<2>(2 * i);
  }
}

/// Divides the equations of each point by sigma / root of its weight.
void weigh(Eigen::Ref<Eigen::MatrixXd> rows, const Eigen::VectorXd& weight, double sigma) {
  for (Eigen::Index i = 0; i < weight.size(); ++i)
    rows.middleRows<2>(2 * i) *= std::sqrt(weight[i]) / sigma;
}

/// Rows of one view, divided by sigma: columns of the view's pose, of the shared parameters,
/// residuals.
Eigen::MatrixXd view_rows(const Bundle& bundle, const BundleView& view, std::size_t index,
                          const BundleOptions& options) {
  const Eigen::Isometry3d& T_camera_board = bundle.T_camera_board[index];
  const Eigen::Index n = 2 * view.camera.cols();
  const Eigen::Index m = 2 * view.projector.cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n + m, kMove + kShared + 1);
  const LensView seen = look(bundle.camera, in_space(T_camera_board, view.board));
  rows.topLeftCorner(n, kMove) = seen.by_move;
  rows.block(0, kMove, n, kLens) = seen.by_lens;
  rows.col(kMove + kShared).head(n) = (view.camera - seen.predicted).reshaped();
  weigh(rows.topRows(n), view.camera_weight, options.camera_sigma);
  const RayView back = look_back(bundle.camera, view.lit_camera);
  const Eigen::Matrix3Xd points = on_board(back.rays, T_camera_board);
  const LensView shown = look(bundle.projector, bundle.T_projector_camera * points);
  lit_rows(shown, back, points, bundle, index, rows.bottomRows(m));
  rows.block(n, kMove + kProjector, m, kLens) = shown.by_lens;
  rows.block(n, kMove + kPose, m, kMove) = shown.by_move;
  rows.col(kMove + kShared).tail(m) = (view.projector - shown.predicted).reshaped();
  weigh(rows.bottomRows(m), view.projector_weight, options.projector_sigma);
  return rows;
}

/// The shared parameters that are estimated.
std::array<bool, kShared> free_parameters(const BundleOptions& options) {
  std::array<bool, kShared> free{};
  for (int i = 0; i < kShared; ++i) {
    const bool of_lens = i < kPose && i % kLens >= 4 + options.distortion_terms;
    free.at(static_cast<std::size_t>(i)) = !of_lens;
  }
  return free;
}

/// The upper triangle of a QR factorisation.
Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& rows) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
  const Eigen::Index size = std::min(rows.rows(), rows.cols());
  return qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
}

/// The linear least-squares problem around one estimate, with the poses eliminated.
struct Linearization {
  std::vector<Eigen::MatrixXd> views;  ///< 6 rows each: triangle of the pose, shared, residual
  Eigen::MatrixXd shared;              ///< triangle of the shared parameters, residual
  double cost = 0;                     ///< sum of squares
};

/// `damping` multiplies the norm of each column (Marquardt); 0 for the plain problem.
Linearization linearize_bundle(const Bundle& bundle, const std::vector<BundleView>& views,
                               const BundleOptions& options, double damping) {
  const auto free = free_parameters(options);
  Linearization problem;
  std::vector<Eigen::MatrixXd> blocks;
  SharedVector squares = SharedVector::Zero();
  for (std::size_t v = 0; v < views.size(); ++v) {
    Eigen::MatrixXd rows = view_rows(bundle, views[v], v, options);
    for (int i = 0; i < kShared; ++i)
      if (!free.at(static_cast<std::size_t>(i))) rows.col(kMove + i).setZero();
    problem.cost += rows.col(kMove + kShared).squaredNorm();
    squares += rows.middleCols<kShared>(kMove).colwise().squaredNorm().transpose();
    blocks.push_back(std::move(rows));
  }
  Eigen::MatrixXd stacked(0, kShared + 1);
  const auto append = [&stacked](const Eigen::MatrixXd& rows) {
    const Eigen::Index old = stacked.rows();
    stacked.conservativeResize(old + rows.rows(), Eigen::NoChange);
    stacked.bottomRows(rows.rows()) = rows;
  };
  for (Eigen::MatrixXd& rows : blocks) {
    Eigen::MatrixXd damped = Eigen::MatrixXd::Zero(rows.rows() + kMove, rows.cols());
    damped.topRows(rows.rows()) = rows;
    for (int i = 0; i < kMove; ++i) damped(rows.rows() + i, i) = damping * rows.col(i).norm();
    const Eigen::MatrixXd triangle = triangle_of(damped);
    problem.views.emplace_back(triangle.topRows(kMove));
    append(triangle.bottomRightCorner(triangle.rows() - kMove, kShared + 1));
  }
  Eigen::MatrixXd diagonal = Eigen::MatrixXd::Zero(kShared, kShared + 1);
  for (int i = 0; i < kShared; ++i) {
    // A fixed parameter gets an equation of its own that keeps its value.
    diagonal(i, i) = free.at(static_cast<std::size_t>(i)) ? damping * std::sqrt(squares[i]) : 1;
  }
  append(diagonal);
  problem.shared = triangle_of(stacked);
  return problem;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const MoveVector& move) {
  const double angle = move.head<3>().norm();
  Eigen::Isometry3d result = T;
  if (angle > 0) result.prerotate(Eigen::AngleAxisd(angle, move.head<3>() / angle));
  result.pretranslate(move.tail<3>());
  // Orthogonalise again, because many small rotations accumulate rounding.
  result.linear() = Eigen::Quaterniond(result.linear()).normalized().toRotationMatrix();
  return result;
}

geometry::Camera changed(geometry::Camera lens, const Eigen::Matrix<double, kLens, 1>& step) {
  lens.fx += step[0];
  lens.fy += step[1];
  lens.cx += step[2];
  lens.cy += step[3];
  for (std::size_t i = 0; i < 5; ++i) lens.distortion.at(i) += step[4 + static_cast<int>(i)];
  return lens;
}

Bundle stepped(const Bundle& bundle, const Linearization& problem) {
  const SharedVector shared = problem.shared.topLeftCorner(kShared, kShared)
                                  .triangularView<Eigen::Upper>()
                                  .solve(problem.shared.col(kShared).head(kShared));
  Bundle next = bundle;
  next.camera = changed(bundle.camera, shared.head<kLens>());
  next.projector = changed(bundle.projector, shared.segment<kLens>(kProjector));
  next.T_projector_camera = moved(bundle.T_projector_camera, shared.tail<kMove>());
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const Eigen::MatrixXd& rows = problem.views[v];
    const MoveVector move = rows.leftCols<kMove>().triangularView<Eigen::Upper>().solve(
        rows.col(kMove + kShared) - rows.middleCols<kShared>(kMove) * shared);
    next.T_camera_board[v] = moved(bundle.T_camera_board[v], move);
  }
  return next;
}

double weighted_squares(const Eigen::Matrix2Xd& residuals, const Eigen::VectorXd& weight) {
  return residuals.colwise().squaredNorm().dot(weight);
}

double cost_of(const Bundle& bundle, const std::vector<BundleView>& views,
               const BundleOptions& options) {
  double cost = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BundleResiduals residuals = bundle_residuals(bundle, views[v], v);
    cost += weighted_squares(residuals.camera, views[v].camera_weight) /
                (options.camera_sigma * options.camera_sigma) +
            weighted_squares(residuals.projector, views[v].projector_weight) /
                (options.projector_sigma * options.projector_sigma);
  }
  return cost;
}

}  // namespace

Eigen::Matrix3Xd lit_points(const geometry::Camera& camera, const Eigen::Isometry3d& T_camera_board,
                            const Eigen::Matrix2Xd& pixels) {
  Eigen::Matrix3Xd rays(3, pixels.cols());
  for (Eigen::Index i = 0; i < pixels.cols(); ++i)
    rays.col(i) = geometry::undistort(camera, pixels.col(i)).homogeneous();
  return on_board(rays, T_camera_board);
}

BundleResiduals bundle_residuals(const Bundle& bundle, const BundleView& view, std::size_t index) {
  const Eigen::Isometry3d& T = bundle.T_camera_board[index];
  BundleResiduals residuals{view.camera, view.projector};
  const Eigen::Matrix3Xd seen = in_space(T, view.board);
  const Eigen::Matrix3Xd lit =
      bundle.T_projector_camera * lit_points(bundle.camera, T, view.lit_camera);
  for (Eigen::Index i = 0; i < seen.cols(); ++i)
    residuals.camera.col(i) -= geometry::distort(bundle.camera, seen.col(i).hnormalized());
  for (Eigen::Index i = 0; i < lit.cols(); ++i)
    residuals.projector.col(i) -= geometry::distort(bundle.projector, lit.col(i).hnormalized());
  return residuals;
}

Bundle refine_bundle(const Bundle& start, const std::vector<BundleView>& views,
                     const BundleOptions& options) {
  constexpr int kMaxIterations = 200;
  constexpr double kStart = 1e-3;    // relative to the columns' norms
  constexpr double kHopeless = 1e6;  // damping at which only rounding prevents a smaller cost
  Bundle best = start;
  double cost = cost_of(best, views, options);
  if (!std::isfinite(cost)) throw SolverError("rig calibration: the start is not finite");
  double damping = kStart;
  for (int i = 0; i < kMaxIterations && damping < kHopeless; ++i) {
    const Bundle next = stepped(best, linearize_bundle(best, views, options, damping));
    const double next_cost = cost_of(next, views, options);
    if (!(next_cost < cost)) {  // NaN too
      damping *= 10;
      continue;
    }
    const double gain = cost - next_cost;
    best = next;
    cost = next_cost;
    damping /= 10;
    if (gain <= options.least_gain * (cost + gain)) break;
  }
  return best;
}

Eigen::MatrixXd bundle_covariance(const Bundle& bundle, const std::vector<BundleView>& views,
                                  const BundleOptions& options) {
  const Eigen::MatrixXd triangle =
      linearize_bundle(bundle, views, options, 0).shared.topLeftCorner(kShared, kShared);
  const auto free = free_parameters(options);
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(kShared, kShared);
  triangle.triangularView<Eigen::Upper>().solveInPlace(root);
  for (int i = 0; i < kShared; ++i)
    if (!free.at(static_cast<std::size_t>(i))) root.col(i).setZero();
  // The rotation also moves the translation: dt = turn x t + shift.
  Eigen::MatrixXd to_pose = Eigen::MatrixXd::Identity(kShared, kShared);
  to_pose.block<3, 3>(kPose + 3, kPose) = -cross_matrix(bundle.T_projector_camera.translation());
  const Eigen::MatrixXd spread = to_pose * root;
  Eigen::MatrixXd covariance = spread * spread.transpose();
  if (!covariance.allFinite()) covariance.setConstant(std::numeric_limits<double>::infinity());
  return covariance;
}

}  // namespace palpate::sensing
