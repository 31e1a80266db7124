// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/whole_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <dapple/errors.hpp>
#include <fstream>
#include <random>
#include <vector>

#include "base/progress.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = 1 << 20;  // bytes between two checks

/// \throw FileError with the system's message about the last call
[[noreturn]] void refuse(const fs::path& path, const char* what) {
  const std::string reason = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  throw FileError(path.string() + " could not be " + what + reason);
}

/// Closes the file before checking for errors, because much of it is written only then.
bool put(const fs::path& path, const std::string& content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  for (std::size_t at = 0; at < content.size() && file; at += kBlock) {
    check_context(nullptr);
    file.write(content.data() + at,
               static_cast<std::streamsize>(std::min(kBlock, content.size() - at)));
  }
  file.close();
  return static_cast<bool>(file);
}

fs::path beside(const fs::path& path) {
  std::random_device random;
  fs::path name(".");  // independent of the file's name, which may have the maximal length
  name += std::to_string(random());
  name += std::to_string(random());
  name += ".part";
  return path.parent_path() / name;
}

/// A file beside the one that it will replace. It is removed unless it replaces that file.
class Part {
 public:
  explicit Part(const fs::path& target) : path_(beside(target)) {}
  ~Part() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

void write_whole(const fs::path& path, const std::string& content) {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(path, error);
  if (error) throw FileError(path.string() + " could not be written: " + error.message());
  if (fs::exists(target, error) && !fs::is_regular_file(target, error)) {
    if (!put(target, content)) refuse(path, "written");
    return;
  }
  const Part part(target);
  if (!put(part.path(), content)) refuse(path, "written");
  fs::rename(part.path(), target, error);
  if (error) throw FileError(path.string() + " could not be written: " + error.message());
}

std::string read_whole(const fs::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string content;
  std::vector<char> block(kBlock);
  while (file) {
    check_context(nullptr);
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    content.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof() || file.bad()) refuse(path, "read");
  return content;
}

}  // namespace dapple
