// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "maker/page_text.h"

#include <libdeflate.h>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <fstream>
#include <memory>
#include <new>
#include <sstream>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::web {
namespace {

std::vector<char> gzip(std::span<const std::byte> bytes) {
  constexpr int kLevel = 9;  // of 12: those above take seconds for a large model
  struct Free {
    void operator()(libdeflate_compressor* compressor) const {
      libdeflate_free_compressor(compressor);
    }
  };
  const std::unique_ptr<libdeflate_compressor, Free> compressor(
      libdeflate_alloc_compressor(kLevel));
  if (!compressor) throw std::bad_alloc();
  std::vector<char> packed(libdeflate_gzip_compress_bound(compressor.get(), bytes.size()));
  packed.resize(libdeflate_gzip_compress(compressor.get(), bytes.data(), bytes.size(),
                                         packed.data(), packed.size()));
  return packed;
}

std::string base64(const std::vector<char>& bytes) {
  using namespace boost::archive::iterators;
  using Digits = base64_from_binary<transform_width<std::vector<char>::const_iterator, 6, 8>>;
  std::string text(Digits(bytes.begin()), Digits(bytes.end()));
  text.append((4 - text.size() % 4) % 4, '=');
  return text;
}

}  // namespace

std::string page_template(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw FileError(path.string() + ": cannot be read");
  return text.str();
}

void fill(std::string& page, const std::string& mark, const std::string& text) {
  std::size_t at = page.find(mark);
  if (at == std::string::npos)
    throw FileError("the template of pages has no " + mark + "; install it again");
  for (; at != std::string::npos; at = page.find(mark, at + text.size()))
    page.replace(at, mark.size(), text);
}

std::string packed_text(std::span<const std::byte> bytes) { return base64(gzip(bytes)); }

}  // namespace palpate::web
