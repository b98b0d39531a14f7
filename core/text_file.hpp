// SPDX-License-Identifier: MIT
// A whole text file into memory, with the messages that every reader of settings and calibrations gives.
#pragma once

#include <filesystem>
#include <string>

namespace rptv {

/// The bytes of a file of at most 64 MiB. Throws Error (no_input, permission, io, configuration) that names the file,
/// the reason and, after "; ", the `next` step. Set-up only.
std::string read_text_file(const std::filesystem::path& file, const std::string& next);

}  // namespace rptv
