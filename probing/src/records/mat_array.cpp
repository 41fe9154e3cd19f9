// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "records/mat_array.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "palpate/error.h"

namespace palpate::probing {
namespace {

// Types of data elements (MATLAB, "MAT-File Format", table 1-1).
enum MatType : std::uint32_t {
  kMatInt8 = 1,
  kMatUint8 = 2,
  kMatInt16 = 3,
  kMatUint16 = 4,
  kMatInt32 = 5,
  kMatUint32 = 6,
  kMatSingle = 7,
  kMatDouble = 9,
  kMatInt64 = 12,
  kMatUint64 = 13,
  kMatMatrix = 14,
  kMatCompressed = 15
};

constexpr std::size_t kHeaderSize = 128, kVersionPlace = 124, kEndianPlace = 126;
constexpr std::size_t kMatTagSize = 8;

/// Bytes of a number; 0 for what is none.
std::size_t size_of_number(std::uint32_t type) {
  switch (type) {
    case kMatInt8:
    case kMatUint8:
      return 1;
    case kMatInt16:
    case kMatUint16:
      return 2;
    case kMatInt32:
    case kMatUint32:
    case kMatSingle:
      return 4;
    case kMatDouble:
    case kMatInt64:
    case kMatUint64:
      return 8;
    default:
      return 0;
  }
}

template <typename Number>
Number load_number(const char* at, bool swapped) {
  std::array<char, sizeof(Number)> bytes{};
  std::memcpy(bytes.data(), at, sizeof(Number));
  if (swapped) std::ranges::reverse(bytes);
  return std::bit_cast<Number>(bytes);
}

struct MatElement {
  std::uint32_t type = 0;
  std::string_view bytes;
};

/// Takes data elements one by one from a piece of a file.
class MatCursor {
 public:
  MatCursor(std::string_view bytes, bool swapped, std::string where)
      : rest_(bytes), swapped_(swapped), where_(std::move(where)) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] bool swapped() const { return swapped_; }
  [[nodiscard]] const std::string& where() const { return where_; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw FileError(where_ + ": " + what + "; the file is damaged or cut off, copy it again");
  }

  MatElement take() {
    if (rest_.size() < kMatTagSize) refuse("a data element has no complete tag");
    const auto first = load_number<std::uint32_t>(rest_.data(), swapped_);
    MatElement element;
    const std::uint32_t small = first >> 16;  // such an element has up to 4 bytes inside its tag
    if (small != 0) {
      if (small > 4) refuse("a small data element claims " + std::to_string(small) + " bytes");
      element = {first & 0xFFFFU, rest_.substr(4, small)};
      rest_.remove_prefix(kMatTagSize);
      return element;
    }
    const std::size_t size = load_number<std::uint32_t>(rest_.data() + 4, swapped_);
    rest_.remove_prefix(kMatTagSize);
    if (size > rest_.size()) {
      refuse("a data element claims " + std::to_string(size) + " bytes, " +
             std::to_string(rest_.size()) + " are left");
    }
    element = {first, rest_.substr(0, size)};
    const std::size_t padded = first == kMatCompressed ? size : (size + 7) / 8 * 8;
    rest_.remove_prefix(std::min(padded, rest_.size()));
    return element;
  }

  /// The next element, of this type.
  MatElement take(std::uint32_t type, const char* what) {
    const MatElement element = take();
    if (element.type != type) refuse(std::string("there is no ") + what);
    return element;
  }

 private:
  std::string_view rest_;
  bool swapped_;
  std::string where_;
};

std::string inflated(std::string_view bytes, const MatCursor& cursor) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!inflater) throw std::bad_alloc();
  // The format does not say how large the content is. Deflate shrinks at most to 1 / 1032.
  constexpr std::size_t kFirstFactor = 4, kMostFactor = 1032, kLeast = 256;
  const std::size_t most = std::max(kLeast, kMostFactor * bytes.size());
  for (std::size_t size = std::max(kLeast, kFirstFactor * bytes.size());;
       size = std::min(2 * size, most)) {
    std::string content(size, '\0');
    std::size_t used = 0;
    const libdeflate_result result = libdeflate_zlib_decompress(
        inflater.get(), bytes.data(), bytes.size(), content.data(), size, &used);
    if (result == LIBDEFLATE_SUCCESS) {
      content.resize(used);
      return content;
    }
    if (result != LIBDEFLATE_INSUFFICIENT_SPACE || size == most)
      cursor.refuse("compressed data cannot be unpacked");
  }
}

/// Product of the sizes; none if it overflows.
std::optional<std::size_t> element_count(const std::vector<std::size_t>& size) {
  std::size_t count = 1;
  for (const std::size_t each : size) {
    if (each != 0 && count > std::numeric_limits<std::uint32_t>::max() / each) return std::nullopt;
    count *= each;
  }
  return count;
}

std::pair<std::string, MatArray> parse_matrix(std::string_view bytes, bool swapped,
                                              const std::string& where, int depth);

void parse_fields(MatCursor& cursor, MatArray& array, int depth) {
  const MatElement length_element = cursor.take(kMatInt32, "length of field names");
  if (length_element.bytes.size() != 4) cursor.refuse("the length of field names is no number");
  const auto length = load_number<std::uint32_t>(length_element.bytes.data(), cursor.swapped());
  const MatElement names = cursor.take(kMatInt8, "list of field names");
  if (length == 0 || names.bytes.size() % length != 0)
    cursor.refuse("the list of field names has no whole number of names");
  for (std::size_t at = 0; at < names.bytes.size(); at += length) {
    const std::string_view padded = names.bytes.substr(at, length);
    const std::string name(padded.substr(0, std::min(padded.find('\0'), padded.size())));
    const MatElement field = cursor.take(kMatMatrix, "field of a structure");
    array.fields[name] =
        parse_matrix(field.bytes, cursor.swapped(), cursor.where() + "." + name, depth + 1).second;
  }
}

/// A matrix element: its name and content. Only structures of size 1 x 1 have their fields read.
std::pair<std::string, MatArray> parse_matrix(std::string_view bytes, bool swapped,
                                              const std::string& where, int depth) {
  constexpr int kDeepest = 32;  // structures in structures; keeps the stack
  std::pair<std::string, MatArray> result;
  MatArray& array = result.second;
  if (bytes.empty()) {  // an empty field
    array.kind = MatClass::double_precision;
    array.size = {0, 0};
    array.stored = kMatDouble;
    return result;
  }
  MatCursor cursor(bytes, swapped, where);
  if (depth > kDeepest) cursor.refuse("structures are nested too deeply");
  const MatElement flags = cursor.take(kMatUint32, "array flags");
  if (flags.bytes.size() != 8) cursor.refuse("array flags are incomplete");
  const auto word = load_number<std::uint32_t>(flags.bytes.data(), swapped);
  array.kind = static_cast<MatClass>(word & 0xFFU);
  array.complex = (word & 0x0800U) != 0;
  const MatElement sizes = cursor.take(kMatInt32, "size of the array");
  for (std::size_t at = 0; at + 4 <= sizes.bytes.size(); at += 4)
    array.size.push_back(load_number<std::uint32_t>(sizes.bytes.data() + at, swapped));
  const std::optional<std::size_t> count = element_count(array.size);
  if (array.size.size() < 2 || !count) cursor.refuse("the size of the array is impossible");
  const MatElement name = cursor.take(kMatInt8, "name of the array");
  result.first = std::string(name.bytes);
  if (array.kind == MatClass::structure && *count == 1) {
    parse_fields(cursor, array, depth);
  } else if (array.kind >= MatClass::double_precision && array.kind <= MatClass::uint64) {
    const MatElement numbers = cursor.take();
    const std::size_t each = size_of_number(numbers.type);
    if (each == 0 || numbers.bytes.size() != each * *count) {
      cursor.refuse("array '" + result.first + "' of " + std::to_string(*count) + " numbers has " +
                    std::to_string(numbers.bytes.size()) + " bytes of type " +
                    std::to_string(numbers.type));
    }
    array.stored = numbers.type;
    array.bytes = numbers.bytes;
  }
  return result;
}

template <typename Number>
void append_numbers(std::string_view bytes, bool swapped, std::vector<double>& numbers) {
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Number))
    numbers.push_back(static_cast<double>(load_number<Number>(bytes.data() + at, swapped)));
}

const char* const kSaveAgain =
    "save it with save('NAME.mat', ..., '-v7') in MATLAB or Octave, or scipy.io.savemat in Python";

void check_mat_header(const std::string& content, const std::string& path, bool& swapped) {
  const auto refuse = [&](const std::string& what) {
    throw FileError(path + ": " + what + "; " + kSaveAgain);
  };
  if (content.starts_with("\x89HDF") || content.starts_with("MATLAB 7.3 MAT-file"))
    refuse("is a MAT file of version 7.3 (HDF5), which is not read");
  if (content.size() < kHeaderSize) refuse("is not a MAT file of level 5");
  const auto marker = load_number<std::uint16_t>(content.data() + kEndianPlace, false);
  constexpr std::uint16_t kSame = 0x4D49, kSwapped = 0x494D;  // "MI"
  if (marker != kSame && marker != kSwapped) refuse("is not a MAT file of level 5");
  swapped = marker == kSwapped;
  const auto version = load_number<std::uint16_t>(content.data() + kVersionPlace, swapped);
  constexpr std::uint16_t kLevel5 = 0x0100;
  if (version != kLevel5) refuse("is a MAT file of another version than level 5");
}

}  // namespace

MatVariables parse_mat(std::string content, const std::string& path) {
  MatVariables variables;
  check_mat_header(content, path, variables.swapped);
  const std::string& file = variables.memory.emplace_back(std::move(content));
  MatCursor cursor(std::string_view(file).substr(kHeaderSize), variables.swapped, path);
  while (!cursor.at_end()) {
    MatElement element = cursor.take();
    if (element.type == kMatCompressed) {
      const std::string& plain = variables.memory.emplace_back(inflated(element.bytes, cursor));
      element = MatCursor(plain, variables.swapped, path).take();
    }
    if (element.type != kMatMatrix) continue;
    auto [name, array] = parse_matrix(element.bytes, variables.swapped, path, 0);
    if (!name.empty()) variables.by_name[name] = std::move(array);
  }
  return variables;
}

std::vector<double> numbers_of(const MatArray& array, bool swapped) {
  std::vector<double> numbers;
  const std::size_t each = size_of_number(array.stored);
  if (each == 0) return numbers;
  numbers.reserve(array.bytes.size() / each);
  switch (array.stored) {
    case kMatInt8:
      append_numbers<std::int8_t>(array.bytes, swapped, numbers);
      break;
    case kMatUint8:
      append_numbers<std::uint8_t>(array.bytes, swapped, numbers);
      break;
    case kMatInt16:
      append_numbers<std::int16_t>(array.bytes, swapped, numbers);
      break;
    case kMatUint16:
      append_numbers<std::uint16_t>(array.bytes, swapped, numbers);
      break;
    case kMatInt32:
      append_numbers<std::int32_t>(array.bytes, swapped, numbers);
      break;
    case kMatUint32:
      append_numbers<std::uint32_t>(array.bytes, swapped, numbers);
      break;
    case kMatSingle:
      append_numbers<float>(array.bytes, swapped, numbers);
      break;
    case kMatDouble:
      append_numbers<double>(array.bytes, swapped, numbers);
      break;
    case kMatInt64:
      append_numbers<std::int64_t>(array.bytes, swapped, numbers);
      break;
    default:
      append_numbers<std::uint64_t>(array.bytes, swapped, numbers);
  }
  return numbers;
}

}  // namespace palpate::probing
