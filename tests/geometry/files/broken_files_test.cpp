// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// Damaged files: each is refused by a FileError that names it, or read as a whole.
#include <gtest/gtest.h>
#include <lzf.h>
#include <sys/resource.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "file_testing.h"
#include "files/random_mesh_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

// Assimp forgets some of what it read where it gives up on a damaged glTF.
// NOLINTNEXTLINE(bugprone-reserved-identifier): LeakSanitizer calls it by this name.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

struct Sample {
  std::string ending;
  std::string content;
  bool whole = true;  ///< no part of it is a file of its own
  int rounds = 2000;  ///< of random damage
};

/// Assimp sets up its readers of all formats again for each file, which takes a millisecond.
constexpr int kAssimpRounds = 200;

MeshFile small_file() {
  MeshFile file;
  file.mesh.vertices.resize(3, 4);
  file.mesh.vertices << 0.1, 10, 0, 0, 0, 0, 10, 0, 0, 0, 0.3, 10;
  file.mesh.triangles.resize(3, 2);
  file.mesh.triangles << 0, 1, 1, 2, 2, 3;
  set_colors(file.vertex_attributes, Eigen::MatrixXd::Constant(3, 4, 0.2));
  set_normals(file.vertex_attributes, Eigen::Matrix3Xd::Constant(3, 4, 0.25));
  file.triangle_attributes = {{"tags", std::vector<std::uint16_t>{1, 2, 3}, {1, 2}}};
  return file;
}

std::string content_of(const char* name, const MeshFile& file, Encoding encoding) {
  const ScratchFolder folder;
  write_mesh_file(folder / name, file, {.encoding = encoding});
  return read_text(folder / name);
}

std::string pcd(Encoding encoding) {
  const ScratchFolder folder;
  PointCloud cloud;
  cloud.points = small_file().mesh.vertices;
  cloud.width = cloud.height = 2;
  cloud.attributes = small_file().vertex_attributes;
  write_point_cloud(folder / "a.pcd", cloud, {.encoding = encoding, .single_precision = true});
  return read_text(folder / "a.pcd");
}

std::string compressed_pcd() {
  const std::string points(120, '\1');
  std::string packed(120, '\0');
  packed.resize(lzf_compress(points.data(), 120, packed.data(), 120));
  std::string sizes{static_cast<char>(packed.size()), '\0', '\0', '\0', 120, '\0', '\0', '\0'};
  return "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 5\nHEIGHT 2\nDATA binary_compressed\n" +
         sizes + packed;
}

std::string gltf() {
  // Three corners at the base-64 text of nine floats: (0 0 0), (1 0 0), (0 1 0).
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":
"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})";
}

/// The same as one binary file: a header and two chunks, each with its length.
std::string glb() {
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[
{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t number) {
    return std::string{static_cast<char>(number), static_cast<char>(number >> 8), '\0', '\0'};
  };
  std::string corners(36, '\0');
  for (const std::size_t one : {12U, 28U}) corners.replace(one, 4, std::string("\0\0\x80\x3f", 4));
  return "glTF" + word(2) + word(28 + json.size() + 36) + word(json.size()) + "JSON" + json +
         word(36) + std::string("BIN\0", 4) + corners;
}

std::vector<Sample> samples() {
  const MeshFile file = small_file();
  const std::string strips =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n8 0 1 2 -1 2 1 0 -1\n";
  return {{".ply", content_of("a.ply", file, Encoding::binary)},
          {".ply", content_of("a.ply", file, Encoding::binary_big_endian)},
          {".ply", content_of("a.ply", file, Encoding::text), false},
          {".ply", strips, false},
          {".obj", content_of("a.obj", file, Encoding::text), false},
          {".off",
           "CNOFF # unit: m\n3 1 0\n0 0 0 0 0 1 255 0 7\n1 0 0 0 0 1 9 0 7\n"
           "0 1 0 0 0 1 9 0 7\n3 0 1 2\n",
           false},
          {".stl", content_of("a.stl", file, Encoding::binary)},
          {".stl", content_of("a.stl", file, Encoding::text), false},
          {".pcd", pcd(Encoding::binary)},
          {".pcd", pcd(Encoding::text), false},
          {".pcd", compressed_pcd()},
          {".gltf", gltf(), true, kAssimpRounds},
          {".glb", glb(), true, kAssimpRounds}};
}

/// Runs `read`, which either returns something that `check` finds sound, or refuses with the file's
/// name. Returns true if it was read.
template <typename Read, typename Check>
bool is_read(const fs::path& path, Read read, Check check) {
  try {
    check(read());
    return true;
  } catch (const FileError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(path.string())) << error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << typeid(error).name() << ": " << error.what();
  }
  return false;
}

/// Reads it as a mesh and as points. Returns true if either was read.
bool is_read(const fs::path& path) {
  const bool as_mesh = is_read(
      path, [&] { return read_mesh_file(path); },
      [](const MeshFile& file) {
        check_mesh(file.mesh, "mesh");
        check_attributes(file.vertex_attributes, file.mesh.vertices.cols(), "vertices");
        check_attributes(file.triangle_attributes, file.mesh.triangles.cols(), "triangles");
      });
  const bool as_points = is_read(
      path, [&] { return read_point_cloud(path); },
      [](const PointCloud& cloud) {
        EXPECT_GT(cloud.points.cols(), 0);
        EXPECT_EQ(cloud.width * cloud.height, cloud.points.cols());
        check_attributes(cloud.attributes, cloud.points.cols(), "points");
      });
  return as_mesh || as_points;
}

/// While it lives, this process can take no more than `bytes` of memory above its current use. Does
/// nothing under AddressSanitizer, which does not work with this limit.
class SmallMemory {
 public:
  explicit SmallMemory(rlim_t bytes) {
    ::getrlimit(RLIMIT_AS, &limit_);
#ifndef __SANITIZE_ADDRESS__
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlimit small{pages * 4096 + bytes, limit_.rlim_max};
    ::setrlimit(RLIMIT_AS, &small);
#else
    static_cast<void>(bytes);
#endif
  }
  ~SmallMemory() { ::setrlimit(RLIMIT_AS, &limit_); }
  SmallMemory(const SmallMemory&) = delete;
  SmallMemory& operator=(const SmallMemory&) = delete;

 private:
  rlimit limit_{};
};

constexpr rlim_t kLittleMemory = 64 << 20;  // bytes; a thousand times more than any sample takes

TEST(BrokenFiles, TheSamplesThemselvesAreRead) {
  const ScratchFolder folder;
  for (const Sample& sample : samples()) {
    const fs::path path = folder / ("a" + sample.ending);
    overwrite(path, sample.content);
    EXPECT_TRUE(is_read(path)) << sample.ending;
  }
}

TEST(BrokenFiles, AreRefusedWhereverTheyEnd) {
  const ScratchFolder folder;
  for (const Sample& sample : samples()) {
    const fs::path path = folder / ("a" + sample.ending);
    for (std::size_t size = 0; size < sample.content.size(); ++size) {
      overwrite(path, sample.content.substr(0, size));
      const bool read = is_read(path);
      // A text may lack its last numbers and be a text still; other formats know their length.
      EXPECT_FALSE(read && sample.whole) << sample.ending << " of " << size << " bytes";
    }
  }
}

/// One to four bytes changed, removed or inserted; digits often become other digits, so that counts
/// and indices are hit and not only the words between them.
std::string damaged(std::string content, std::mt19937& random) {
  for (unsigned changes = 1 + random() % 4; changes > 0 && !content.empty(); --changes) {
    const std::size_t place = random() % content.size();
    const std::size_t digit = content.find_first_of("0123456789", place);
    switch (random() % 5) {
      case 0:
        content[place] = static_cast<char>(random());
        break;
      case 1:
        content.erase(place, 1 + random() % 8);
        break;
      case 2:
        content.insert(place, 1, static_cast<char>(random()));
        break;
      case 3:
        if (digit != std::string::npos) content.insert(digit, 1 + random() % 9, '9');
        break;
      default:
        if (digit != std::string::npos) content[digit] = static_cast<char>('0' + random() % 10);
    }
  }
  return content;
}

TEST(BrokenFiles, RandomDamageIsRefusedOrHarmlessAndTakesLittleMemory) {
  const ScratchFolder folder;
  std::mt19937 random(20);
  for (const Sample& sample : samples()) {
    const fs::path path = folder / ("a" + sample.ending);
    int refused = 0;
    const SmallMemory limit(kLittleMemory);
    for (int i = 0; i < sample.rounds; ++i) {
      const std::string content = damaged(sample.content, random);
      overwrite(path, content);
      refused += is_read(path) ? 0 : 1;
      if (::testing::Test::HasFailure()) FAIL() << sample.ending << "\n" << content;
    }
    EXPECT_GT(refused, sample.rounds / 20) << sample.ending;
  }
}

TEST(BrokenFiles, HugeCountsTakeNoMemory) {
  const ScratchFolder folder;
  const SmallMemory limit(kLittleMemory);
  const auto refuse = [&](const std::string& name, const std::string& content) {
    overwrite(folder / name, content);
    EXPECT_FALSE(is_read(folder / name)) << content;
  };
  const std::string vertex = "\nproperty float x\nproperty float y\nproperty float z\n";
  for (const std::string count : {"100000000", "4294967295", "18446744073709551615"}) {
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      const std::string ply = "ply\nformat " + format + " 1.0\nelement vertex ";
      refuse("a.ply", ply + count + vertex + "end_header\n");
      refuse("a.ply", ply + "0" + vertex + "element face " + count +
                          "\nproperty list uchar int vertex_indices\nend_header\n");
      refuse("a.ply", ply + "1" + vertex + "property list uint double d\nend_header\n" +
                          (format == "ascii" ? "0 0 0 " + count : std::string(16, '\x7f')));
    }
    refuse("a.off", "OFF " + count + " 1 0\n");
    for (const std::string data : {"ascii", "binary", "binary_compressed"})
      refuse("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS " + count + "\nDATA " + data +
                          "\n" + std::string(8, '\x7f'));
  }
  refuse("a.stl", std::string(80, ' ') + std::string(4, '\xff'));
}

}  // namespace
}  // namespace palpate::geometry
