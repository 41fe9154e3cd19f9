// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "dented_surface.h"

#include <fmt/format.h>

#include <algorithm>

#include "theme.h"

namespace palpate::view {
namespace {

constexpr float kDotSize = 6.5F;     // [px] of a contact
constexpr int kDotOpacity = 190;     // of 255
constexpr double kLeastMove = 1e-4;  // diagonals: less than a pixel
constexpr int kRest = 2;             // times as long as a dent takes, until the next one
constexpr float kDentTint = 0.55F;   // of the dent's colour where it is deepest

float smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return static_cast<float>(t * t * (3 - 2 * t));
}

}  // namespace

DentedSurface::DentedSurface(const haptics::Model& model, const geometry::SurfaceQuery& query,
                             double deep)
    : shape_(model.surface),
      options_(haptics::shape_options(model)),
      model_(model),
      query_(query),
      geodesics_(model.surface),
      deep_(deep),
      least_move_(kLeastMove * geometry::bounding_diagonal(model.surface)) {
  contacts_.resize(3, static_cast<Eigen::Index>(model.contacts.size()));
  for (const haptics::ContactModel& contact : model.contacts) {
    contacts_.col(static_cast<Eigen::Index>(nearest_.size())) = contact.position.cast<float>();
    nearest_.push_back(query.closest_point(contact.position).at);
  }
  renderer_.put(shape_);
  colors_.resize(4, shape_.positions().cols());
  color_vertices({0, colors_.cols()});
  renderer_.put_colors(colors_);
  put_contacts();
}

std::string DentedSurface::origin_in_words() const {
  if (!is_recorded()) return "The dent is drawn, not measured.";
  const haptics::SurfaceResponse& response = *model_.response;
  if (rule_ == haptics::ShapeRule::nearest) {
    return fmt::format("The surface is the nearest of {} recorded ones, kept to {:.2g} mm RMS.",
                       response.shape_contacts.size(), response.kept_rms);
  }
  return fmt::format("The surface follows {} recorded ones, {:.2g} mm RMS from them.",
                     response.shape_contacts.size(), response.rms);
}

void DentedSurface::set_rule(haptics::ShapeRule rule) {
  is_stale_ = is_stale_ || rule != rule_;
  rule_ = rule;
}

void DentedSurface::show(const ForceReading& reading, bool touches, bool hurry) {
  if (!touches && !is_dented_) return;
  const DentClock::time_point begin = DentClock::now();
  if (hurry && touches && begin < next_) return;
  if (touches && is_dented_ && !is_stale_) {
    const Eigen::Vector3d contact = geometry::position(shape_.surface(), reading.at);
    const double moved =
        (contact - contact_).norm() + (reading.displacement - displacement_).norm();
    if (moved < least_move_) return;
  }
  if (touches) {
    contact_ = geometry::position(shape_.surface(), reading.at);
    displacement_ = reading.displacement;
  }
  const VertexRange range = touches ? deform(reading) : shape_.rest();
  is_dented_ = touches;
  is_stale_ = false;
  renderer_.update(shape_, range);
  color_vertices(range);
  renderer_.update_colors(colors_, range);
  put_contacts();
  const DentClock::time_point end = DentClock::now();
  next_ = end + kRest * (end - begin);
}

VertexRange DentedSurface::deform(const ForceReading& reading) {
  if (!is_recorded()) return shape_.deform(reading.at, reading.displacement, options_);
  if (rule_ == haptics::ShapeRule::nearest) {
    return shape_.show(haptics::nearest_shape(model_, geodesics_, query_, reading.weights,
                                              reading.at, reading.displacement));
  }
  return shape_.show(haptics::measured_shape(geodesics_, *model_.response, reading.weights,
                                             reading.at, reading.displacement, options_));
}

void DentedSurface::draw_contacts(const SceneRenderer& scene, const Shot& shot,
                                  double size_of_pixel) const {
  scene.draw_points(dots_, shot, kDotSize, 1.5 * static_cast<double>(kDotSize) * size_of_pixel);
}

void DentedSurface::color_vertices(const VertexRange& range) {
  const Eigen::Vector3f base = color(kSurface), dent = color(kDent);
  for (Eigen::Index v = range.begin; v < range.end; ++v) {
    const float part = kDentTint * smooth_step(static_cast<double>(shape_.moved()[v]) / deep_);
    const Eigen::Vector3f mixed = 255 * (base + part * (dent - base));
    colors_.col(v) << mixed.cast<unsigned char>(), 255;
  }
}

void DentedSurface::put_contacts() {
  ColoredPoints dots{.positions = contacts_, .colors = {}};
  dots.colors.resize(4, contacts_.cols());
  const geometry::TriangleMesh& surface = shape_.surface();
  const Eigen::Vector3f rgb = 255 * color(kDot);
  for (Eigen::Index i = 0; i < contacts_.cols(); ++i) {
    const geometry::SurfacePoint& at = nearest_[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      const int v = surface.triangles(k, at.triangle);
      dots.positions.col(i) += static_cast<float>(at.barycentric[k]) *
                               (shape_.positions().col(v) - surface.vertices.col(v).cast<float>());
    }
    dots.colors.col(i) << rgb.cast<unsigned char>(), kDotOpacity;
  }
  dots_.put(dots);
}

}  // namespace palpate::view
