// SPDX-License-Identifier: MIT
// Reading with a bound, and a reason when it fails.
#include "core/text_file.hpp"

#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/error.hpp"

namespace rptv {

namespace {
constexpr std::uintmax_t kLargestFileBytes = std::uintmax_t{64} << 20;
}

std::string read_text_file(const std::filesystem::path& file, const std::string& next_step) {
  const std::string next = "; " + next_step;
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw Error(ExitCode::no_input, file.string() + ": is a folder" + next);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    const int reason = errno;
    if (reason == EACCES) throw Error(ExitCode::permission, file.string() + ": may not be read; check its permissions");
    throw Error(ExitCode::no_input, file.string() + ": " + std::generic_category().message(reason) + next);
  }
  std::string text;
  while (stream && text.size() <= kLargestFileBytes) {
    const std::size_t had = text.size();
    text.resize(had + 64 * 1024);
    stream.read(text.data() + had, 64 * 1024);
    text.resize(had + static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) throw Error(ExitCode::io, file.string() + ": cannot be read" + next);
  if (text.size() > kLargestFileBytes)
    throw Error(ExitCode::configuration, file.string() + ": is larger than 64 MiB" + next);
  return text;
}

}  // namespace rptv
