// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// Loads the driver of a device for a `RemoteDevice`, which starts this program. Not for users.
#include <charconv>
#include <cstdio>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "palpate/devices/device_host.h"

int main(int count, char** words) {
  const std::span<char*> arguments(words, static_cast<std::size_t>(count));
  int socket = -1;
  unsigned number = 0;
  const auto parse = [](std::string_view text, auto& value) {
    return std::from_chars(text.begin(), text.end(), value).ptr == text.end() && !text.empty();
  };
  if (count < 4 || !parse(arguments[1], socket) || !parse(arguments[2], number)) {
    std::fputs(
        "palpate-device-host is started by programs that use a driver in a process of its "
        "own; it has no use alone.\n",
        stderr);
    return 2;
  }
  std::map<std::string, std::string> options;
  for (const char* argument : arguments.subspan(4)) {
    const std::string text = argument;
    const std::size_t equals = text.find('=');
    options[text.substr(0, equals)] = equals == std::string::npos ? "" : text.substr(equals + 1);
  }
  return palpate::devices::serve_device(socket, arguments[3], options, number);
}
