// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/depth_array.h"

#include <bit>
#include <cstddef>
#include <ostream>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"

namespace palpate::geometry {

void write_depth_array(const std::filesystem::path& path, const ImageF& z) {
  if (z.size() == 0) throw InvalidInput(path.string() + ": a range map without pixels to write");
  // Version 1.0: magic number and version, the size of the description in two bytes, and the
  // description, which spaces and a line end fill up to a multiple of 64 bytes in all.
  constexpr std::size_t kBefore = 10, kMultiple = 64;
  std::string text = std::string("{'descr': '") +
                     (std::endian::native == std::endian::little ? '<' : '>') +
                     "f4', 'fortran_order': False, 'shape': (" + std::to_string(z.rows()) + ", " +
                     std::to_string(z.cols()) + "), }";
  text.resize((kBefore + text.size() + 1 + kMultiple - 1) / kMultiple * kMultiple - kBefore - 1,
              ' ');
  text += '\n';
  write_file(path, [&](std::ostream& out) {
    out.write("\x93NUMPY\x01\x00", 8);
    out.put(static_cast<char>(text.size() & 0xFFU));
    out.put(static_cast<char>(text.size() >> 8U));
    out << text;
    out.write(reinterpret_cast<const char*>(z.data()),
              static_cast<std::streamsize>(sizeof(float)) * z.size());
  });
}

}  // namespace palpate::geometry
