// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Assimp is not used because it does not write animations of morph targets.
#include "palpate/geometry/mesh_animation.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "files/gltf_colors.h"
#include "files/scalar_type.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/output_file.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

// Numbers of the specification.
constexpr int kGlbFloat = 5126, kGlbUnsigned = 5125;        // types of components
constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963;  // targets of views
constexpr std::uint32_t kGlbVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr std::size_t kGlbHeader = 12, kGlbChunkHeader = 8, kGlbAlignment = 4;

constexpr double kMetreInMm = 1000;  // [mm]

/// Describes the blocks of the binary chunk, in the order in which they are written.
class GlbLayout {
 public:
  /// A block of `numbers` numbers, each of 4 bytes. \returns the index of its accessor.
  /// \param form members of the accessor, in JSON.
  std::size_t add(std::string_view form, std::size_t numbers, std::optional<int> target = {}) {
    const char* const comma = count_ == 0 ? "" : ",";
    const std::size_t bytes = 4 * numbers;
    views_ += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", comma, bytes_,
                          bytes, target ? fmt::format(R"(,"target":{})", *target) : "");
    accessors_ += fmt::format(R"({}{{"bufferView":{},{}}})", comma, count_, form);
    bytes_ += bytes;
    return count_++;
  }

  /// A block of places or displacements [m], whose bounds the format demands.
  std::size_t add_places(const Eigen::Matrix3Xf& places) {
    // In double: programs read JSON in double, and compare with the numbers in float.
    const Eigen::Vector3d min = places.rowwise().minCoeff().cast<double>(),
                          max = places.rowwise().maxCoeff().cast<double>();
    const std::string form = fmt::format(
        R"("componentType":{},"count":{},"type":"VEC3","min":[{},{},{}],"max":[{},{},{}])",
        kGlbFloat, places.cols(), min.x(), min.y(), min.z(), max.x(), max.y(), max.z());
    return add(form, static_cast<std::size_t>(places.size()), kVertexBuffer);
  }

  [[nodiscard]] std::size_t bytes() const { return bytes_; }

  /// The members of the document that describe the blocks.
  [[nodiscard]] std::string json() const {
    return fmt::format(R"("accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}])",
                       accessors_, views_, bytes_);
  }

 private:
  std::string views_, accessors_;
  std::size_t count_ = 0, bytes_ = 0;
};

template <typename Matrix>
Eigen::Matrix3Xf in_metres(const Matrix& places) {
  return (places.template cast<double>() / kMetreInMm).template cast<float>();
}

void check_animation(const MeshAnimation& animation, const std::string& name) {
  check_mesh(animation.first.mesh, name.c_str());
  check_attributes(animation.first.vertex_attributes, animation.first.mesh.vertices.cols(),
                   name.c_str());
  const std::size_t frames = animation.times.size();
  if (frames < 2 || animation.displacements.size() != frames - 1) {
    throw InvalidInput(
        fmt::format("{}: the animation has {} times and {} displacements; it needs at least 2 "
                    "times, and displacements at all but the first",
                    name, frames, animation.displacements.size()));
  }
  for (std::size_t i = 0; i < frames; ++i) {
    const auto time = static_cast<float>(animation.times[i]);
    const bool ascends = i == 0 ? time >= 0 : time > static_cast<float>(animation.times[i - 1]);
    if (!ascends || time > std::numeric_limits<float>::max()) {
      throw InvalidInput(fmt::format(
          "{}: time {} is {} s; times must ascend from 0 or more, by steps that float tells apart",
          name, i, animation.times[i]));
    }
  }
  if (!in_metres(animation.first.mesh.vertices).allFinite())
    throw InvalidInput(name + ": a vertex is beyond the range of float");
  for (std::size_t i = 0; i + 1 < frames; ++i) {
    const Eigen::Matrix3Xf& displacement = animation.displacements[i];
    if (displacement.cols() != animation.first.mesh.vertices.cols()) {
      throw InvalidInput(fmt::format("{}: frame {} has {} vertices, and frame 0 has {}", name,
                                     i + 1, displacement.cols(),
                                     animation.first.mesh.vertices.cols()));
    }
    if (!displacement.allFinite())
      throw InvalidInput(fmt::format("{}: a vertex of frame {} is not finite", name, i + 1));
  }
}

/// The JSON of the file; its blocks are those that `put_blocks` writes.
std::string glb_document(const MeshAnimation& animation, GlbLayout& layout) {
  const TriangleMesh& mesh = animation.first.mesh;
  const std::size_t frames = animation.times.size(), targets = frames - 1;
  const auto corners = static_cast<std::size_t>(mesh.triangles.size());
  const auto scalars = [](int type, std::size_t count) {
    return fmt::format(R"("componentType":{},"count":{},"type":"SCALAR")", type, count);
  };
  const std::size_t position = layout.add_places(in_metres(mesh.vertices));
  const std::size_t indices = layout.add(scalars(kGlbUnsigned, corners), corners, kIndexBuffer);
  std::string color;
  if (color_bytes(animation.first.vertex_attributes)) {
    const Eigen::Index vertices = mesh.vertices.cols();
    const std::string form =
        fmt::format(R"("componentType":{},"count":{},"type":"VEC4")", kGlbFloat, vertices);
    color = fmt::format(R"(,"COLOR_0":{})",
                        layout.add(form, 4 * static_cast<std::size_t>(vertices), kVertexBuffer));
  }
  std::vector<std::string> displaced;
  for (const Eigen::Matrix3Xf& displacement : animation.displacements)
    displaced.push_back(
        fmt::format(R"({{"POSITION":{}}})", layout.add_places(in_metres(displacement))));
  const std::size_t times =
      layout.add(fmt::format(R"({},"min":[{}],"max":[{}])", scalars(kGlbFloat, frames),
                             double{static_cast<float>(animation.times.front())},
                             double{static_cast<float>(animation.times.back())}),
                 frames);
  const std::size_t weights = layout.add(scalars(kGlbFloat, frames * targets), frames * targets);
  // Most surfaces are seen from both sides, and the format's default is a metal.
  return fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"Palpate"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}{}}},)"
      R"("indices":{},"material":0,"targets":[{}]}}],"weights":[{}]}}],)"
      R"("materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0}},"doubleSided":true}}],)"
      R"("animations":[{{"samplers":[{{"input":{},"output":{},"interpolation":"LINEAR"}}],)"
      R"("channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}]}}],{}}})",
      position, color, indices, fmt::join(displaced, ","),
      fmt::join(std::vector<int>(targets, 0), ","), times, weights, layout.json());
}

template <typename Number>
void put_little(std::ostream& stream, Number number) {
  std::string bytes;
  append_bytes(bytes, std::endian::little, number);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

template <typename Numbers>
void put_block(std::ostream& stream, const Numbers& numbers) {
  std::string bytes;
  bytes.reserve(4 * static_cast<std::size_t>(numbers.size()));
  for (const auto number : numbers.reshaped()) append_bytes(bytes, std::endian::little, number);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void put_blocks(std::ostream& stream, const MeshAnimation& animation) {
  const TriangleMesh& mesh = animation.first.mesh;
  put_block(stream, in_metres(mesh.vertices));
  put_block(stream, mesh.triangles);
  if (const auto colors = color_bytes(animation.first.vertex_attributes)) {
    Eigen::Matrix4Xd linear = colors->cast<double>() / 255;
    linear.topRows<3>() = linear.topRows<3>().unaryExpr(&linear_intensity).eval();
    put_block(stream, Eigen::Matrix4Xf(linear.cast<float>()));
  }
  for (const Eigen::Matrix3Xf& displacement : animation.displacements)
    put_block(stream, in_metres(displacement));
  for (const double time : animation.times) put_little(stream, static_cast<float>(time));
  const auto frames = static_cast<Eigen::Index>(animation.times.size());
  // Frame 0 is the mesh without a target; frame i is target i - 1.
  for (Eigen::Index frame = 0; frame < frames; ++frame)
    for (Eigen::Index target = 1; target < frames; ++target)
      put_little(stream, target == frame ? 1.0F : 0.0F);
}

}  // namespace

void write_mesh_animation(const fs::path& path, const MeshAnimation& animation) {
  const std::string name = path.string();
  if (lower_extension(path) != ".glb") {
    throw InvalidInput(name + ": an animation is written as .glb, not as \"" +
                       path.extension().string() + "\"");
  }
  check_animation(animation, name);
  GlbLayout layout;
  std::string json = glb_document(animation, layout);
  json.resize((json.size() + kGlbAlignment - 1) / kGlbAlignment * kGlbAlignment, ' ');
  const std::size_t size = kGlbHeader + 2 * kGlbChunkHeader + json.size() + layout.bytes();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw InvalidInput(fmt::format(
        "{}: would have {:.1f} GB, and the format allows 4.3; take fewer frames or vertices", name,
        static_cast<double>(size) * 1e-9));
  }
  const auto word = [](std::size_t value) { return static_cast<std::uint32_t>(value); };
  write_file(path, [&](std::ostream& stream) {
    stream << "glTF";
    for (const std::uint32_t number : {kGlbVersion, word(size), word(json.size()), kJsonChunk})
      put_little(stream, number);
    stream << json;
    for (const std::uint32_t number : {word(layout.bytes()), kBinaryChunk})
      put_little(stream, number);
    put_blocks(stream, animation);
  });
}

}  // namespace palpate::geometry
