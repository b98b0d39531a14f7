// SPDX-License-Identifier: MIT
// Data files that come with rapidptv, found by name: lens prescriptions and scenarios.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rptv {

/// The file that `name` means: a path when it has a slash or ends in .toml, else `name`.toml of the kind's folder
/// ("prescriptions", "scenarios"), looked for in share/rapidptv/ of the folders above the program, or in the folder
/// that the environment's RAPIDPTV_SHARE names. Throws Error(no_input) that lists the names there are.
std::filesystem::path find_shipped(std::string_view kind, const std::string& name);

/// Names of one kind, sorted; empty where nothing is installed.
std::vector<std::string> shipped_names(std::string_view kind);

}  // namespace rptv
