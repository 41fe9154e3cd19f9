// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/error.h"

namespace palpate {
namespace {

std::string joined(const std::vector<MessagePart>& parts,
                   const std::function<std::string(const std::string&)>& name_of) {
  std::string message;
  for (const MessagePart& part : parts) message += part.is_field ? name_of(part.text) : part.text;
  return message;
}

}  // namespace

InvalidInput::InvalidInput(std::vector<MessagePart> parts)
    : Error(joined(parts, [](const std::string& name) { return name; })),
      parts_(std::make_shared<const std::vector<MessagePart>>(std::move(parts))) {}

std::string InvalidInput::with_names(
    const std::function<std::string(const std::string&)>& name_of) const {
  return parts_ ? joined(*parts_, name_of) : what();
}

}  // namespace palpate
