// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `mat_array`.
#include "records/mat_array.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <string_view>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

/// The last complaint of libmatio. It continues after damage that it has noticed.
thread_local std::string complaint;

void keep_complaint(int /*level*/, char* message) { complaint = message; }

struct MatDelete {
  void operator()(mat_t* file) const { Mat_Close(file); }
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw FileError(where + ": " + what + "; the file is damaged or cut off, copy it again");
}

/// Returns true if these are whole compressed data, by their checksum.
bool can_be_unpacked(std::string_view bytes) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::array<Bytef, 1 << 16> unpacked{};
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = unpacked.data();
    stream.avail_out = unpacked.size();
    status = inflate(&stream, Z_NO_FLUSH);
  }
  inflateEnd(&stream);
  return status == Z_STREAM_END;
}

/// Checks that a file of version 5 to 7.2 has all bytes that its data elements claim, and the
/// checksums of what is compressed. Libmatio returns memory that it has not set where they are
/// wrong.
void check_elements(const std::filesystem::path& path) {
  constexpr std::size_t kHeader = 128, kByteOrder = 126, kTag = 8;
  constexpr std::uint32_t kCompressed = 15;
  std::string content(std::filesystem::file_size(path), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(content.data(), static_cast<std::streamsize>(content.size()));
  const bool swapped = content[kByteOrder] == 'M';  // "IM" where the byte order is this machine's
  const auto word = [&](std::size_t at) {
    std::array<char, 4> bytes{};
    std::memcpy(bytes.data(), content.data() + at, bytes.size());
    if (swapped) std::ranges::reverse(bytes);
    return std::bit_cast<std::uint32_t>(bytes);
  };
  for (std::size_t at = kHeader; at < content.size();) {
    if (content.size() - at < kTag) refuse(path.string(), "a data element has no complete tag");
    const std::uint32_t type = word(at), size = word(at + 4);
    at += kTag;
    if (size > content.size() - at) {
      refuse(path.string(), "a data element claims " + std::to_string(size) + " bytes, " +
                                std::to_string(content.size() - at) + " are left");
    }
    if (type == kCompressed && !can_be_unpacked(std::string_view(content).substr(at, size)))
      refuse(path.string(), "compressed data cannot be unpacked");
    at += size;
  }
}

template <typename Number>
std::vector<double> as_doubles(const matvar_t& variable, std::size_t count) {
  const auto* const first = static_cast<const Number*>(variable.data);
  return {first, first + count};
}

std::vector<double> numbers_of(const matvar_t& variable, std::size_t count) {
  switch (variable.data_type) {
    case MAT_T_DOUBLE:
      return as_doubles<double>(variable, count);
    case MAT_T_SINGLE:
      return as_doubles<float>(variable, count);
    case MAT_T_INT8:
      return as_doubles<std::int8_t>(variable, count);
    case MAT_T_UINT8:
      return as_doubles<std::uint8_t>(variable, count);
    case MAT_T_INT16:
      return as_doubles<std::int16_t>(variable, count);
    case MAT_T_UINT16:
      return as_doubles<std::uint16_t>(variable, count);
    case MAT_T_INT32:
      return as_doubles<std::int32_t>(variable, count);
    case MAT_T_UINT32:
      return as_doubles<std::uint32_t>(variable, count);
    case MAT_T_INT64:
      return as_doubles<std::int64_t>(variable, count);
    case MAT_T_UINT64:
      return as_doubles<std::uint64_t>(variable, count);
    default:
      return {};
  }
}

/// Deflate makes at most this many bytes of one (zlib.net/zlib_tech.html).
constexpr std::size_t kMostUnpacked = 1032;

/// \param most numbers that the file can hold.
MatArray array_of(const matvar_t& variable, const std::string& where, std::size_t most) {
  MatArray array = {.kind = variable.class_type,
                    .complex = variable.isComplex != 0,
                    .size = {variable.dims, variable.dims + variable.rank},
                    .numbers = {}};
  std::size_t count = 1;
  for (const std::size_t each : array.size) count *= each;
  if (array.kind == MAT_C_STRUCT && count == 1) {
    char* const* const names = Mat_VarGetStructFieldnames(&variable);
    const std::size_t fields = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(&variable));
    if (fields > 0 && (names == nullptr || variable.data == nullptr))
      refuse(where, "its fields cannot be read");
    for (std::size_t i = 0; i < fields; ++i) {
      const matvar_t* const field =
          Mat_VarGetStructFieldByIndex(const_cast<matvar_t*>(&variable), i, 0);
      if (field == nullptr) refuse(where, std::string("field ") + names[i] + " cannot be read");
      array.fields[names[i]] = array_of(*field, where + "." + names[i], most);
    }
  } else if (array.kind >= MAT_C_DOUBLE && array.kind <= MAT_C_UINT64 && !array.complex) {
    if (count > most) {
      refuse(where, "claims " + std::to_string(count) + " numbers, more than a file of this size " +
                        "can hold");
    }
    if (count > 0 && (variable.data == nullptr ||
                      variable.nbytes != count * static_cast<std::size_t>(variable.data_size)))
      refuse(where, "the numbers are not complete");
    array.numbers = numbers_of(variable, count);
    if (array.numbers.size() != count) refuse(where, "the numbers are of an unknown type");
  }
  return array;
}

std::map<std::string, MatArray> read(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw FileError(path.string() + ": there is no such file; expected a MAT file");
  if (std::filesystem::file_size(path, error) == 0)
    throw FileError(path.string() + ": the file is empty; expected a MAT file");
  if (!std::ifstream(path, std::ios::binary))
    throw FileError(path.string() + ": cannot be read; check its permissions");
  static const bool kListening = Mat_LogInitFunc("palpate", keep_complaint) == 0;
  complaint.clear();
  const std::unique_ptr<mat_t, MatDelete> file(kListening ? Mat_Open(path.c_str(), MAT_ACC_RDONLY)
                                                          : nullptr);
  const mat_ft version = file ? Mat_GetVersion(file.get()) : MAT_FT_UNDEFINED;
  if (version != MAT_FT_MAT5 && version != MAT_FT_MAT73) {
    throw FileError(path.string() +
                    ": is not a MAT file of version 5 to 7.3; save it with save('NAME.mat', ..., "
                    "'-v7') in MATLAB or Octave, or scipy.io.savemat in Python");
  }
  std::size_t most = std::numeric_limits<std::size_t>::max();
  if (version == MAT_FT_MAT5) {
    check_elements(path);
    most = kMostUnpacked * std::filesystem::file_size(path);
  }
  std::map<std::string, MatArray> variables;
  while (const std::unique_ptr<matvar_t, MatDelete> variable{Mat_VarReadNext(file.get())}) {
    if (!complaint.empty()) break;
    if (variable->name != nullptr)
      variables[variable->name] = array_of(*variable, path.string() + ": " + variable->name, most);
  }
  if (!complaint.empty()) refuse(path.string(), "libmatio reports: " + complaint);
  // It returns no variable at the end, and none where it cannot read one.
  std::size_t expected = 0;
  Mat_GetDir(file.get(), &expected);
  if (variables.size() < expected) refuse(path.string(), "some variables cannot be read");
  return variables;
}

}  // namespace
}  // namespace palpate::probing

const palpate::probing::MatArrays palpate_mat_array{&palpate::probing::read};
