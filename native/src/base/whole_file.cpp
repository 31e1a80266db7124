// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/whole_file.hpp"

#include <cerrno>
#include <cstring>
#include <dapple/errors.hpp>
#include <fstream>
#include <random>

namespace dapple {
namespace {

namespace fs = std::filesystem;

/// \throw FileError with what the system says about the last call
[[noreturn]] void refuse(const fs::path& path, const char* what) {
  const std::string reason = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  throw FileError(path.string() + " could not be " + what + reason);
}

/// Closed before it is judged: much is written only then.
bool put(const fs::path& path, const std::string& content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  return static_cast<bool>(file);
}

fs::path beside(const fs::path& path) {
  std::random_device random;
  fs::path name(".");  // piece by piece: GCC 12 warns of strings that it joins itself
  name += path.filename();
  name += std::to_string(random());
  name += std::to_string(random());
  name += ".part";
  return path.parent_path() / name;
}

}  // namespace

void write_whole(const fs::path& path, const std::string& content) {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(path, error);
  if (error) throw FileError(path.string() + " could not be written: " + error.message());
  if (fs::exists(target, error) && !fs::is_regular_file(target, error)) {
    if (!put(target, content)) refuse(path, "written");
    return;
  }
  const fs::path part = beside(target);
  if (!put(part, content)) {
    const int reason = errno;
    fs::remove(part, error);
    errno = reason;
    refuse(path, "written");
  }
  fs::rename(part, target, error);
  if (!error) return;
  const std::string reason = error.message();
  fs::remove(part, error);
  throw FileError(path.string() + " could not be written: " + reason);
}

std::string read_whole(const fs::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string content;
  if (file) content.assign(std::istreambuf_iterator<char>(file), {});
  if (!file || file.bad()) refuse(path, "read");
  return content;
}

}  // namespace dapple
