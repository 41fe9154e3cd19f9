// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// The C++ of playback as a page calls it (web/page/model/player.js). One model a page. All lengths
// are in mm, forces in N, in the frame of the model.
#include <array>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <span>

#include "palpate/haptics/deformed_shape.h"
#include "palpate/haptics/model_bytes.h"
#include "palpate/haptics/playback.h"

namespace {

using namespace palpate;

struct Player {
  explicit Player(haptics::Model from)
      : model(std::move(from)), playback(model), field(model), surface(model.surface) {
    for (const haptics::ContactModel& contact : model.contacts) {
      places.insert(places.end(), contact.position.begin(), contact.position.end());
    }
  }

  haptics::Model model;
  haptics::Playback playback;
  haptics::BlendedField field;
  geometry::GeodesicSurface surface;
  haptics::LoopState state;
  std::vector<double> places;  // of the contacts
  std::array<double, 16> output{};
  std::array<double, 6> picked{};
  Eigen::Matrix3Xf shape;  // as drawn last
};

std::unique_ptr<Player> player;

void put(const Eigen::Vector3d& from, double* to) { Eigen::Vector3d::Map(to) = from; }

}  // namespace

extern "C" {

void* palpate_allocate(std::size_t size) { return std::malloc(size); }

/// A model of `to_bytes`; stops the program if they are damaged. \param bytes of
/// `palpate_allocate`, which are freed.
void palpate_open(std::byte* bytes, std::size_t size) {
  haptics::Model model = haptics::model_of_bytes({bytes, size});
  std::free(bytes);
  player = std::make_unique<Player>(std::move(model));
}

int palpate_vertex_count() { return static_cast<int>(player->model.surface.vertices.cols()); }
int palpate_triangle_count() { return static_cast<int>(player->model.surface.triangles.cols()); }
const double* palpate_vertices() { return player->model.surface.vertices.data(); }
const int* palpate_triangles() { return player->model.surface.triangles.data(); }
int palpate_contact_count() { return static_cast<int>(player->model.contacts.size()); }
const double* palpate_contacts() { return player->places.data(); }
/// 0 if it is not known.
double palpate_tool_radius() { return player->model.probe_radius.value_or(0); }

void palpate_reset() { player->state = {}; }

/// One tick of 1 ms. 0: free, 1: stick, 2: slip.
int palpate_step(double x, double y, double z) {
  const haptics::Command command = player->playback.step({x, y, z}, player->state);
  put(command.force, player->output.data());
  put(command.contact, player->output.data() + 3);
  return static_cast<int>(command.state);
}

/// Of the last tick: force on the user, contact, axis of the friction cone, coefficient, normal and
/// tangential force, stated deviation of the force (NaN: not known), displacement. Zero while free,
/// except for the contact, which is the tool.
const double* palpate_output() {
  Player& p = *player;
  double* out = p.output.data();
  std::fill(out + 6, out + 16, 0.0);
  out[12] = std::numeric_limits<double>::quiet_NaN();
  if (p.state.contact_state == haptics::ContactState::free) return out;
  const Eigen::Vector3d displacement = p.state.tool - p.state.proxy.position;
  const haptics::Blend blend = p.field.blend(p.state.proxy.at);
  const haptics::FrictionParts parts =
      haptics::friction_parts(blend, -Eigen::Vector3d::Map(p.output.data()));
  put(blend.frame.col(2), out + 6);
  out[9] = blend.friction;
  out[10] = parts.normal;
  out[11] = parts.tangential;
  out[12] = p.field.deviation(p.state.proxy.at, displacement).value_or(out[12]);
  put(displacement, out + 13);
  return out;
}

/// The surface as it is drawn in the state of the last tick. \param rule 0: blended, 1: nearest
const float* palpate_deform(int rule) {
  Player& p = *player;
  p.shape = haptics::displayed_shape(
                p.model, p.field, p.surface, p.state,
                rule == 1 ? haptics::ShapeRule::nearest : haptics::ShapeRule::blended)
                .cast<float>();
  return p.shape.data();
}

/// Root mean square distance of the recorded surfaces from the drawn ones [mm]; -1 if none were
/// recorded.
double palpate_shape_error() { return player->model.response ? player->model.response->rms : -1; }

/// Finds the place where a ray meets the undeformed surface.
int palpate_pick(double ox, double oy, double oz, double dx, double dy, double dz) {
  const auto hit = player->field.surface().first_hit(
      geometry::Ray{.origin = {ox, oy, oz}, .direction = {dx, dy, dz}});
  if (!hit) return 0;
  const geometry::TriangleMesh& surface = player->model.surface;
  const Eigen::Vector3i corners = surface.triangles.col(hit->at.triangle);
  const Eigen::Vector3d a = surface.vertices.col(corners[0]);
  put(hit->position, player->picked.data());
  put((surface.vertices.col(corners[1]) - a)
          .cross(surface.vertices.col(corners[2]) - a)
          .normalized(),
      player->picked.data() + 3);
  return 1;
}

/// Of the last hit: position, outward normal.
const double* palpate_picked() { return player->picked.data(); }
}
