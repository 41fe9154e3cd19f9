// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_ball.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/geometry/robust_weights.h"

namespace palpate::geometry {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::Vector4d;

/// Side of the cells in which votes are counted, as a share of the radius: normals that are wrong
/// by 15 degrees still vote for the same cell.
constexpr double kVoteCell = 0.25;

/// Number of cells with most votes around which balls are fitted.
constexpr std::size_t kVotedPlaces = 12;

/// A point belongs to a ball only if its normal differs by less than about 37 degrees from the
/// direction from the centre (cosine), ...
constexpr double kNormalsAgree = 0.8;
/// ... if the sphere is not seen at a more grazing angle than 70 degrees (cosine), where range maps
/// are wrong, ...
constexpr double kGrazingView = 0.34;
/// ... and if its distance from the sphere is at most this share of the radius, in the first fits.
constexpr double kFirstBand = 0.25;

/// Distances are taken to be no more exact than this share of the radius: rounding.
constexpr double kBallRounding = 1e-9;

constexpr int kLeastBallPoints = 30;
constexpr double kLargestRms = 0.05;  ///< of the radius

/// Objects seen in the middle of a ball are on it, or hide it: of the points whose rays pass the
/// centre by at most half of the radius, at least this share is on the ball.
constexpr double kMiddle = 0.5, kLeastShareOfMiddle = 0.5;
/// The least eigenvalue of `SeenBall::information`: less is a narrow strip of the ball.
constexpr double kLeastInformation = 1e-3;

/// The known points of a scene, with their normals.
struct BallScene {
  Matrix3Xd points, normals;
};

/// Points within this distance of the centre, in radii of the ball, may be on the ball.
constexpr double kSurroundings = 1.5;

BallScene points_around(const BallScene& scene, const Vector3d& place, double radius) {
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < scene.points.cols(); ++i)
    if ((scene.points.col(i) - place).squaredNorm() < radius * radius) near.push_back(i);
  return {scene.points(Eigen::all, near), scene.normals(Eigen::all, near)};
}

BallScene known_scene(const Eigen::Ref<const Matrix3Xd>& points,
                      const Eigen::Ref<const Matrix3Xd>& normals) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite() && normals.col(i).allFinite()) known.push_back(i);
  return {points(Eigen::all, known), normals(Eigen::all, known)};
}

/// The places with most votes, at most one in each neighbourhood of cells.
std::vector<Vector3d> voted_places(const BallScene& scene, double radius) {
  const Matrix3Xd votes = scene.points - radius * scene.normals;
  using Cell = std::array<int, 3>;
  struct Votes {
    Vector3d sum = Vector3d::Zero();
    int count = 0;
  };
  // Coordinates beyond this many cells do not fit an int; nothing is measured there.
  constexpr double kFarthest = 1e9;
  std::map<Cell, Votes> cells;
  for (const auto& vote : votes.colwise()) {
    const Eigen::Array3d place = (vote / (kVoteCell * radius)).array().floor();
    if (!(place.abs() < kFarthest).all()) continue;
    Votes& cell =
        cells[{static_cast<int>(place[0]), static_cast<int>(place[1]), static_cast<int>(place[2])}];
    cell.sum += vote;
    ++cell.count;
  }
  // The votes of a ball may lie on both sides of the borders of cells.
  std::vector<std::pair<Cell, Votes>> around;
  for (const auto& [cell, votes_here] : cells) {
    Votes all;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto near = cells.find({cell[0] + x, cell[1] + y, cell[2] + z});
          if (near == cells.end()) continue;
          all.sum += near->second.sum;
          all.count += near->second.count;
        }
    if (all.count >= kLeastBallPoints) around.emplace_back(cell, all);
  }
  std::ranges::stable_sort(around, std::ranges::greater{},
                           [](const auto& place) { return place.second.count; });
  std::vector<Vector3d> places;
  std::vector<Cell> taken;
  for (const auto& [cell, all] : around) {
    const bool is_new = std::ranges::none_of(taken, [&cell = cell](const Cell& other) {
      return std::max({std::abs(cell[0] - other[0]), std::abs(cell[1] - other[1]),
                       std::abs(cell[2] - other[2])}) <= 1;
    });
    if (!is_new) continue;
    taken.push_back(cell);
    places.emplace_back(all.sum / all.count);
    if (places.size() == kVotedPlaces) break;
  }
  return places;
}

struct FitSphere {
  Vector3d centre;
  double radius;
};

/// A point of a scene as a sphere sees it.
struct OnSphere {
  Vector3d direction;  ///< unit, from the centre
  double distance;     ///< [mm] from the sphere, > 0: outside
};

/// The points within `band` of a sphere whose normals agree with it.
std::vector<OnSphere> points_near(const BallScene& scene, const FitSphere& sphere, double band) {
  std::vector<OnSphere> found;
  const double low = std::max(0.0, sphere.radius - band), high = sphere.radius + band;
  for (Eigen::Index i = 0; i < scene.points.cols(); ++i) {
    const Vector3d way = scene.points.col(i) - sphere.centre;
    const double squared = way.squaredNorm();
    if (!(squared > low * low && squared < high * high)) continue;
    const double length = std::sqrt(squared);
    const Vector3d direction = way / length;
    const Vector3d to_camera = -scene.points.col(i).normalized();
    if (direction.dot(scene.normals.col(i)) < kNormalsAgree ||
        direction.dot(to_camera) < kGrazingView)
      continue;
    found.push_back({direction, length - sphere.radius});
  }
  return found;
}

double deviation_of(const std::vector<OnSphere>& points, double radius) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const OnSphere& point : points) distances.push_back(std::abs(point.distance));
  return std::max(deviation_of_median(median(distances)), kBallRounding * radius);
}

/// Weighted normal equations of centre and radius.
struct BallEquations {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Vector4d b = Vector4d::Zero();
  double weight = 0, squares = 0;
  int used = 0;
};

BallEquations ball_equations(const std::vector<OnSphere>& points, double deviation) {
  BallEquations sums;
  for (const OnSphere& point : points) {
    const double weight = tukey_weight(std::abs(point.distance), deviation);
    if (!(weight > 0)) continue;
    Vector4d row;
    row << point.direction, 1;
    sums.A.noalias() += weight * row * row.transpose();
    sums.b += weight * point.distance * row;
    sums.weight += weight;
    sums.squares += weight * point.distance * point.distance;
    ++sums.used;
  }
  return sums;
}

/// Fits until the steps are small. The radius is fitted if `free`.
std::optional<FitSphere> settled_sphere(const BallScene& scene, FitSphere sphere, bool free) {
  constexpr int kMostSteps = 60;
  constexpr double kSmallStep = 1e-9;  // of the radius
  constexpr double kSingular = 1e-9;
  const double radius = sphere.radius;
  double band = kFirstBand * radius;
  for (int step = 0; step < kMostSteps; ++step) {
    const std::vector<OnSphere> points = points_near(scene, sphere, band);
    if (points.size() < kLeastBallPoints) return std::nullopt;
    const double deviation = deviation_of(points, radius);
    const BallEquations sums = ball_equations(points, deviation);
    Vector4d x = Vector4d::Zero();
    if (free) {
      const Eigen::LDLT<Eigen::Matrix4d> factors(sums.A);
      if (!(factors.rcond() > kSingular)) return std::nullopt;
      x = factors.solve(sums.b);
    } else {
      const Eigen::LDLT<Matrix3d> factors(sums.A.topLeftCorner<3, 3>());
      if (!(factors.rcond() > kSingular)) return std::nullopt;
      x.head<3>() = factors.solve(sums.b.head<3>());
    }
    if (!(x.norm() < radius)) return std::nullopt;
    sphere.centre += x.head<3>();
    sphere.radius += x[3];
    if (!(sphere.radius > 0)) return std::nullopt;
    if (x.norm() < kSmallStep * radius) break;
    // Narrow at a moderate pace, so that a wrong start does not lose points of the ball.
    band = std::max({band / 2, kTukeyCutOff * deviation, kBallRounding * radius});
    band = std::min(band, kFirstBand * radius);
  }
  return sphere;
}

/// Share of the points in the middle of a ball, as the camera sees it, that are on it.
double share_of_middle(const BallScene& scene, const FitSphere& sphere, double tolerance) {
  const double middle = kMiddle * sphere.radius;
  int seen = 0, on_it = 0;
  for (const auto& point : scene.points.colwise()) {
    const Vector3d ray = point.normalized();
    const Vector3d passed = sphere.centre - ray.dot(sphere.centre) * ray;
    if (!(passed.squaredNorm() < middle * middle)) continue;
    ++seen;
    const double distance = std::abs((point - sphere.centre).norm() - sphere.radius);
    if (distance <= tolerance && point.norm() < sphere.centre.norm()) ++on_it;
  }
  return seen > 0 ? static_cast<double>(on_it) / seen : 0;
}

std::optional<SeenBall> ball_at(const BallScene& whole, const Vector3d& place, double radius) {
  const BallScene scene = points_around(whole, place, kSurroundings * radius);
  const std::optional<FitSphere> sphere = settled_sphere(scene, {place, radius}, false);
  if (!sphere) return std::nullopt;
  const std::vector<OnSphere> points = points_near(scene, *sphere, kFirstBand * radius);
  if (points.size() < kLeastBallPoints) return std::nullopt;
  const double deviation = deviation_of(points, radius);
  const BallEquations sums = ball_equations(points, deviation);
  SeenBall ball{.centre = sphere->centre,
                .information = sums.A.topLeftCorner<3, 3>() / sums.weight,
                .points = sums.used,
                .rms = std::sqrt(sums.squares / sums.weight)};
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(ball.information, Eigen::EigenvaluesOnly);
  if (ball.points < kLeastBallPoints || !(ball.rms <= kLargestRms * radius) ||
      !(axes.eigenvalues()[0] > kLeastInformation) ||
      share_of_middle(whole, *sphere, kTukeyCutOff * deviation) < kLeastShareOfMiddle) {
    return std::nullopt;
  }
  const std::optional<FitSphere> best = settled_sphere(scene, *sphere, true);
  if (!best) return std::nullopt;
  ball.radius = best->radius;
  return ball;
}

}  // namespace

std::optional<SeenBall> find_ball(const Eigen::Ref<const Matrix3Xd>& points,
                                  const Eigen::Ref<const Matrix3Xd>& normals, double radius) {
  require("find_ball: radius", radius, above(0).finite(), "mm");
  if (normals.cols() != points.cols())
    throw InvalidInput("find_ball: there are " + std::to_string(normals.cols()) + " normals for " +
                       std::to_string(points.cols()) + " points; each point needs one");
  const BallScene scene = known_scene(points, normals);
  std::optional<SeenBall> best;
  for (const Vector3d& place : voted_places(scene, radius)) {
    const std::optional<SeenBall> ball = ball_at(scene, place, radius);
    if (ball && (!best || ball->points > best->points)) best = ball;
  }
  return best;
}

}  // namespace palpate::geometry
