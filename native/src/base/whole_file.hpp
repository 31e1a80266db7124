// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace dapple {

/// Write a file whole, or leave what was there: the content goes into another beside it, which then
/// takes its place. A link stays one; what is no regular file (a device, a pipe) is written into.
/// \throw FileError naming the file and why it could not be written
void write_whole(const std::filesystem::path& path, const std::string& content);

/// All bytes of a file.
/// \throw FileError naming the file
[[nodiscard]] std::string read_whole(const std::filesystem::path& path);

}  // namespace dapple
