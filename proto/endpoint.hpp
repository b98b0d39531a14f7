// SPDX-License-Identifier: MIT
// Where the live stream is found: default endpoints, what an endpoint may be, and keys for those that leave the
// machine.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rptv {

struct Endpoint {
  enum class Transport { ipc, tcp };
  Transport transport = Transport::ipc;
  std::string text;     ///< as ZeroMQ wants it
  std::string address;  ///< ipc: path or @name; tcp: host:port
  /// ipc, and tcp on 127.0.0.0/8, ::1, localhost or lo: nobody outside this machine reaches it.
  bool local = true;
};

/// Throws Error(configuration) naming the text, what is wrong and the next step.
Endpoint parse_endpoint(std::string_view text);
/// Comma-separated endpoints without blanks or empty parts. Throws as parse_endpoint.
std::vector<std::string> split_endpoints(std::string_view text);

/// Where the daemon publishes when nothing else is said: ipc://<dir>/tracks.sock with <dir> = $RUNTIME_DIRECTORY (set
/// by systemd), else $XDG_RUNTIME_DIR/rapidptv, else /tmp/rapidptv-<uid>.
std::string default_endpoint();
/// Makes the directory of default_endpoint() with mode 0700 where it is missing. Throws Error(permission) when it
/// belongs to somebody else or cannot be made.
void make_default_directory();
/// Where a client looks: the first of the service's /run/rapidptv/tracks.sock and default_endpoint() that exists, else
/// the latter.
std::string endpoint_to_watch();

/// Throws Error before ZeroMQ would do harm at a socket's path: it unlinks whatever lies there. unavailable: somebody
/// listens there; configuration: not a socket, no such directory, path too long; permission: directory not writable.
void check_ipc_path(const Endpoint& endpoint);

/// First line of the file, 40 characters of Z85. Throws Error: no_input, permission (readable by others), bad_data.
std::string read_curve_key(const std::filesystem::path& file);

}  // namespace rptv
