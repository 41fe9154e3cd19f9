// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Memory that readers take for files that need the most of each format.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tiffio.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/core/memory_limit.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "refusal.h"

namespace palpate::geometry {
namespace {

/// Size of each file: so large that the memory of the process without it does not matter.
constexpr std::size_t kFileBytes = 2'000'000;

std::string repeated(const std::string& head, const std::string& line) {
  std::string content = head;
  while (content.size() < kFileBytes) content += line;
  return content;
}

/// [bytes] Peak memory of a separate process that does the work.
double peak_of(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      work();
    } catch (const Error&) {  // a refused file must not take more either
    }
    ::_exit(0);
  }
  int status = 0;
  struct rusage usage = {};
  ::wait4(child, &status, 0, &usage);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

TEST(Memory, OfEachReaderIsWithinTheLimit) {
  const ScratchFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n"
      "property double y\nproperty double z\n";
  const std::vector<std::pair<std::string, std::string>> files = {
      {"vertices.obj", repeated("", "v 0 0 0\n") + "f 1 2 3\n"},
      {"faces.obj", repeated("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n")},
      {"comments.obj", repeated("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "#\n")},
      {"texture.obj", repeated("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "vt 0\nf 1/1 2/1 3/1\n")},
      {"materials.obj", repeated("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "mtllib a\n") + "f 1 2 3\n"},
      {"normals.obj", repeated("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "vn 0 0 1\n") + "f 1 2 3\n"},
      {"text.stl", "solid\n" +
                       repeated("",
                                "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 "
                                "vertex 0 1 0 endloop endfacet\n") +
                       "endsolid\n"},
      {"faces.off", repeated("OFF\n3 300000 0\n0 0 0\n1 0 0\n0 1 0\n", "3 0 1 2\n")},
      {"comments.ply", repeated("ply\nformat ascii 1.0\n", "comment\n")},
      {"lists.ply", repeated(ply + "property list uchar uchar a\nproperty list uchar uchar b\n"
                                   "element face 1000000\n"
                                   "property list uchar int vertex_indices\nend_header\n"
                                   "0 0 0 0 0\n0 1 0 0 0\n1 0 0 0 0\n",
                             "0\n")},
      {"points.pcd", repeated("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                              "WIDTH 333000\nHEIGHT 1\nPOINTS 333000\nDATA ascii\n",
                              "0 0 0\n")}};
  const double nothing = peak_of([] {});
  for (const auto& [name, content] : files) {
    write_text(folder / name, content);
    const double taken = peak_of([&, name = name] {
      if (name.ends_with(".pcd"))
        static_cast<void>(read_point_cloud(folder / name));
      else
        static_cast<void>(read_mesh_file(folder / name));
    });
    EXPECT_LT(taken - nothing, kMemoryOfFile * static_cast<double>(content.size())) << name;
  }
}

TEST(Memory, OfContentThatIsCompressedBeyondTheLimitIsRefused) {
  const ScratchFolder folder;
  const std::string path = folder / "plain.tiff";
  TIFF* file = TIFFOpen(path.c_str(), "w");
  constexpr std::uint32_t kColumns = 12000, kRows = 6000;  // 72 million pixels, 576 MB
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, kColumns);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, kRows);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 32);
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  constexpr std::uint32_t kStrip = 10;
  TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, kStrip);
  std::vector<float> strip(std::size_t{kStrip} * kColumns, 0.0F);
  // It is refused before the missing strips are noticed.
  TIFFWriteEncodedStrip(file, 0, strip.data(), static_cast<tmsize_t>(strip.size() * sizeof(float)));
  TIFFClose(file);
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(path)), FileError,
                        "plain.tiff: its content is so compressed that reading it takes 576 MB");
}

TEST(Memory, OfAnnouncedElementsOfGltfBeyondTheLimitIsRefused) {
  // Of the elements of a sparse accessor, the file has only those that are not zero.
  const ScratchFolder folder;
  const std::string json = R"({"accessors": [{"count": 200000000, "sparse": {"count" :3 }}]})";
  const auto refused = [&](const std::string& name, const std::string& content) {
    write_text(folder / name, content);
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / name)), FileError,
                          name + ": its content is so compressed that reading it takes 12800 MB");
  };
  refused("sparse.gltf", json);
  const auto word = [](std::size_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i, value >>= 8U) bytes += static_cast<char>(value & 0xffU);
    return bytes;
  };
  refused("sparse.glb",
          "glTF" + word(2) + word(20 + json.size()) + word(json.size()) + "JSON" + json);
  write_text(folder / "small.gltf", R"({"asset": {"version": "2.0"}, "scene": 0,
    "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "buffers": [{"byteLength": 44, "uri":
      "data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
    "bufferViews": [{"buffer": 0, "byteLength": 6}, {"buffer": 0, "byteOffset": 8, "byteLength": 36}],
    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
      "max": [1, 1, 0], "sparse": {"count": 3, "values": {"bufferView": 1},
      "indices": {"bufferView": 0, "componentType": 5123}}}]})");
  EXPECT_EQ(read_mesh(folder / "small.gltf").triangles.cols(), 1);
}

TEST(Memory, IsLimitedByTheFileAndByWhatTheUserAllows) {
  EXPECT_FALSE(beyond_memory_limit(kMemoryAllowance + kMemoryOfFile * 10, 10));
  EXPECT_TRUE(beyond_memory_limit(kMemoryAllowance + kMemoryOfFile * 10 + 1, 10));
  const auto allowed = [](const char* gigabytes, double needed) {
    ::setenv(kMemoryVariable, gigabytes, 1);
    const bool is_allowed = !beyond_memory_limit(needed, 10);
    ::unsetenv(kMemoryVariable);
    return is_allowed;
  };
  EXPECT_TRUE(allowed("1.5", 1.5e9));
  EXPECT_FALSE(allowed("1.5", 1.5e9 + 1));
  EXPECT_TRUE(allowed("0.001", kMemoryAllowance));  // it only raises the limit
  for (const char* wrong : {"", "much", "8 GB", "0", "-1", "nan"}) {
    EXPECT_NE(refusal([&] { return allowed(wrong, 1e9); }).find(kMemoryVariable), std::string::npos)
        << wrong;
    ::unsetenv(kMemoryVariable);
  }
  EXPECT_NE(beyond_memory_limit(2.1e9, 10)->find("PALPATE_MAX_READ_GB to 3"), std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
