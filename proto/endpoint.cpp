// SPDX-License-Identifier: MIT
// Checks of endpoints that libzmq leaves out, default places, key files.
#include "proto/endpoint.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace rptv {
namespace {

constexpr std::string_view kServiceEndpoint = "ipc:///run/rapidptv/tracks.sock";
constexpr std::size_t kCurveKeyCharacters = 40;

bool is_loopback(std::string_view host) {
  return host == "localhost" || host == "lo" || host == "[::1]" || host.starts_with("127.");
}

bool is_port(std::string_view text) {
  if (text == "*") return true;
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
         std::stoul(std::string(text)) <= 65535;
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

std::filesystem::path default_directory() {
  const std::string service = environment("RUNTIME_DIRECTORY");
  if (!service.empty()) return service.substr(0, service.find(':'));  // systemd: several are joined by colons
  const std::string user = environment("XDG_RUNTIME_DIR");
  if (!user.empty()) return std::filesystem::path(user) / "rapidptv";
  return "/tmp/rapidptv-" + std::to_string(geteuid());
}

/// What a connect() to the socket says: 0 somebody listens, else errno.
int probe(const sockaddr_un& address) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int result = connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
  close(fd);
  return result == EAGAIN ? 0 : result;  // EAGAIN: its backlog is full, so it listens
}

void check_directory(const std::filesystem::path& path, const std::string& text) {
  const auto directory = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (faccessat(AT_FDCWD, directory.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return;
  if (errno == EACCES || errno == EROFS)
    throw Error(ExitCode::permission, text + ": no permission to make a socket in " + in_quotes(directory.string()) +
                                          "; run as a user who may write there, or choose another publisher.endpoint");
  throw Error(ExitCode::configuration, text + ": directory " + in_quotes(directory.string()) +
                                           " does not exist; make it, or choose another publisher.endpoint");
}

}  // namespace

Endpoint parse_endpoint(std::string_view text) {
  Endpoint endpoint{.transport = Endpoint::Transport::ipc, .text = std::string(text), .address = {}, .local = true};
  const auto fail = [&](const std::string& what) {
    return Error(ExitCode::configuration, "endpoint " + in_quotes(text) + " " + what);
  };
  if (text.starts_with("ipc://")) {
    endpoint.address = text.substr(6);
    if (endpoint.address.empty() || endpoint.address == "@" || endpoint.address == "*")
      throw fail("has no path; write for instance ipc:///run/rapidptv/tracks.sock");
    if (endpoint.address.size() >= sizeof(sockaddr_un::sun_path))
      throw fail("is longer than the " + std::to_string(sizeof(sockaddr_un::sun_path) - 1) +
                 " bytes of a socket's path; choose a shorter one");
    return endpoint;
  }
  if (!text.starts_with("tcp://")) throw fail("is neither ipc:///path nor tcp://host:port; use one of these");
  endpoint.transport = Endpoint::Transport::tcp;
  endpoint.address = text.substr(6);
  const std::size_t colon = endpoint.address.rfind(':');
  if (colon == std::string::npos || colon == 0 || !is_port(std::string_view(endpoint.address).substr(colon + 1)))
    throw fail("has no host or no port of 0 to 65535; write for instance tcp://127.0.0.1:5555");
  endpoint.local = is_loopback(endpoint.address.substr(0, colon));
  return endpoint;
}

std::vector<std::string> split_endpoints(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    std::string_view part = text.substr(0, comma);
    while (part.starts_with(' ')) part.remove_prefix(1);
    while (part.ends_with(' ')) part.remove_suffix(1);
    if (!part.empty()) parts.push_back(parse_endpoint(part).text);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  if (parts.empty())
    throw Error(ExitCode::configuration,
                "publisher.endpoint names no endpoint; write for instance tcp://127.0.0.1:5555");
  return parts;
}

std::string default_endpoint() { return "ipc://" + (default_directory() / "tracks.sock").string(); }

void make_default_directory() {
  const std::string directory = default_directory().string();
  // 0700: nobody else can put a socket of theirs where our clients look.
  if (mkdir(directory.c_str(), 0700) != 0 && errno != EEXIST)
    throw Error(ExitCode::permission, "cannot make directory " + in_quotes(directory) +
                                          " for the live stream's socket (" + std::strerror(errno) +
                                          "); set publisher.endpoint");
  struct stat status {};
  if (lstat(directory.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) ||
      (status.st_uid != geteuid() && status.st_uid != 0))
    throw Error(ExitCode::permission, "directory " + in_quotes(directory) +
                                          " belongs to somebody else; remove it, or set publisher.endpoint");
}

std::string endpoint_to_watch() {
  struct stat status {};
  const std::string service(kServiceEndpoint);
  const std::string own = default_endpoint();
  if (stat(own.c_str() + 6, &status) != 0 && stat(service.c_str() + 6, &status) == 0) return service;
  return own;
}

void check_ipc_path(const Endpoint& endpoint) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (endpoint.address.size() >= sizeof address.sun_path || endpoint.address.starts_with('@')) return;
  endpoint.address.copy(address.sun_path, sizeof address.sun_path - 1);
  check_directory(endpoint.address, endpoint.text);
  struct stat status {};
  if (lstat(address.sun_path, &status) != 0) return;
  if (!S_ISSOCK(status.st_mode))
    throw Error(ExitCode::configuration,
                endpoint.text + ": " + in_quotes(endpoint.address) +
                    " exists and is no socket; remove it, or choose another publisher.endpoint");
  const int found = probe(address);
  if (found == 0)
    throw Error(ExitCode::unavailable, endpoint.text +
                                           ": address already in use; stop the other rapidptv (or whoever publishes "
                                           "there), or choose another publisher.endpoint");
  if (found == EACCES)
    throw Error(ExitCode::permission, endpoint.text +
                                          ": the socket there belongs to another user; choose another "
                                          "publisher.endpoint");
}

std::string read_curve_key(const std::filesystem::path& file) {
  struct stat status {};
  std::ifstream input(file);
  if (stat(file.c_str(), &status) != 0 || !input)
    throw Error(ExitCode::no_input, "CURVE key file " + in_quotes(file.string()) + " cannot be read (" +
                                        std::strerror(errno) + "); docs/wire.md shows how to make one");
  if ((status.st_mode & 077) != 0)
    throw Error(ExitCode::permission, "CURVE key file " + in_quotes(file.string()) +
                                          " is open to other users; run: chmod 600 " + file.string());
  std::string key;
  std::getline(input, key);
  while (!key.empty() && (key.back() == '\r' || key.back() == ' ')) key.pop_back();
  if (key.size() != kCurveKeyCharacters)
    throw Error(ExitCode::bad_data, file.string() + ":1: a CURVE key has 40 characters (Z85), this line has " +
                                        std::to_string(key.size()) + "; docs/wire.md shows how to make one");
  return key;
}

}  // namespace rptv
