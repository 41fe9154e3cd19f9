// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/surface_response_file.h"

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <ostream>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"

namespace palpate::haptics {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are written as they are in memory");

constexpr std::array<char, 8> kMagic = {'P', 'A', 'L', 'P', 'D', 'E', 'F', 'O'};
constexpr std::uint32_t kFileVersion = 1;

// The header of the file; nodes, weights, dents, responses and recorded surfaces follow.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kFileVersion, vertices = 0, nodes = 0, contacts = 0, shapes = 0, zero = 0;
  double rms = 0, largest = 0, reach = 0, kept_rms = 0, kept_largest = 0;
};
static_assert(sizeof(Header) == 72);

// Bytes after the header.
std::uint64_t body_size(const Header& header) {
  constexpr std::uint64_t kDent = 2 * SurfaceResponse::kDentPlaces;
  return std::uint64_t{12} * header.vertices + kDent * header.contacts +
         std::uint64_t{18} * header.nodes * header.contacts +
         (std::uint64_t{16} + std::uint64_t{6} * header.nodes) * header.shapes;
}

Header header_of(const SurfaceResponse& response) {
  Header header;
  header.vertices = static_cast<std::uint32_t>(response.nodes.cols());
  header.nodes = static_cast<std::uint32_t>(response.responses.rows() / 9);
  header.contacts = static_cast<std::uint32_t>(response.responses.cols());
  header.shapes = static_cast<std::uint32_t>(response.shape_contacts.size());
  header.rms = response.rms;
  header.largest = response.largest;
  header.reach = response.reach;
  header.kept_rms = response.kept_rms;
  header.kept_largest = response.kept_largest;
  return header;
}

template <typename Matrix>
void put(std::ostream& out, const Matrix& matrix) {
  out.write(reinterpret_cast<const char*>(matrix.data()),
            static_cast<std::streamsize>(sizeof(*matrix.data())) * matrix.size());
}

template <typename Matrix>
void take(const char*& from, Matrix& matrix) {
  const std::size_t size = sizeof(*matrix.data()) * static_cast<std::size_t>(matrix.size());
  std::memcpy(static_cast<void*>(matrix.data()), from, size);
  from += size;
}

}  // namespace

SurfaceResponse read_surface_response(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  if (!in || size < 0) throw FileError(path.string() + ": cannot be read");
  in.seekg(0);
  Header header;
  in.read(reinterpret_cast<char*>(&header), sizeof(header));
  if (!in || header.magic != kMagic) {
    throw FileError(path.string() +
                    ": is not a response of a surface: its first bytes are not PALPDEFO");
  }
  if (header.version != kFileVersion) {
    throw FileError(path.string() + ": has version " + std::to_string(header.version) +
                    "; this program reads version " + std::to_string(kFileVersion));
  }
  const std::uint64_t expected = sizeof(header) + body_size(header);
  if (static_cast<std::uint64_t>(size) != expected) {
    throw FileError(path.string() + ": has " + std::to_string(size) + " bytes; its header tells " +
                    std::to_string(expected) + ": it is truncated or damaged");
  }
  std::vector<char> body(static_cast<std::size_t>(body_size(header)));
  if (!in.read(body.data(), static_cast<std::streamsize>(body.size())))
    throw FileError(path.string() + ": cannot be read");
  SurfaceResponse response;
  response.nodes.resize(3, header.vertices);
  response.weights.resize(3, header.vertices);
  response.dents.resize(Eigen::NoChange, header.contacts);
  response.responses.resize(Eigen::Index{9} * header.nodes, header.contacts);
  response.shape_contacts.resize(header.shapes);
  response.displacements.resize(Eigen::NoChange, header.shapes);
  response.moves.resize(Eigen::Index{3} * header.nodes, header.shapes);
  const char* from = body.data();
  take(from, response.nodes);
  take(from, response.weights);
  take(from, response.dents);
  take(from, response.responses);
  take(from, response.shape_contacts);
  take(from, response.displacements);
  take(from, response.moves);
  response.rms = header.rms;
  response.largest = header.largest;
  response.reach = header.reach;
  response.kept_rms = header.kept_rms;
  response.kept_largest = header.kept_largest;
  return response;
}

std::uint64_t surface_response_size(const SurfaceResponse& response) {
  return sizeof(Header) + body_size(header_of(response));
}

void write_surface_response(const std::filesystem::path& path, const SurfaceResponse& response) {
  const Header header = header_of(response);
  write_file(path, [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(&header), sizeof(header));
    put(out, response.nodes);
    put(out, response.weights);
    put(out, response.dents);
    put(out, response.responses);
    put(out, response.shape_contacts);
    put(out, response.displacements);
    put(out, response.moves);
  });
}

}  // namespace palpate::haptics
