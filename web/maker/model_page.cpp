// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "maker/model_page.h"

#include <string>

#include "maker/html_text.h"
#include "maker/page_text.h"
#include "palpate/core/require.h"
#include "palpate/haptics/model_bytes.h"
#include "palpate/haptics/playable.h"

namespace palpate::web {

std::string model_page(haptics::Model model, const PageOptions& options,
                       const std::filesystem::path& page_template) {
  haptics::check_playable(model);
  require("PageOptions::unknown_friction", options.unknown_friction, at_least(0).finite());
  for (haptics::ContactModel& contact : model.contacts) {
    if (has_unknown_friction(contact)) contact.friction = options.unknown_friction;
  }
  std::string page = web::page_template(page_template);
  fill(page, "{{model}}", packed_text(haptics::to_bytes(model)));
  fill(page, "{{title}}", html_escaped(options.title));  // last, because it may be any text
  return page;
}

}  // namespace palpate::web
