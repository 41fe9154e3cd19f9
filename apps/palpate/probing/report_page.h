// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate::apps {

/// A report as one HTML file that needs no network; its pictures lie beside it. All texts are plain
/// text, which is escaped.
class ReportPage {
 public:
  explicit ReportPage(const std::string& title);

  void add_heading(const std::string& text);
  void add_paragraph(const std::string& text);
  /// `head` may be empty; otherwise each row has as many cells. Cells after the first are aligned
  /// to the right.
  void add_table(const std::vector<std::string>& head,
                 const std::vector<std::vector<std::string>>& rows);
  void add_picture(const std::string& file, const std::string& caption);

  /// The whole page.
  [[nodiscard]] std::string html() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace palpate::apps
