// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/page_file.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <cmath>
#include <fstream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "commands/report_page.h"
#include "palpate/error.h"
#include "palpate/output_file.h"
#include "palpate/work_in_order.h"
#include "shared/bundled_files.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

constexpr std::string_view kBlocks = "{{blocks}}";

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

FileError incomplete(const std::string& mark) {
  return FileError("the template of pages has no " + mark + "; install it again");
}

/// JSON that ends no element of a page and holds no mark of a template: names of files may be any
/// text.
std::string json_text(const nlohmann::ordered_json& facts) {
  std::string text;
  for (const char c : facts.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else if (c == '{' && text.ends_with('{')) {  // only in names: an object begins with a name
      text += "\\u007b";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

std::string page_template(const std::string& kind) {
  const std::filesystem::path path =
      bundled(PALPATE_INSTALLED_PAGES, PALPATE_BUILT_PAGES) / (kind + ".html");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw FileError(path.string() + ": cannot be read");
  return text.str();
}

void fill(std::string& page, const std::string& mark, const std::string& text) {
  std::size_t at = page.find(mark);
  if (at == std::string::npos) throw incomplete(mark);
  for (; at != std::string::npos; at = page.find(mark, at + text.size()))
    page.replace(at, mark.size(), text);
}

std::string packed_text(std::span<const std::byte> bytes) { return base64(gzip(bytes)); }

namespace {

InvalidInput too_long(const SequencePage& page, std::size_t fitted) {
  const std::size_t all = page.files.size();
  std::string words = fmt::format(
      "{}: a page of {} would be longer than {} MB, and browsers give up on such pages. ",
      page.files.front().string(), all == 1 ? "it" : fmt::format("this and {} more", all - 1),
      page.most_bytes / 1'000'000);
  if (fitted == 0) {
    return InvalidInput(words +
                        "Make a smaller one: palpate mesh --tolerance simplifies a surface.");
  }
  return InvalidInput(words + fmt::format("{} fit. To take only some, evenly spaced: --every {}.",
                                          fitted, (all + fitted - 1) / fitted));
}

std::string block(const std::string& packed) {
  return "<script type=\"application/octet-stream;base64\" class=\"block\">" + packed +
         "</script>\n";
}

struct PageEnds {
  std::string head;  ///< the page up to its blocks
  std::string tail;  ///< what follows them
};

PageEnds ends_of(const SequencePage& page) {
  std::string head = page_template(page.kind);
  const std::size_t split = head.find(kBlocks);
  if (split == std::string::npos) throw incomplete(std::string(kBlocks));
  std::string tail = head.substr(split + kBlocks.size());
  head.resize(split);
  fill(head, "{{facts}}", json_text(page.facts));
  fill(head, "{{title}}", html_escaped(page.title));  // last, because it may be any text
  return {std::move(head), std::move(tail)};
}

}  // namespace

std::size_t write_page(const std::filesystem::path& output, const SequencePage& page) {
  struct Frame {
    std::filesystem::path file;
    std::string block;
  };
  const PageEnds ends = ends_of(page);
  const std::string common = block(packed_text(page.common));
  std::size_t bytes = ends.head.size() + common.size() + ends.tail.size(), taken = 0, done = 0;
  Progress progress("packing");
  write_file(output, [&](std::ostream& file) {
    file << ends.head << common;
    work_in_order<Frame>(
        [&]() -> std::optional<Frame> {
          if (taken == page.files.size()) return std::nullopt;
          return Frame{.file = page.files[taken++], .block = {}};
        },
        [&](Frame& frame) { frame.block = block(packed_text(page.pack(frame.file))); },
        [&](Frame& frame) {
          bytes += frame.block.size();
          if (bytes > page.most_bytes) throw too_long(page, done);
          file << frame.block;
          progress.show(static_cast<int>(++done), static_cast<int>(page.files.size()));
        },
        usual_live_items());
    file << ends.tail;
  });
  return bytes;
}

void ValueRange::add(std::span<const double> values) {
  constexpr std::size_t kSampled = 4000;  // of a frame: enough for a hundredth
  std::vector<float> known;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    known.push_back(static_cast<float>(value));
    min_ = std::min(min_, value);
    max_ = std::max(max_, value);
  }
  const std::size_t step = known.size() / kSampled + 1;
  for (std::size_t i = step / 2; i < known.size(); i += step) sample_.push_back(known[i]);
}

nlohmann::ordered_json ValueRange::to_json() const {
  if (is_empty()) return nullptr;
  std::vector<float> sorted = sample_;
  std::ranges::sort(sorted);
  const std::size_t aside = sorted.size() / 100;
  return {{"min", min_},
          {"max", max_},
          {"low", sorted[aside]},
          {"high", sorted[sorted.size() - 1 - aside]}};
}

}  // namespace palpate::apps
