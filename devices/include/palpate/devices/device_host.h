// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace palpate::devices {

/// Serves a driver to the `RemoteDevice` at the other end of a socket, until that closes it. Drops
/// the force when a lease ends, and stops the device if the driver refuses that. A driver that
/// hangs inside a call keeps it from both; its device must drop the force itself. This is all that
/// the program `palpate-device-host` does.
/// \param socket of a pair of sockets of sequenced packets.
/// \returns the exit status: 0, or 1 if the driver could not be opened, which the other end is told.
int serve_device(int socket, const std::filesystem::path& library,
                 const std::map<std::string, std::string>& options, unsigned number);

}  // namespace palpate::devices
