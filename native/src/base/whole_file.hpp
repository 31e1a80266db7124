// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace dapple {

/// Write a file completely or keep the old one: the content goes into a temporary file, which then
/// replaces it. A link stays a link; devices and pipes are written to directly.
/// \throw FileError naming the file and why it could not be written
void write_whole(const std::filesystem::path& path, const std::string& content);

/// All bytes of a file.
/// \throw FileError naming the file
[[nodiscard]] std::string read_whole(const std::filesystem::path& path);

}  // namespace dapple
