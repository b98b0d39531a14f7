// SPDX-License-Identifier: MIT
// Where data files lie: beside an installed program, in a build tree, or where the environment says.
#include "simulation/shipped_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace rptv {

namespace fs = std::filesystem;

namespace {

constexpr int kFoldersAbove = 4;

/// The folder of a kind; empty when there is none.
fs::path folder_of(std::string_view kind) {
  std::error_code error;
  if (const char* share = std::getenv("RAPIDPTV_SHARE"); share != nullptr && *share != '\0')
    return fs::path(share) / kind;
  fs::path above = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (int i = 0; i < kFoldersAbove && above.has_relative_path(); ++i, above = above.parent_path())
    if (fs::path folder = above / "share" / "rapidptv" / kind; fs::is_directory(folder, error)) return folder;
  return {};
}

}  // namespace

std::vector<std::string> shipped_names(std::string_view kind) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_of(kind), error))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

fs::path find_shipped(std::string_view kind, const std::string& name) {
  if (name.find('/') != std::string::npos || name.ends_with(".toml")) return name;
  const auto names = shipped_names(kind);
  if (std::find(names.begin(), names.end(), name) != names.end()) return folder_of(kind) / (name + ".toml");
  throw Error(
      ExitCode::no_input,
      names.empty()
          ? fmt::format("no {} are installed where {} is looked for; give the path of a file, or set "
                        "RAPIDPTV_SHARE to the folder that has {}/",
                        kind, in_quotes(name), kind)
          : fmt::format("{} is not among the {} that are installed ({}); give one of these or the path of a file",
                        in_quotes(name), kind, fmt::join(names, ", ")));
}

}  // namespace rptv
