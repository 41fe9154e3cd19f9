// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// A sphere of 30 mm, with normals and one colour a vertex.
MeshFile colored_sphere() {
  MeshFile file;
  file.mesh = test::icosphere(2, 30);
  set_normals(file.vertex_attributes, file.mesh.vertices.colwise().normalized());
  Eigen::Matrix3Xd colors = (file.mesh.vertices.array() / 60 + 0.5).matrix();
  set_colors(file.vertex_attributes, colors.cwiseMax(0).cwiseMin(1));
  return file;
}

// The header of the file as its specification says: magic, version, length, length of the JSON.
TEST(Glb, IsInMetresAsTheFormatDemands) {
  const ScratchFolder folder;
  write_mesh_file(folder / "sphere.glb", colored_sphere());
  const std::string bytes = read_text(folder / "sphere.glb");
  std::uint32_t words[5];
  ASSERT_GT(bytes.size(), sizeof(words));
  std::memcpy(words, bytes.data(), sizeof(words));
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(words[1], 2U);
  EXPECT_EQ(words[2], bytes.size());
  const auto document = nlohmann::json::parse(bytes.substr(sizeof(words), words[3]));
  const auto& attributes = document.at("meshes").at(0).at("primitives").at(0).at("attributes");
  const auto& places = document.at("accessors").at(attributes.at("POSITION").get<std::size_t>());
  EXPECT_NEAR(places.at("max").at(0).get<double>(), 0.03, 1e-3);
  EXPECT_NEAR(places.at("min").at(2).get<double>(), -0.03, 1e-3);
  EXPECT_TRUE(attributes.contains("NORMAL"));
  EXPECT_TRUE(attributes.contains("COLOR_0"));
}

TEST(Glb, ComesBackWithinTheRoundingOfFloats) {
  const ScratchFolder folder;
  const MeshFile written = colored_sphere();
  write_mesh_file(folder / "sphere.glb", written);
  const MeshFile read = read_mesh_file(folder / "sphere.glb");
  EXPECT_EQ(read.unit.length, 1000);
  EXPECT_EQ(read.mesh.triangles, written.mesh.triangles);
  EXPECT_LT((read.mesh.vertices - written.mesh.vertices).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT(
      (*colors(read.vertex_attributes) - *colors(written.vertex_attributes)).cwiseAbs().maxCoeff(),
      1e-6);
  EXPECT_LT((*normals(read.vertex_attributes) - *normals(written.vertex_attributes))
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
}

// The middle grey of screens, 128 of 255, is 21.6 % of the light (IEC 61966-2-1).
TEST(Glb, HasColoursThatAreLinearInTheLight) {
  const ScratchFolder folder;
  MeshFile file;
  file.mesh = test::icosphere(0, 30);
  set_colors(file.vertex_attributes, Eigen::Matrix3Xd::Constant(3, 12, 128.0 / 255));
  write_mesh_file(folder / "grey.glb", file);
  const std::string bytes = read_text(folder / "grey.glb");
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, sizeof(length));
  const auto document = nlohmann::json::parse(bytes.substr(20, length));
  const auto& accessor = document.at("accessors")
                             .at(document.at("meshes")[0]["primitives"][0]["attributes"]["COLOR_0"]
                                     .get<std::size_t>());
  const auto& view = document.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  float rgba[4];
  std::memcpy(rgba, bytes.data() + 20 + length + 8 + view.value("byteOffset", std::size_t{0}),
              sizeof(rgba));
  EXPECT_NEAR(rgba[0], 0.2158, 1e-3);  // of 128 / 255
  EXPECT_EQ(rgba[0], rgba[2]);
  EXPECT_EQ(rgba[3], 1);
}

TEST(Glb, LengthsBeyondTheFileAreRefusedBeforeMemoryIsTaken) {
  const ScratchFolder folder;
  write_mesh_file(folder / "sphere.glb", colored_sphere());
  const std::string right = read_text(folder / "sphere.glb");
  std::string wrong = right;
  wrong[15] = '\xf0';  // the length of the JSON: 4 GB
  write_text(folder / "json.glb", wrong);
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "json.glb")), FileError,
                        "says that a part of it has 40265");
  write_text(folder / "cut.glb", right.substr(0, right.size() / 2));
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "cut.glb")), FileError,
                        "says that the file has " + std::to_string(right.size()));
}

// assimp reads beyond the bytes of some of these.
TEST(Glb, WhatDoesNotBeginAsTheFormatDemandsIsRefused) {
  const ScratchFolder folder;
  write_mesh_file(folder / "sphere.glb", colored_sphere());
  const std::string right = read_text(folder / "sphere.glb");
  for (const std::string& wrong :
       {right.substr(0, 11), right.substr(1), std::string("glT"), std::string("{\"asset\": {}}")}) {
    write_text(folder / "wrong.glb", wrong);
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "wrong.glb")), FileError,
                          "wrong.glb: does not begin with glTF");
  }
}

TEST(Glb, RefusesWhatItCannotHold) {
  const ScratchFolder folder;
  MeshFile file = colored_sphere();
  EXPECT_THROWS_MESSAGE(write_mesh_file(folder / "sphere.glb", file, {.encoding = Encoding::text}),
                        InvalidInput, "sphere.glb: is always binary");
  file.mesh.vertices(0, 3) = 1e300;
  EXPECT_THROWS_MESSAGE(write_mesh_file(folder / "sphere.glb", file), InvalidInput,
                        "vertex 3 is beyond the range of float");
}

}  // namespace
}  // namespace palpate::geometry
