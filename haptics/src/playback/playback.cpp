// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/playback.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"
#include "palpate/core/idle_fields.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_measures.h"
#include "playback/slip_search.h"
#include "playback/surface_side.h"

namespace palpate::haptics {
namespace {

// A touch begins with at least this part of the credit, even if the touches before have used it up:
// otherwise the first force could be more than the user has paid for, and be refused for good.
constexpr double kRenewedCredit = 0.1;

// [N mm] The energy that the user has put in until the middle of a tick. Work is that of the
// commanded forces, by the trapezoidal rule.
double budget_of(const LoopState& state, const Eigen::Vector3d& way) {
  return state.work - state.force.dot(way) / 2;
}

PackedField field_of(const Model& model, double unknown_friction) {
  if (unknown_friction == 0 || unknown_friction_count(model) == 0) return PackedField(model);
  Model assumed = model;
  for (ContactModel& contact : assumed.contacts) {
    if (has_unknown_friction(contact)) contact.friction = unknown_friction;
  }
  return PackedField(assumed);
}

bool pushes(const SlidingContact& contact) {
  return contact.parts.normal >= 0 && contact.force.force.allFinite();
}

}  // namespace

struct Playback::Impl {
  PlaybackOptions options;
  PackedField field;
  SurfaceSide side;
  Eigen::Matrix3Xd normals;  // of the surface's triangles
  int unknown_friction_count;
  Ball reach;

  Impl(const Model& model, const PlaybackOptions& given);

  [[nodiscard]] bool is_still_inside(const Eigen::Vector3d& way, LoopState& state) const;
  [[nodiscard]] bool is_outside(const Eigen::Vector3d& tool) const;
  [[nodiscard]] bool is_inside(const Eigen::Vector3d& tool, TouchPoint& contact) const;
  [[nodiscard]] SlidingContact slip(const SlidingContact& start, const Eigen::Vector3d& tool,
                                    const Eigen::Vector3d& way, LoopState& state) const;
  [[nodiscard]] SlidingContact contact_at(const TouchPoint& point, const Eigen::Vector3d& tool,
                                          const DelayedDisplacements& delayed,
                                          PlaceField& place) const;
  [[nodiscard]] SlidingContact moved_contact(const TouchPoint& point, const Eigen::Vector3d& tool,
                                             LoopState& state) const;
  [[nodiscard]] bool stays_inside(const SlidingContact& start, const Eigen::Vector3d& tool,
                                  const Eigen::Vector3d& way, LoopState& state,
                                  SlidingContact& contact) const;
  [[nodiscard]] bool pushes_elsewhere(const Eigen::Vector3d& tool, const Eigen::Vector3d& way,
                                      LoopState& state, SlidingContact& contact) const;
  [[nodiscard]] double affordable_share(const SlidingContact& contact, const Eigen::Vector3d& way,
                                        const LoopState& state) const;
  [[nodiscard]] Command respond(const Eigen::Vector3d& force, double elastic,
                                const Eigen::Vector3d& way, LoopState& state) const;
  [[nodiscard]] Command let_go(const Eigen::Vector3d& proxy, const Eigen::Vector3d& way,
                               LoopState& state) const;
  [[nodiscard]] Command hold(LoopState& state) const;
};

Playback::Impl::Impl(const Model& model, const PlaybackOptions& given)
    : options(playback_options_for(model, given)),
      field(field_of(model, given.unknown_friction)),
      side(model.surface, field.blended().surface()),
      normals(geometry::triangle_normals(model.surface)),
      unknown_friction_count(haptics::unknown_friction_count(model)) {
  if (options.motion != ContactMotion::bracketed) refuse_idle(given, "motion", {"energy_credit"});
  if (!model.rate.empty() && options.motion != ContactMotion::bracketed) {
    throw InvalidInput(std::vector<MessagePart>{
        {"PlaybackOptions::motion", true},
        {": the model's forces depend on the rate, which only 'bracketed' takes "
         "into account"}});
  }
  reach.center = geometry::bounding_box(model.surface).center();
  for (const int v : model.surface.triangles.reshaped()) {
    reach.radius = std::max(reach.radius, (model.surface.vertices.col(v) - reach.center).norm());
  }
  reach.radius += *options.start_depth;
}

// Returns true if the tool is behind the nearest part of the surface, not beyond its border, and
// not too far inside.
bool Playback::Impl::is_inside(const Eigen::Vector3d& tool, TouchPoint& contact) const {
  TouchPoint nearest;
  const double distance = side.signed_distance(tool, nearest);
  if (!(distance < 0 && -distance <= *options.start_depth)) return false;
  contact = nearest;
  return true;
}

// Returns true if the tool is in front of the nearest part of the surface, not beyond its border.
bool Playback::Impl::is_outside(const Eigen::Vector3d& tool) const {
  TouchPoint nearest;
  return side.signed_distance(tool, nearest) > 0;
}

// The contact of a tool that cannot be seen from its contact any more, because the surface is not
// closed between them, but has not left the surface: the nearest point.
bool Playback::Impl::is_still_inside(const Eigen::Vector3d& way, LoopState& state) const {
  if (field.blended().surface().first_hit(state.tool - way, state.tool)) return false;
  if (!is_inside(state.tool, state.proxy)) return false;
  state.has_place = false;
  state.delayed.of.fill(state.tool - state.proxy.position);
  return true;
}

SlidingContact Playback::Impl::contact_at(const TouchPoint& point, const Eigen::Vector3d& tool,
                                          const DelayedDisplacements& delayed,
                                          PlaceField& place) const {
  field.move_to(point.at, point.position, place);
  SlidingContact contact{.at = {point.at.triangle, point.position},
                         .force = field.force(place, tool - point.position, delayed),
                         .parts = {}};
  contact.parts = friction_parts(place, contact.force.force);
  return contact;
}

// A contact that jumps to another place, where the object is as if at rest: that stores the least.
SlidingContact Playback::Impl::moved_contact(const TouchPoint& point, const Eigen::Vector3d& tool,
                                             LoopState& state) const {
  state.delayed.of.fill(tool - point.position);
  return contact_at(point, tool, state.delayed, state.place);
}

// \param way motion of the tool in this tick.
SlidingContact Playback::Impl::slip(const SlidingContact& start, const Eigen::Vector3d& tool,
                                    const Eigen::Vector3d& way, LoopState& state) const {
  if (options.motion == ContactMotion::bracketed) {
    return search_slip(field, side.walk(), start, tool,
                       {.tolerance = *options.tolerance,
                        .budget = budget_of(state, way),
                        .moved = way,
                        .delayed = state.delayed},
                       state.place, state.slip);
  }
  const auto move = options.motion == ContactMotion::brent ? slip_contact : slip_by_boundary;
  return contact_at(move(field.blended(), normals, state.proxy, tool), tool, state.delayed,
                    state.place);
}

// Keeps a contact that slips off the border, or pulls, while the tool is still behind the surface,
// as where the friction cone leans away from the surface's normal. It goes to the nearest point, or
// stays where it was if more energy would be stored there than there and than the user has put in.
bool Playback::Impl::stays_inside(const SlidingContact& start, const Eigen::Vector3d& tool,
                                  const Eigen::Vector3d& way, LoopState& state,
                                  SlidingContact& contact) const {
  TouchPoint nearest;
  if (!is_inside(tool, nearest)) return false;
  const DelayedDisplacements delayed = state.delayed;
  contact = moved_contact(nearest, tool, state);
  if (cost_of(contact, way) > std::max(budget_of(state, way), cost_of(start, way))) {
    contact = start;
    state.delayed = delayed;
    field.move_to(side.walk().point(start.at), start.at.position, state.place);
  }
  // The tool is pushed back to its contact, unless the object has bases that pull.
  return contact.force.force.dot(tool - contact.at.position) >= 0;
}

// Finds another place at which a tool touches if its contact pulls: at another side of a crease, as
// seen from the contact, or at the nearest point.
bool Playback::Impl::pushes_elsewhere(const Eigen::Vector3d& tool, const Eigen::Vector3d& way,
                                      LoopState& state, SlidingContact& contact) const {
  const SlidingContact pulling = contact;
  TouchPoint other;
  if (side.enters(side.lifted(state.proxy), tool, other) &&
      other.at.triangle != state.proxy.at.triangle) {
    contact = moved_contact(other, tool, state);
    if (pushes(contact)) return true;
  }
  return stays_inside(pulling, tool, way, state, contact);
}

// Share of its force and energy that the object has, so that it never stores more than the user put
// in: less than all after a contact had to go where more is stored, as across the bottom of a sharp
// groove. The share is kept while the contact holds, since work and energy then go together, and
// grows with the energy that friction takes.
double Playback::Impl::affordable_share(const SlidingContact& contact, const Eigen::Vector3d& way,
                                        const LoopState& state) const {
  if (options.motion != ContactMotion::bracketed) return 1;
  const double cost = cost_of(contact, way), budget = budget_of(state, way);
  return cost > 0 && cost > budget ? std::max(0.0, budget / cost) : 1;
}

// The command with this force on the user, or with as much of its change as a tick may have. A
// force that fades may always fall so steeply along the way that it returns no more than is left.
// \param elastic [N] change of the force while the contact held.
Command Playback::Impl::respond(const Eigen::Vector3d& force, double elastic,
                                const Eigen::Vector3d& way, LoopState& state) const {
  Command command{.force = force, .contact = state.proxy.position, .state = state.contact_state};
  const Eigen::Vector3d change = force - state.force;
  double largest = *options.largest_jump + elastic;
  const double steepest = state.force.squaredNorm() * way.norm() / 2;
  if (options.motion == ContactMotion::bracketed && steepest > 0)
    largest += state.work > 0 ? steepest / state.work : std::numeric_limits<double>::infinity();
  if (change.squaredNorm() > largest * largest) {
    command.force = state.force + largest / change.norm() * change;
    command.limited = true;
  }
  state.work -= (state.force + command.force).dot(way) / 2;
  state.force = command.force;
  return command;
}

// \param proxy where the motion of the free tool begins.
Command Playback::Impl::let_go(const Eigen::Vector3d& proxy, const Eigen::Vector3d& way,
                               LoopState& state) const {
  // A tool that passes its contact takes all of its force along.
  const bool passes = (state.tool - state.proxy.position).squaredNorm() <= way.squaredNorm();
  const double elastic = passes ? state.contact_force.norm() : 0;
  state.contact_state = ContactState::free;
  state.has_place = false;
  state.slip = {};
  state.delayed = {};
  state.proxy.position = proxy;
  state.contact_force.setZero();
  Command command = respond(Eigen::Vector3d::Zero(), elastic, way, state);
  command.contact = state.tool;
  return command;
}

// The command while the tool's position is not usable.
Command Playback::Impl::hold(LoopState& state) const {
  const int left = options.hold_ticks - state.faulty_ticks;
  state.force *= static_cast<double>(left) / (left + 1);
  return {.force = state.force,
          .contact = state.proxy.position,
          .state = state.contact_state,
          .held = true};
}

Playback::Playback(const Model& model, const PlaybackOptions& options)
    : impl_(std::make_unique<const Impl>(model, options)) {}
Playback::~Playback() = default;
Playback::Playback(Playback&&) noexcept = default;
Playback& Playback::operator=(Playback&&) noexcept = default;

Command Playback::step(const Eigen::Vector3d& tool, LoopState& state,
                       double seconds) const noexcept {
  const Impl& self = *impl_;
  if (state.playback != self.field.id()) {
    state = {};
    state.playback = self.field.id();
    state.work = *self.options.energy_credit;
  }
  const double moved = state.has_proxy ? (tool - state.tool).norm() : 0;
  if (!tool.allFinite() || !(moved <= self.options.longest_step)) {
    if (state.has_proxy && ++state.faulty_ticks <= self.options.hold_ticks) return self.hold(state);
    state.contact_state = ContactState::free;
    state.has_proxy = state.has_place = false;
    state.force.setZero();
    state.slip = {};
    state.delayed = {};
    if (!tool.allFinite()) return {.held = true};
  }
  state.faulty_ticks = 0;
  Eigen::Vector3d way = tool - state.tool;
  if (!state.has_proxy) way.setZero();
  state.tool = tool;

  bool started_inside = false, touches = false, holds = false;
  if (state.contact_state != ContactState::free) {
    holds = self.side.stays(state.proxy, tool);
    touches = holds || self.is_still_inside(way, state);
  } else if (state.has_proxy) {
    holds = touches = self.side.enters(state.proxy.position, tool, state.proxy);
  } else {
    started_inside = touches = self.is_inside(tool, state.proxy);
    state.has_proxy = true;
    if (touches) state.delayed.of.fill(tool - state.proxy.position);
  }
  if (!touches) return self.let_go(tool, way, state);

  // A touch begins without a force: until then the object still returns what it has.
  if (state.contact_state == ContactState::free && state.force.isZero(0)) {
    const double credit = *self.options.energy_credit;
    state.work = std::clamp(state.work, kRenewedCredit * credit, credit);
  }
  state.contact_state = ContactState::stick;
  if (!state.has_place) self.field.move_to(state.proxy.at, state.proxy.position, state.place);
  state.has_place = true;
  SlidingContact contact{
      .at = {state.proxy.at.triangle, state.proxy.position},
      .force = self.field.force(state.place, tool - state.proxy.position, state.delayed),
      .parts = {}};
  contact.parts = friction_parts(state.place, contact.force.force);
  let_follow(self.field, state.place, tool, state.delayed, contact);
  const double elastic = holds ? (contact.force.force - state.contact_force).norm() : 0;
  if (contact.parts.excess > *self.options.tolerance) {
    const SlidingContact start = contact;
    contact = self.slip(start, tool, way, state);
    if (!contact.found_near && self.is_outside(tool)) return self.let_go(tool, way, state);
    if (contact.off_border && !self.stays_inside(start, tool, way, state, contact))
      return self.let_go(tool, way, state);
    if (contact.at.position != start.at.position) {
      state.contact_state = ContactState::slip;
      state.proxy = self.side.touch_point(contact.at, state.proxy.normal);
    }
    let_follow(self.field, state.place, tool, state.delayed, contact);
  }
  if (!pushes(contact)) {
    // Start outside the surface, so that a tool that is still behind it may touch again.
    const Eigen::Vector3d outside = self.side.lifted(state.proxy);
    if (!self.pushes_elsewhere(tool, way, state, contact)) return self.let_go(outside, way, state);
    state.contact_state = ContactState::slip;
    state.proxy = self.side.touch_point(contact.at, state.proxy.normal);
  }
  if (started_inside) state.work += contact.force.energy;
  const double share = self.affordable_share(contact, way, state);
  state.contact_force = contact.force.force;
  Command command = self.respond(-share * contact.force.force, share * elastic, way, state);
  command.started_inside = started_inside;
  relax(self.field.rate(), tool - state.proxy.position, seconds, state.delayed);
  return command;
}

const Playback::Ball& Playback::reach() const noexcept { return impl_->reach; }

int Playback::unknown_friction_count() const noexcept { return impl_->unknown_friction_count; }

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
  double before = trajectory.empty() ? 0 : trajectory.front().time;
  for (const TrajectoryPoint& point : trajectory) {
    const Command command = playback.step(point.tool, state, point.time - before);
    before = point.time;
    trace.push_back({point.time, point.tool, command.contact, command.force, command.state});
  }
  return trace;
}

}  // namespace palpate::haptics
