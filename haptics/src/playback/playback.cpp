// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/playback.h"

namespace palpate::haptics {
namespace {

// Distance outside the surface at which the search for a hit starts, as a fraction of the surface's
// diagonal: far above rounding (1e-16), far below what a user can feel.
constexpr double kOffsetRatio = 1e-9;

Command no_force(const Eigen::Vector3d& tool) {
  return {Eigen::Vector3d::Zero(), tool, ContactState::free};
}

}  // namespace

Playback::Playback(const Model& model)
    : normals_(geometry::triangle_normals(model.surface)),
      offset_(kOffsetRatio * geometry::bounding_diagonal(model.surface)),
      field_(model) {}

// Whether the tool is behind the surface on its way from the proxy, and the contact if it is.
bool Playback::touches(const LoopState& state, const Eigen::Vector3d& tool,
                       TouchPoint& contact) const noexcept {
  const bool touched = state.contact_state != ContactState::free;
  const Eigen::Vector3d start =
      touched ? Eigen::Vector3d(state.proxy.position + offset_ * state.proxy.normal)
              : state.proxy.position;
  const std::optional<geometry::SegmentHit> hit = field_.surface().first_hit(start, tool);
  if (!hit) return false;
  const Eigen::Vector3d normal = normals_.col(hit->at.triangle);
  // From inside, or a triangle without area (NaN): no contact.
  if (!((tool - start).dot(normal) < 0)) return false;
  contact = touched ? state.proxy : TouchPoint{hit->position, normal, hit->at};
  return true;
}

Command Playback::step(const Eigen::Vector3d& tool, LoopState& state) const noexcept {
  if (!tool.allFinite()) {
    state = {};
    return no_force(Eigen::Vector3d::Zero());
  }
  TouchPoint contact;
  if (!state.has_proxy || !touches(state, tool, contact)) {
    state = {ContactState::free, true, {tool, Eigen::Vector3d::Zero(), {}}};
    return no_force(tool);
  }
  ContactState contact_state = ContactState::stick;
  Blend at = field_.blend(contact.at);
  Eigen::Vector3d force = field_.force(at, tool - contact.position);
  if (friction_parts(at, force).excess > 0) {
    contact_state = ContactState::slip;
    contact = slip_contact(field_, normals_, contact, tool);
    at = field_.blend(contact.at);
    force = field_.force(at, tool - contact.position);
  }
  const bool pulls = friction_parts(at, force).normal < 0;
  if (pulls || !force.allFinite()) {
    // Start outside the surface, so that a tool that is still behind it touches again.
    state = {ContactState::free, true, contact};
    state.proxy.position += offset_ * contact.normal;
    return no_force(tool);
  }
  state = {contact_state, true, contact};
  return {-force, contact.position, contact_state};
}

const char* to_string(ContactState state) {
  switch (state) {
    case ContactState::free:
      return "free";
    case ContactState::stick:
      return "stick";
    case ContactState::slip:
      return "slip";
  }
  return "unknown";
}

std::vector<TracePoint> play(const Playback& playback,
                             std::span<const TrajectoryPoint> trajectory) {
  std::vector<TracePoint> trace;
  trace.reserve(trajectory.size());
  LoopState state;
  for (const TrajectoryPoint& point : trajectory) {
    const Command command = playback.step(point.tool, state);
    trace.push_back({point.time, point.tool, command.contact, command.force, command.state});
  }
  return trace;
}

}  // namespace palpate::haptics
