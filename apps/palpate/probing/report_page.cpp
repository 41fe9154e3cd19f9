// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/report_page.h"

#include "maker/html_text.h"

namespace palpate::apps {

namespace {

using web::html_escaped;

std::string element(const std::string& tag, const std::string& text) {
  std::string html = "<" + tag + ">";
  html += html_escaped(text);
  html += "</" + tag + ">";
  return html;
}

std::string table_row(const std::string& tag, const std::vector<std::string>& cells) {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += element(tag, cell);
  return html + "</tr>\n";
}

constexpr const char* kStyle =
    "body{font:16px/1.45 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;display:block;overflow-x:auto}"
    "th,td{padding:.2em .8em;border-bottom:1px solid #ddd;text-align:right}"
    "th:first-child,td:first-child{text-align:left}"
    "img{max-width:100%}figure{margin:1em 0}figcaption{color:#555}";

}  // namespace

ReportPage::ReportPage(const std::string& title) : title_(title) {
  body_ = element("h1", title) + "\n";
}

void ReportPage::add_heading(const std::string& text) { body_ += element("h2", text) + "\n"; }

void ReportPage::add_paragraph(const std::string& text) { body_ += element("p", text) + "\n"; }

void ReportPage::add_table(const std::vector<std::string>& head,
                           const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>\n";
  if (!head.empty()) body_ += table_row("th", head);
  for (const std::vector<std::string>& row : rows) body_ += table_row("td", row);
  body_ += "</table>\n";
}

void ReportPage::add_picture(const std::string& file, const std::string& caption) {
  const std::string source = html_escaped(file), words = html_escaped(caption);
  body_ += "<figure><img src=\"" + source + "\" alt=\"" + words + "\"><figcaption>" + words +
           "</figcaption></figure>\n";
}

std::string ReportPage::html() const {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">" +
         element("title", title_) + "<style>" + kStyle + "</style></head>\n<body>\n" + body_ +
         "</body>\n</html>\n";
}

}  // namespace palpate::apps
