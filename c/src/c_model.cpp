// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "c_calls.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/haptics/model_bytes.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playable.h"

namespace palpate::c {
namespace {

palpate_model* made(haptics::Model model) {
  haptics::check_playable(model);
  auto shared = std::make_shared<const haptics::Model>(std::move(model));
  return reinterpret_cast<palpate_model*>(
      new OpenModel{shared, std::make_shared<const haptics::BlendedField>(*shared)});
}

}  // namespace
}  // namespace palpate::c

using palpate::c::behind;
using palpate::c::fail;
using palpate::c::guarded;

palpate_status palpate_model_open(const char* folder, palpate_model** model) {
  if (folder == nullptr || model == nullptr) {
    return fail(PALPATE_INVALID, "palpate_model_open: folder or model is null");
  }
  return guarded([&] { *model = palpate::c::made(palpate::haptics::read_model(folder)); });
}

palpate_status palpate_model_open_bytes(const void* bytes, uint64_t size, palpate_model** model) {
  if (bytes == nullptr || model == nullptr) {
    return fail(PALPATE_INVALID, "palpate_model_open_bytes: bytes or model is null");
  }
  return guarded([&] {
    *model = palpate::c::made(palpate::haptics::model_of_bytes(
        {static_cast<const std::byte*>(bytes), static_cast<std::size_t>(size)}));
  });
}

void palpate_model_close(palpate_model* model) { delete behind(model); }

palpate_status palpate_model_bytes(const palpate_model* model, void* bytes, uint64_t* size) {
  if (model == nullptr || size == nullptr) {
    return fail(PALPATE_INVALID, "palpate_model_bytes: model or size is null");
  }
  return guarded([&] {
    const std::vector<std::byte> all = palpate::haptics::to_bytes(*behind(model)->model);
    const uint64_t room = std::exchange(*size, all.size());
    if (bytes == nullptr) return;
    if (room < all.size()) {
      throw palpate::InvalidInput("palpate_model_bytes: size is " + std::to_string(room) +
                                  "; there are " + std::to_string(all.size()) + " bytes");
    }
    std::memcpy(bytes, all.data(), all.size());
  });
}

palpate_status palpate_model_describe(const palpate_model* model, palpate_model_facts* facts) {
  if (model == nullptr || facts == nullptr) {
    return fail(PALPATE_INVALID, "palpate_model_describe: model or facts is null");
  }
  const palpate::haptics::Model& from = *behind(model)->model;
  palpate_model_facts all{};
  all.vertices = static_cast<uint32_t>(from.surface.vertices.cols());
  all.triangles = static_cast<uint32_t>(from.surface.triangles.cols());
  all.contacts = static_cast<uint32_t>(from.contacts.size());
  all.unknown_friction = static_cast<uint32_t>(palpate::haptics::unknown_friction_count(from));
  const Eigen::AlignedBox3d box = palpate::geometry::bounding_box(from.surface);
  Eigen::Vector3d::Map(all.lower) = box.min();
  Eigen::Vector3d::Map(all.upper) = box.max();
  all.probe_radius = from.probe_radius.value_or(0);
  all.shape_error = from.response ? from.response->rms : -1;
  palpate::c::give(all, *facts);
  return PALPATE_OK;
}

palpate_status palpate_model_vertices(const palpate_model* model, float* xyz, uint64_t count) {
  if (model == nullptr || xyz == nullptr) {
    return fail(PALPATE_INVALID, "palpate_model_vertices: model or xyz is null");
  }
  return guarded([&] {
    palpate::c::copy_floats(behind(model)->model->surface.vertices, xyz, count,
                            "palpate_model_vertices");
  });
}

palpate_status palpate_model_triangles(const palpate_model* model, int32_t* corners,
                                       uint64_t count) {
  if (model == nullptr || corners == nullptr) {
    return fail(PALPATE_INVALID, "palpate_model_triangles: model or corners is null");
  }
  return guarded([&] {
    const Eigen::Matrix3Xi& triangles = behind(model)->model->surface.triangles;
    if (count < static_cast<uint64_t>(triangles.size())) {
      throw palpate::InvalidInput("palpate_model_triangles: count is " + std::to_string(count) +
                                  "; there are " + std::to_string(triangles.size()) + " values");
    }
    std::copy_n(triangles.data(), triangles.size(), corners);
  });
}

palpate_status palpate_model_force(const palpate_model* model, const double place[3],
                                   const double displacement[3], double force[3],
                                   double* deviation) {
  if (model == nullptr || place == nullptr || displacement == nullptr || force == nullptr) {
    return fail(PALPATE_INVALID,
                "palpate_model_force: model, place, displacement or force is null");
  }
  const Eigen::Vector3d at = Eigen::Vector3d::Map(place);
  const Eigen::Vector3d moved = Eigen::Vector3d::Map(displacement);
  if (!at.allFinite() || !moved.allFinite()) {
    return fail(PALPATE_INVALID, "palpate_model_force: place or displacement is not finite");
  }
  const palpate::haptics::BlendedField& field = *behind(model)->field;
  Eigen::Vector3d::Map(force) = field.force(at, moved);
  if (deviation != nullptr) {
    *deviation = field.deviation(at, moved).value_or(std::numeric_limits<double>::quiet_NaN());
  }
  return PALPATE_OK;
}
