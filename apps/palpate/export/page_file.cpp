// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/page_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "maker/html_text.h"
#include "maker/page_text.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/work_in_order.h"
#include "shared/program.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

constexpr std::string_view kBlocks = "{{blocks}}";

/// Returns JSON that closes no element of a page and has no placeholder of a template: file names
/// may be any text.
std::string json_text(const Json& facts) {
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

fs::path page_template_path(const std::string& kind) {
  return bundled(PALPATE_INSTALLED_PAGES, PALPATE_BUILT_PAGES) / (kind + ".html");
}

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
  std::string tail;  ///< the page after its blocks
};

PageEnds ends_of(const SequencePage& page) {
  std::string head = web::page_template(page_template_path(page.kind));
  const std::size_t split = head.find(kBlocks);
  if (split == std::string::npos)
    throw FileError("the template of pages has no " + std::string(kBlocks) + "; install it again");
  std::string tail = head.substr(split + kBlocks.size());
  head.resize(split);
  web::fill(head, "{{facts}}", json_text(page.facts));
  web::fill(head, "{{title}}", web::html_escaped(page.title));  // last, because it may be any text
  return {std::move(head), std::move(tail)};
}

}  // namespace

std::size_t write_page(const fs::path& output, const SequencePage& page) {
  struct Frame {
    fs::path file;
    std::string block;
  };
  const PageEnds ends = ends_of(page);
  const std::string common = block(web::packed_text(page.common));
  std::size_t bytes = ends.head.size() + common.size() + ends.tail.size(), taken = 0, done = 0;
  Progress progress("packing");
  write_file(output, [&](std::ostream& file) {
    file << ends.head << common;
    work_in_order<Frame>(
        [&]() -> std::optional<Frame> {
          if (taken == page.files.size()) return std::nullopt;
          return Frame{.file = page.files[taken++], .block = {}};
        },
        [&](Frame& frame) { frame.block = block(web::packed_text(page.pack(frame.file))); },
        [&](Frame& frame) {
          bytes += frame.block.size();
          if (bytes > page.most_bytes) throw too_long(page, done);
          file << frame.block;
          progress.show(++done, page.files.size());
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

Json ValueRange::to_json() const {
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
