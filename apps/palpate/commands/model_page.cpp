// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/model_page.h"

#include <libdeflate.h>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <cstddef>
#include <fstream>
#include <memory>
#include <span>
#include <sstream>
#include <string_view>
#include <vector>

#include "commands/report_page.h"
#include "palpate/error.h"
#include "palpate/haptics/model_bytes.h"
#include "shared/bundled_files.h"

namespace palpate::apps {
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

std::string page_template() {
  const std::filesystem::path path = bundled(PALPATE_INSTALLED_PAGE, PALPATE_BUILT_PAGE);
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw FileError(path.string() + ": cannot be read");
  return text.str();
}

// Replaces a mark wherever it is.
void fill(std::string& page, std::string_view mark, const std::string& text) {
  std::size_t at = page.find(mark);
  if (at == std::string::npos) {
    throw FileError("the template of pages has no " + std::string(mark) + "; install it again");
  }
  for (; at != std::string::npos; at = page.find(mark, at + text.size())) {
    page.replace(at, mark.size(), text);
  }
}

}  // namespace

std::string model_page(const haptics::Model& model, const std::string& title) {
  std::string page = page_template();
  fill(page, "{{model}}", base64(gzip(haptics::to_bytes(model))));
  fill(page, "{{title}}", html_escaped(title));  // last, because it may be any text
  return page;
}

}  // namespace palpate::apps
