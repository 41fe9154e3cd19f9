// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model_bytes.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

static_assert(std::endian::native == std::endian::little,
              "bytes are written as they are in memory");

// Changes with every change of what `visit` lists.
constexpr std::uint64_t kVersion = 0x0002'4d'50'4c'41'50ULL;  // "PALPM" and a number

template <typename T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ByteWriter {
 public:
  static constexpr bool kReads = false;
  std::vector<std::byte> bytes;

  template <Plain T>
  void value(T& value) {
    raw(&value, 1);
  }
  template <typename T>
  void raw(T* values, std::size_t count) {
    const auto* begin = reinterpret_cast<const std::byte*>(values);
    bytes.insert(bytes.end(), begin, begin + count * sizeof(T));
  }
  std::size_t count(std::size_t count, std::size_t /*least*/) {
    std::uint64_t stored = count;
    value(stored);
    return count;
  }
};

class ByteReader {
 public:
  static constexpr bool kReads = true;
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes), size_(bytes.size()) {}

  template <Plain T>
  void value(T& value) {
    raw(&value, 1);
  }
  template <typename T>
  void raw(T* values, std::size_t count) {
    need(count, sizeof(T));
    std::memcpy(static_cast<void*>(values), rest_.data(), count * sizeof(T));
    rest_ = rest_.subspan(count * sizeof(T));
  }
  // Number of entries that follow; each takes at least this number of bytes.
  std::size_t count(std::size_t /*count*/, std::size_t least) {
    std::uint64_t stored = 0;
    value(stored);
    need(stored, least);
    return static_cast<std::size_t>(stored);
  }
  void end() const {
    if (rest_.empty()) return;
    throw InvalidInput("the bytes of a model go on for " + std::to_string(rest_.size()) +
                       " after its end; they are damaged");
  }

 private:
  void need(std::uint64_t count, std::size_t size) const {
    if (count <= rest_.size() / size) return;
    throw InvalidInput("the " + std::to_string(size_) +
                       " bytes of a model end too early, at byte " +
                       std::to_string(size_ - rest_.size()) + "; they are truncated or damaged");
  }
  std::span<const std::byte> rest_;
  std::size_t size_;
};

// Of one element, so that a damaged number of elements is seen before memory is taken.
template <typename T>
constexpr std::size_t kLeastBytes = 0;
template <>
constexpr std::size_t kLeastBytes<Multiquadric> = 8 * sizeof(double);
template <>
constexpr std::size_t kLeastBytes<RateTerm> = 2 * sizeof(double);
template <>
constexpr std::size_t kLeastBytes<ContactModel> = 19 * sizeof(double);

// Reading a bool or an enum of any value would be undefined behaviour: both go as numbers.
template <typename Archive, typename T>
void number_below(Archive& archive, T& value, std::uint8_t end) {
  auto stored = static_cast<std::uint8_t>(value);
  archive.value(stored);
  if (stored >= end) {
    throw InvalidInput("the bytes of a model hold the choice " + std::to_string(stored) + " of " +
                       std::to_string(end) + "; they are damaged");
  }
  if constexpr (Archive::kReads) value = static_cast<T>(stored);
}

template <typename Archive, typename Scalar, int rows, int columns>
requires(rows > 0 && columns > 0) void visit(Archive& archive,
                                             Eigen::Matrix<Scalar, rows, columns>& matrix) {
  archive.raw(matrix.data(), static_cast<std::size_t>(matrix.size()));
}

template <typename Archive, typename Scalar, int rows>
void visit(Archive& archive, Eigen::Matrix<Scalar, rows, Eigen::Dynamic>& matrix) {
  const std::size_t columns =
      archive.count(static_cast<std::size_t>(matrix.cols()), rows * sizeof(Scalar));
  if constexpr (Archive::kReads) matrix.resize(rows, static_cast<Eigen::Index>(columns));
  archive.raw(matrix.data(), rows * columns);
}

template <typename Archive>
void visit(Archive& archive, double& value) {
  archive.value(value);
}

template <typename Archive, typename T>
void visit(Archive& archive, std::optional<T>& value) {
  bool has = value.has_value();
  number_below(archive, has, 2);
  if constexpr (Archive::kReads) {
    if (has) value.emplace();
  }
  if (has) visit(archive, *value);
}

template <typename Archive, typename T>
void visit(Archive& archive, std::vector<T>& values) {
  const std::size_t count = archive.count(values.size(), kLeastBytes<T>);
  if constexpr (Archive::kReads) values.resize(count);
  for (T& value : values) visit(archive, value);
}

template <typename Archive>
void visit(Archive& archive, Multiquadric& base) {
  archive.value(base.weight);
  archive.value(base.epsilon);
  visit(archive, base.center);
  visit(archive, base.ridge);
}

template <typename Archive>
void visit(Archive& archive, ContactCompliance& compliance) {
  visit(archive, compliance.direction);
  visit(archive, compliance.values);
  visit(archive, compliance.trend);
}

template <typename Archive>
void visit(Archive& archive, ContactStrength& strength) {
  archive.value(strength.value);
  visit(archive, strength.trend);
}

template <typename Archive>
void visit(Archive& archive, ContactUncertainty& uncertainty) {
  archive.value(uncertainty.force);
  archive.value(uncertainty.displacement);
  archive.value(uncertainty.across);
  archive.value(uncertainty.between);
}

template <typename Archive>
void visit(Archive& archive, RateTerm& term) {
  archive.value(term.share);
  archive.value(term.time);
}

template <typename Archive>
void visit(Archive& archive, ContactModel& contact) {
  archive.value(contact.id);
  visit(archive, contact.position);
  visit(archive, contact.frame);
  visit(archive, contact.field.bases);
  archive.value(contact.friction);
  archive.value(contact.load_exponent);
  number_below(archive, contact.friction_source,
               static_cast<std::uint8_t>(FrictionSource::lower_bound) + 1);
  visit(archive, contact.friction_axis);
  visit(archive, contact.compliance);
  visit(archive, contact.strength);
  visit(archive, contact.uncertainty);
}

template <typename Archive>
void visit_columns(Archive& archive, std::size_t rows,
                   Eigen::Matrix<Eigen::half, Eigen::Dynamic, Eigen::Dynamic>& table) {
  const std::size_t columns = archive.count(static_cast<std::size_t>(table.cols()),
                                            std::max<std::size_t>(1, sizeof(Eigen::half) * rows));
  if constexpr (Archive::kReads)
    table.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  archive.raw(table.data(), rows * columns);
}

template <typename Archive>
void visit(Archive& archive, SurfaceResponse& response) {
  visit(archive, response.nodes);
  visit(archive, response.weights);
  const std::size_t rows =
      archive.count(static_cast<std::size_t>(response.responses.rows()), sizeof(Eigen::half));
  visit_columns(archive, rows, response.responses);
  visit(archive, response.dents);
  archive.value(response.reach);
  visit(archive, response.shape_contacts);
  visit(archive, response.displacements);
  visit_columns(archive, rows / 3, response.moves);  // 3 numbers a node instead of 9
  archive.value(response.rms);
  archive.value(response.largest);
  archive.value(response.kept_rms);
  archive.value(response.kept_largest);
}

template <typename Archive>
void visit(Archive& archive, Model& model) {
  visit(archive, model.surface.vertices);
  visit(archive, model.surface.triangles);
  visit(archive, model.contacts);
  visit(archive, model.triangles);
  visit(archive, model.surface_weights.contacts);
  visit(archive, model.surface_weights.weights);
  number_below(archive, model.interpolation.rule,
               static_cast<std::uint8_t>(BlendRule::compliances) + 1);
  archive.value(model.interpolation.reference_force);
  archive.value(model.interpolation.reference_depth);
  archive.value(model.interpolation.reach);
  visit(archive, model.probe_radius);
  archive.value(model.friction_force);
  visit(archive, model.rate);
  visit(archive, model.response);
}

}  // namespace

std::vector<std::byte> to_bytes(const Model& model) {
  check_model(model);
  Model copy = model;
  copy.surface_weights = vertex_weights(model);
  ByteWriter writer;
  std::uint64_t version = kVersion;
  writer.value(version);
  visit(writer, copy);
  return std::move(writer.bytes);
}

Model model_of_bytes(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  std::uint64_t version = 0;
  reader.value(version);
  if (version != kVersion) {
    throw InvalidInput("the bytes are not those of a model, or of another version of Palpate");
  }
  Model model;
  visit(reader, model);
  reader.end();
  check_model(model);
  return model;
}

}  // namespace palpate::haptics
