// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_animation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using nlohmann::json;

constexpr double kMetreOfAnimation = 1000;  // [mm]

/// A sphere of 30.7 mm at 700.1 mm that grows by different amounts along the axes.
MeshAnimation growing_sphere() {
  MeshAnimation animation;
  animation.first.mesh = test::icosphere(2, 30.7);
  animation.first.mesh.vertices.row(2).array() += 700.1;
  const Eigen::Matrix3Xd colors = (animation.first.mesh.vertices.colwise().normalized()).cwiseAbs();
  set_colors(animation.first.vertex_attributes, colors);
  animation.times = {0, 0.1, 0.37};
  for (const double growth : {0.013, 0.31}) {
    const Eigen::Vector3d along(growth, 2 * growth, -growth);
    animation.displacements.emplace_back(
        (along.asDiagonal() * animation.first.mesh.vertices).cast<float>());
  }
  return animation;
}

/// A binary glTF file, read by its specification.
struct GlbDocument {
  json document;
  std::string binary;

  /// The numbers of an accessor.
  template <typename Number>
  [[nodiscard]] std::vector<Number> numbers(const json& accessor_index) const {
    const json& accessor = document["accessors"].at(accessor_index.get<std::size_t>());
    const json& view = document["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
    const std::size_t components = accessor["type"] == "SCALAR" ? 1
                                   : accessor["type"] == "VEC3" ? 3
                                                                : 4;
    std::vector<Number> numbers(components * accessor["count"].get<std::size_t>());
    EXPECT_EQ(accessor["componentType"], (std::is_same_v<Number, float> ? 5126 : 5125));
    EXPECT_EQ(view["byteLength"], 4 * numbers.size());
    const auto offset = view["byteOffset"].get<std::size_t>();
    EXPECT_EQ(offset % 4, 0U);
    EXPECT_LE(offset + 4 * numbers.size(), binary.size());
    std::memcpy(numbers.data(), binary.data() + offset, 4 * numbers.size());
    return numbers;
  }

  /// Three rows, after a check of the bounds that the accessor states.
  [[nodiscard]] Eigen::Matrix3Xf places(const json& accessor_index) const {
    const std::vector<float> all = numbers<float>(accessor_index);
    const Eigen::Matrix3Xf places = Eigen::Map<const Eigen::Matrix3Xf>(
        all.data(), 3, static_cast<Eigen::Index>(all.size() / 3));
    const json& accessor = document["accessors"].at(accessor_index.get<std::size_t>());
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      EXPECT_EQ(accessor["min"].at(at).get<float>(), places.row(axis).minCoeff());
      EXPECT_EQ(accessor["max"].at(at).get<float>(), places.row(axis).maxCoeff());
    }
    return places;
  }

  [[nodiscard]] const json& primitive() const { return document["meshes"][0]["primitives"][0]; }
};

GlbDocument read_document(const std::string& path) {
  const std::string bytes = read_text(path);
  std::uint32_t words[5], chunk[2];
  std::memcpy(words, bytes.data(), sizeof(words));
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(words[1], 2U);
  EXPECT_EQ(words[2], bytes.size());
  EXPECT_EQ(words[3] % 4, 0U);
  EXPECT_EQ(words[4], 0x4E4F534AU);  // JSON
  std::memcpy(chunk, bytes.data() + sizeof(words) + words[3], sizeof(chunk));
  EXPECT_EQ(chunk[0] % 4, 0U);
  EXPECT_EQ(chunk[1], 0x004E4942U);  // BIN
  EXPECT_EQ(sizeof(words) + words[3] + sizeof(chunk) + chunk[0], bytes.size());
  GlbDocument glb{.document = json::parse(bytes.substr(sizeof(words), words[3])),
                  .binary = bytes.substr(sizeof(words) + words[3] + sizeof(chunk))};
  EXPECT_EQ(glb.document["buffers"][0]["byteLength"], glb.binary.size());
  return glb;
}

TEST(MeshAnimation, PutsEachVertexWhereItIsInEachFrame) {
  const ScratchFolder folder;
  const MeshAnimation animation = growing_sphere();
  write_mesh_animation(folder / "sphere.glb", animation);
  const GlbDocument glb = read_document(folder / "sphere.glb");
  const Eigen::Matrix3Xf first = glb.places(glb.primitive()["attributes"]["POSITION"]);
  const Eigen::Matrix3Xd& vertices = animation.first.mesh.vertices;
  ASSERT_EQ(glb.primitive()["targets"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Matrix3Xf moved =
        first + glb.places(glb.primitive()["targets"][i]["POSITION"]);  // as viewers add them
    const Eigen::Matrix3Xd expected =
        (vertices + animation.displacements[i].cast<double>()) / kMetreOfAnimation;
    // Three roundings: of the vertex, of the displacement, of the sum.
    const double rounding = 3 * std::numeric_limits<float>::epsilon();
    EXPECT_LT((moved.cast<double>() - expected).cwiseAbs().maxCoeff(), rounding);
  }
}

TEST(MeshAnimation, GivesTheWeightOfEachFrameAtItsTime) {
  const ScratchFolder folder;
  const MeshAnimation animation = growing_sphere();
  write_mesh_animation(folder / "sphere.glb", animation);
  const GlbDocument glb = read_document(folder / "sphere.glb");
  const json& player = glb.document["animations"][0];
  EXPECT_EQ(player["channels"][0]["target"]["path"], "weights");
  EXPECT_EQ(player["samplers"][0]["interpolation"], "LINEAR");
  const json& input = player["samplers"][0]["input"];
  const std::vector<float> times = glb.numbers<float>(input);
  EXPECT_EQ(times, std::vector<float>(animation.times.begin(), animation.times.end()));
  const json& bounds = glb.document["accessors"].at(input.get<std::size_t>());
  EXPECT_EQ(bounds["min"], json::array({times.front()}));
  EXPECT_EQ(bounds["max"], json::array({times.back()}));
  // Those of a key are together: none for the first frame, then those of the two targets.
  EXPECT_EQ(glb.numbers<float>(player["samplers"][0]["output"]),
            (std::vector<float>{0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(glb.document["meshes"][0]["weights"], json::array({0, 0}));
}

TEST(MeshAnimation, IsTheFirstFrameForReadersOfMeshes) {
  const ScratchFolder folder;
  const MeshAnimation animation = growing_sphere();
  write_mesh_animation(folder / "sphere.glb", animation);
  const MeshFile read = read_mesh_file(folder / "sphere.glb");
  EXPECT_EQ(read.mesh.triangles, animation.first.mesh.triangles);
  EXPECT_LT((read.mesh.vertices - animation.first.mesh.vertices).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((*colors(read.vertex_attributes) - *colors(animation.first.vertex_attributes))
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
}

TEST(MeshAnimation, HasNoColoursIfTheFirstFrameHasNone) {
  const ScratchFolder folder;
  MeshAnimation animation = growing_sphere();
  animation.first.vertex_attributes.clear();
  write_mesh_animation(folder / "sphere.glb", animation);
  const GlbDocument glb = read_document(folder / "sphere.glb");
  EXPECT_FALSE(glb.primitive()["attributes"].contains("COLOR_0"));
  EXPECT_EQ(glb.numbers<std::uint32_t>(glb.primitive()["indices"]).size(),
            static_cast<std::size_t>(animation.first.mesh.triangles.size()));
}

TEST(MeshAnimation, RefusesWhatIsNoSequence) {
  const ScratchFolder folder;
  const auto refuses = [&](const auto& change, const std::string& why,
                           const std::string& name = "out.glb") {
    MeshAnimation animation = growing_sphere();
    change(animation);
    EXPECT_THROWS_MESSAGE(write_mesh_animation(folder / name, animation), InvalidInput, why);
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  };
  refuses([](MeshAnimation&) {}, "is written as .glb, not as \".obj\"", "out.obj");
  refuses([](MeshAnimation& a) { a.displacements.pop_back(); }, "3 times and 1 displacements");
  refuses(
      [](MeshAnimation& a) {
        a.times = {0};
        a.displacements.clear();
      },
      "at least 2 times");
  refuses([](MeshAnimation& a) { a.times[2] = a.times[1]; }, "time 2 is 0.1 s; times must ascend");
  refuses([](MeshAnimation& a) { a.times = {1e9, 1e9 + 1, 1e9 + 2}; }, "float tells apart");
  refuses([](MeshAnimation& a) { a.times[0] = -1; }, "time 0 is -1 s");
  refuses([](MeshAnimation& a) { a.times[1] = std::nan(""); }, "time 1 is nan s");
  refuses([](MeshAnimation& a) { a.displacements[1] = Eigen::Matrix3Xf::Zero(3, 7); },
          "frame 2 has 7 vertices, and frame 0 has 162");
  refuses([](MeshAnimation& a) { a.displacements[0](1, 5) = std::nanf(""); },
          "a vertex of frame 1 is not finite");
  refuses([](MeshAnimation& a) { a.first.mesh.vertices(0, 3) = 1e300; }, "beyond the range");
  refuses([](MeshAnimation& a) { a.first.mesh.triangles(0, 3) = 162; }, "triangle 3");
}

}  // namespace
}  // namespace palpate::geometry
