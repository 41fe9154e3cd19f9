// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/model_page.h"

#include "commands/page_file.h"
#include "commands/report_page.h"
#include "palpate/haptics/model_bytes.h"

namespace palpate::apps {

std::string model_page(const haptics::Model& model, const std::string& title) {
  std::string page = page_template("model");
  fill(page, "{{model}}", packed_text(haptics::to_bytes(model)));
  fill(page, "{{title}}", html_escaped(title));  // last, because it may be any text
  return page;
}

}  // namespace palpate::apps
