// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/intensity_pairs.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/numbers.h"
#include "deformation/measured_surface.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/robust_weights.h"

namespace palpate::geometry {
namespace {

/// Standard deviations of the blurs [px]. The widest must reach as far as the surface moves between
/// two frames, the narrowest suppresses the noise of single pixels.
constexpr double kBlurs[] = {4, 2, 1};
static_assert(std::size(kBlurs) == kIntensityBlurs);

/// Blurs end at this many standard deviations.
constexpr double kBlurEnd = 3;

/// The gain around a node differs from that of the whole surface by at most this factor.
constexpr double kMostGain = 2;

/// Half a step [px] of the derivative of the lens distortion.
constexpr double kLensStep = 0.5;

/// One direction of a blur, over the known pixels.
void blur_rows(const Eigen::ArrayXf& kernel, const ImageF& image, ImageF& blurred) {
  const Eigen::Index reach = kernel.size() / 2;
  parallel_for(image.rows(), [&](Eigen::Index row) {
    for (Eigen::Index col = 0; col < image.cols(); ++col) {
      const Eigen::Index first = std::max<Eigen::Index>(col - reach, 0);
      const Eigen::Index last = std::min<Eigen::Index>(col + reach, image.cols() - 1);
      float sum = 0;
      for (Eigen::Index c = first; c <= last; ++c) sum += kernel[c - col + reach] * image(row, c);
      blurred(row, col) = sum;
    }
  });
}

ImageF blurred(const ImageF& image, double deviation) {
  const auto reach = static_cast<Eigen::Index>(std::ceil(kBlurEnd * deviation));
  Eigen::ArrayXf kernel(2 * reach + 1);
  for (Eigen::Index i = -reach; i <= reach; ++i) {
    const double ratio = static_cast<double>(i) / deviation;
    kernel[i + reach] = static_cast<float>(std::exp(-ratio * ratio / 2));
  }
  const auto both_ways = [&](const ImageF& of) {
    ImageF once(of.rows(), of.cols()), turned(of.cols(), of.rows());
    blur_rows(kernel, of, once);
    once = once.transpose().eval();
    blur_rows(kernel, once, turned);
    return ImageF(turned.transpose());
  };
  const auto is_known = image.isFinite();
  const ImageF sum = both_ways(is_known.select(image, 0.0F));
  const ImageF weight = both_ways(is_known.cast<float>());
  return is_known.select(sum / weight, std::numeric_limits<float>::quiet_NaN());
}

/// Sums over samples, to fit a T + b.
struct LightSums {
  double count = 0, t = 0, i = 0, tt = 0, ti = 0, ii = 0;

  LightSums& operator+=(const LightSums& other) {
    count += other.count;
    t += other.t;
    i += other.i;
    tt += other.tt;
    ti += other.ti;
    ii += other.ii;
    return *this;
  }
  [[nodiscard]] double variance_of_t() const { return tt - t * t / count; }
  [[nodiscard]] double variance_of_i() const { return ii - i * i / count; }
  [[nodiscard]] double covariance() const { return ti - t * i / count; }
};

/// gain, offset, share of the variance that is explained
using Light = Eigen::Vector3d;

double gain_of(const LightSums& sums) {
  const double variance = sums.variance_of_t();
  return variance > 0 ? sums.covariance() / variance : 1;
}

Light light_of(const LightSums& sums, double gain_of_all) {
  if (!(sums.count > 0) || !(gain_of_all > 0)) return Light::Zero();
  const double gain = std::clamp(gain_of(sums), gain_of_all / kMostGain, gain_of_all * kMostGain);
  const double covariance = std::max(sums.covariance(), 0.0);
  const double variances = sums.variance_of_t() * sums.variance_of_i();
  const double explained = variances > 0 ? std::min(covariance * covariance / variances, 1.0) : 0;
  return {gain, (sums.i - gain * sums.t) / sums.count, explained};
}

/// The lights of the samples around each node, with those of linked nodes.
std::vector<Light> lights(const DeformationGraph& graph, std::span<const IntensitySample> samples,
                          std::span<const IntensityAt> seen, const Eigen::VectorXf& reference) {
  std::vector<LightSums> own(static_cast<std::size_t>(graph.nodes().cols()));
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const int vertex = samples[s].vertex;
    const double t = reference[vertex], i = seen[s].value;
    if (!std::isfinite(t) || !std::isfinite(i)) continue;
    Eigen::Index nearest = 0;
    graph.weights().col(vertex).maxCoeff(&nearest);
    own[static_cast<std::size_t>(graph.influences()(nearest, vertex))] +=
        LightSums{1, t, i, t * t, t * i, i * i};
  }
  std::vector<LightSums> around = own;
  for (const auto& edge : graph.edges().colwise()) {
    const auto a = static_cast<std::size_t>(edge[0]), b = static_cast<std::size_t>(edge[1]);
    around[a] += own[b];
    around[b] += own[a];
  }
  LightSums all;
  for (const LightSums& sums : own) all += sums;
  const double gain = all.count > 0 ? gain_of(all) : 1;
  std::vector<Light> result;
  for (const LightSums& sums : around) result.push_back(light_of(sums, gain));
  return result;
}

/// Standard deviation, by the median of the sizes.
double robust_deviation(std::vector<double> sizes) { return deviation_of_median(median(sizes)); }

}  // namespace

BlurredImages::BlurredImages(const Camera& camera, const ImageF& image) : camera_(camera) {
  check_camera(camera, "the camera of the intensities");
  if (image.cols() != camera.width || image.rows() != camera.height) {
    throw InvalidInput(fmt::format(
        "the intensities are {} x {} px, and the camera is {} x {} px; they must be of one size",
        image.cols(), image.rows(), camera.width, camera.height));
  }
  for (const double blur : kBlurs) images_.push_back(blurred(image, blur));
}

Eigen::Vector2d BlurredImages::pixel_of(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d none(kNan, kNan);
  if (!(point.z() > 0)) return none;
  const Eigen::Vector2d pixel = distort(camera_, point.hnormalized());
  return pixel.x() >= 1 && pixel.y() >= 1 && pixel.x() < camera_.width - 2 &&
                 pixel.y() < camera_.height - 2
             ? pixel
             : none;
}

IntensityAt BlurredImages::at(const Eigen::Vector3d& point, int blur) const {
  const Eigen::Vector2d pixel = pixel_of(point);
  if (!pixel.allFinite()) return {kNan, Eigen::Vector3d::Zero()};
  const Eigen::Vector2d ray = point.hnormalized();
  const auto col = static_cast<Eigen::Index>(pixel.x()), row = static_cast<Eigen::Index>(pixel.y());
  const double x = pixel.x() - static_cast<double>(col), y = pixel.y() - static_cast<double>(row);
  const Eigen::Matrix4d near =
      images_[static_cast<std::size_t>(blur)].block<4, 4>(row - 1, col - 1).matrix().cast<double>();
  // Differences over two pixels are continuous once interpolated, unlike the derivative of the
  // interpolated image: with that, steps do not settle.
  const Eigen::Vector2d rows(1 - y, y), cols(1 - x, x);
  const Eigen::Matrix2d across = (near.block<2, 2>(1, 2) - near.block<2, 2>(1, 0)) / 2;
  const Eigen::Matrix2d down = (near.block<2, 2>(2, 1) - near.block<2, 2>(0, 1)) / 2;
  const Eigen::RowVector2d of_pixel(rows.dot(across * cols), rows.dot(down * cols));
  const Eigen::Vector2d dx(kLensStep / camera_.fx, 0), dy(0, kLensStep / camera_.fy);
  Eigen::Matrix2d of_ray;
  of_ray << (distort(camera_, ray + dx) - distort(camera_, ray - dx)) / (2 * dx.x()),
      (distort(camera_, ray + dy) - distort(camera_, ray - dy)) / (2 * dy.y());
  Eigen::Matrix<double, 2, 3> of_point;
  of_point << Eigen::Matrix2d::Identity(), -ray;
  return {rows.dot(near.block<2, 2>(1, 1) * cols),
          (of_pixel * of_ray * of_point / point.z()).transpose()};
}

std::vector<double> intensity_noise(std::span<const Eigen::Vector2d> pixels,
                                    std::mt19937_64& random) {
  std::vector<double> errors(pixels.size(), 0);
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d high = -low;
  for (const Eigen::Vector2d& pixel : pixels) {
    if (!pixel.allFinite()) continue;
    low = low.min(pixel.array().floor());
    high = high.max(pixel.array().floor() + 1);
  }
  if (!(low <= high).all()) return errors;
  const double blur = kBlurs[kIntensityBlurs - 1], margin = std::ceil(kBlurEnd * blur);
  low -= margin;
  high += margin;
  ImageF noise(static_cast<Eigen::Index>(high.y() - low.y()) + 1,
               static_cast<Eigen::Index>(high.x() - low.x()) + 1);
  for (float& one : noise.reshaped()) one = (random() & 1U) != 0 ? 1.0F : -1.0F;
  noise = blurred(noise, blur);
  double square = 0;
  long known = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i].allFinite()) continue;
    const Eigen::Vector2d at = pixels[i] - low.matrix();
    const auto col = static_cast<Eigen::Index>(at.x()), row = static_cast<Eigen::Index>(at.y());
    const double x = at.x() - static_cast<double>(col), y = at.y() - static_cast<double>(row);
    const Eigen::Matrix2d near = noise.block<2, 2>(row, col).matrix().cast<double>();
    errors[i] = Eigen::Vector2d(1 - y, y).dot(near * Eigen::Vector2d(1 - x, x));
    square += errors[i] * errors[i];
    ++known;
  }
  for (double& error : errors) error /= std::sqrt(square / static_cast<double>(known));
  return errors;
}

std::vector<PlanePair> intensity_pairs(const DeformationGraph& graph, const BlurredImages& images,
                                       const VertexIntensities& reference, int blur,
                                       std::span<const IntensitySample> samples) {
  const Eigen::VectorXf of_vertices = reference.row(blur);
  std::vector<IntensityAt> seen(samples.size());
  parallel_for(samples.size(), [&](std::size_t s) {
    seen[s] = samples[s].is_seen ? images.at(samples[s].place, blur)
                                 : IntensityAt{kNan, Eigen::Vector3d::Zero()};
  });
  const std::vector<Light> light = lights(graph, samples, seen, of_vertices);
  std::vector<PlanePair> pairs(samples.size());
  std::vector<double> differences, distances, widths;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const int vertex = samples[s].vertex;
    Light here = Light::Zero();
    for (int k = 0; k < DeformationGraph::kInfluences; ++k)
      here += graph.weights()(k, vertex) *
              light[static_cast<std::size_t>(graph.influences()(k, vertex))];
    const double expected = here[0] * static_cast<double>(of_vertices[vertex]) + here[1];
    const double difference = seen[s].value - expected;
    if (!std::isfinite(difference) || !seen[s].gradient.allFinite()) continue;
    pairs[s] = {seen[s].gradient, difference, here[2]};
    differences.push_back(std::abs(difference));
    distances.push_back(std::abs(samples[s].distance));
    widths.push_back(images.pixel_width(samples[s].place));
  }
  if (widths.empty()) return pairs;
  const double of_intensity = robust_deviation(std::move(differences)),
               of_distance = std::max(robust_deviation(std::move(distances)),
                                      kLeastDepthNoise * median(widths));
  for (PlanePair& pair : pairs) {
    if (!(of_intensity > 0)) pair.weight = 0;
    if (!(pair.weight > 0)) continue;
    const double ratio = of_distance / of_intensity;
    pair.weight *= ratio * ratio * tukey_weight(std::abs(pair.distance), of_intensity);
  }
  return pairs;
}

VertexIntensities vertex_intensities(const Camera& camera, const ImageF& image,
                                     const DeformedSurface& surface) {
  const BlurredImages images(camera, image);
  VertexIntensities intensities(kIntensityBlurs, surface.vertices.cols());
  parallel_for(surface.vertices.cols(), [&](Eigen::Index v) {
    const bool is_seen = surface.sight[static_cast<std::size_t>(v)] == VertexSight::seen;
    for (int blur = 0; blur < kIntensityBlurs; ++blur) {
      intensities(blur, v) =
          is_seen ? static_cast<float>(images.at(surface.vertices.col(v), blur).value)
                  : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return intensities;
}

}  // namespace palpate::geometry
