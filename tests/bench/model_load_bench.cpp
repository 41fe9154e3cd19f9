// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Reading a model of 1e5 contacts against parsing its field document alone, which is the least that
// any reader with the same JSON library does.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "paired.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_csv.h"
#include "repository.h"
#include "scratch_folder.h"

namespace {

namespace geometry = palpate::geometry;
namespace haptics = palpate::haptics;

/// A plane with side x side contacts, one at each vertex, with the fields and compliances of the
/// demonstration's sheet in turn.
haptics::Model large_model(int side) {
  const std::filesystem::path sheet = palpate::repository("demo/sheet");
  const haptics::Model fitted =
      haptics::build_model(
          palpate::probing::read_acquisition_csv(sheet / "contacts.csv", sheet / "samples.csv"),
          geometry::read_mesh(sheet / "surface.ply"))
          .model;
  haptics::Model model;
  model.interpolation = fitted.interpolation;
  model.surface.vertices.resize(3, side * side);
  model.triangles.resize(3, 2 * (side - 1) * (side - 1));
  int triangle = 0;
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const int vertex = row * side + col;
      model.surface.vertices.col(vertex) << col, row, 0;
      haptics::ContactModel contact =
          fitted.contacts[static_cast<std::size_t>(vertex) % fitted.contacts.size()];
      contact.id = vertex;
      contact.position = model.surface.vertices.col(vertex);
      model.contacts.push_back(contact);
      if (row + 1 == side || col + 1 == side) continue;
      model.triangles.col(triangle++) << vertex, vertex + 1, vertex + side;
      model.triangles.col(triangle++) << vertex + 1, vertex + side + 1, vertex + side;
    }
  }
  model.surface.triangles = model.triangles;
  return model;
}

void model_load_against_parsing(benchmark::State& state) {
  const palpate::ScratchFolder scratch;
  haptics::write_model(scratch.path() / "model", large_model(317));
  palpate::bench::run_paired(
      state, [&] { benchmark::DoNotOptimize(haptics::read_model(scratch.path() / "model")); },
      [&] {
        std::ifstream stream(scratch.path() / "model/field.cbor", std::ios::binary);
        benchmark::DoNotOptimize(nlohmann::json::from_cbor(stream));
      });
}
BENCHMARK(model_load_against_parsing)->Unit(benchmark::kMillisecond);

}  // namespace
