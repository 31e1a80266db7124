// SPDX-License-Identifier: GPL-3.0-or-later
// Makes every allocation of every verb fail once: the first run counts them, then each one fails
// (as in Embree's verify). The result is std::bad_alloc, an error of the library, or the right
// value; nothing leaks, and the next call returns the usual bytes. By default the first allocation
// of each call stack fails; with DAPPLE_THOROUGH in the environment, all of them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <dapple/errors.hpp>
#include <dapple/mesh_file.hpp>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>

#include "allocator.hpp"
#include "hash.hpp"
#include "shapes.hpp"
#include "verb_cases.hpp"

extern "C" {  // declarations of Embree's functions, because its headers differ between versions
void rtcNewDevice();
void rtcNewScene();
void rtcNewGeometry();
void rtcSetNewGeometryBuffer();
void rtcAttachGeometry();
void rtcCommitGeometry();
void rtcCommitScene();
}

namespace dapple::test {
namespace {

std::uint64_t outcome(const Work& work) {
  Hash hash;
  work(hash);
  return hash.value();
}

template <typename Function>
const void* address(Function* function) {
  return reinterpret_cast<const void*>(function);
}

/// Whether the call behaved correctly although an allocation failed.
class Trial {
 public:
  /// \param lost allocations that other libraries may leak per call
  explicit Trial(Prepare prepare, long lost = 0)
      : prepare_(std::move(prepare)), lost_(lost), expected_(outcome(prepare_())) {}

  [[nodiscard]] long count() const {
    const Work work = prepare_();
    const long before = allocations();
    (void)outcome(work);
    return allocations() - before;
  }

  /// The first allocation of each call stack.
  [[nodiscard]] std::vector<long> first_of_each() const {
    const Work work = prepare_();
    const CallSites sites(count());
    (void)outcome(work);
    return sites.first_of_each();
  }

  /// `many` allocations fail, starting with allocation `number`. Caches that are created once for
  /// all later calls are not counted as leaks.
  void fail(long number, long many) const {
    SCOPED_TRACE("allocation " + std::to_string(number) + ", " + std::to_string(many) + " of them");
    for (int round = 0;; ++round) {
      const long before = live_allocations();
      break_once(number, many);
      const long left = live_allocations() - before;
      if (left <= may_be_lost()) return;
      ASSERT_LT(round, 3) << "it leaked " << left << " allocations";
    }
  }

 private:
  /// Leaks of other libraries: Embree's function loses the device and its contents if it runs out
  /// of memory.
  [[nodiscard]] long may_be_lost() const {
    constexpr long kDevice = 4;
    return lost_ + (was_missing_in(address(&rtcNewDevice)) ? kDevice : 0);
  }

  void break_once(long number, long many) const {
    const Work work = prepare_();
    if (const auto result = attempt(work, number, many))
      EXPECT_EQ(*result, expected_) << "it went on with what was not there";
    else
      EXPECT_EQ(outcome(work), expected_) << "it left something behind";
  }

  /// \return the hash of the result; none if the call threw an error
  static std::optional<std::uint64_t> attempt(const Work& work, long number, long many) {
    Hash hash;
    const OutOfMemory missing(number, many);
    try {
      work(hash);
      return hash.value();
    } catch (const std::bad_alloc&) {
    } catch (const FileError&) {
    }
    return std::nullopt;
  }

  Prepare prepare_;
  long lost_;
  std::uint64_t expected_;
};

bool thorough() { return std::getenv("DAPPLE_THOROUGH") != nullptr; }

std::vector<long> up_to(long count, long step) {
  std::vector<long> numbers;
  for (long number = 1; number <= count; number += step) numbers.push_back(number);
  return numbers;
}

/// Embree has a defect when an allocation fails while it builds a tree: a thread that cannot join
/// the memory of a scene keeps using that of the scene when both are gone (3.13, bind() in
/// kernels/common/alloc.h). So allocations fail in all of its other functions only.
class OutOfMemoryIn : public testing::TestWithParam<Case> {
 protected:
  OutOfMemoryIn() { spare_library_of(address(&rtcCommitScene), others_); }
  ~OutOfMemoryIn() override { spare_library_of(nullptr, {}); }

 private:
  std::array<const void*, 6> others_ = {
      address(&rtcNewDevice),      address(&rtcNewScene),
      address(&rtcNewGeometry),    address(&rtcSetNewGeometryBuffer),
      address(&rtcAttachGeometry), address(&rtcCommitGeometry)};
};

TEST_P(OutOfMemoryIn, OneThread) {
  const Trial trial(GetParam().prepare(1), GetParam().lost);
  const std::vector<long> numbers = thorough() ? up_to(trial.count(), 1) : trial.first_of_each();
  std::cout << numbers.size() << " of " << trial.count() << " allocations fail\n";
  ASSERT_GT(numbers.size(), 0u);
  for (const long number : numbers) {
    trial.fail(number, 1);
    if (HasFailure()) return;
  }
}

/// Allocations also fail while errors are created and passed on.
TEST_P(OutOfMemoryIn, AllLaterAllocationsFail) {
  constexpr long kSample = 40;
  const Trial trial(GetParam().prepare(1), GetParam().lost);
  for (const long number :
       up_to(trial.count(), 1 + trial.count() / (thorough() ? 2000 : kSample))) {
    trial.fail(number, std::numeric_limits<long>::max());
    if (HasFailure()) return;
  }
}

TEST_P(OutOfMemoryIn, TwoThreads) {
  constexpr long kSample = 40;
  const Trial trial(GetParam().prepare(2), GetParam().lost);
  for (const long number :
       up_to(trial.count(), 1 + trial.count() / (thorough() ? 2000 : kSample))) {
    trial.fail(number, 1);
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Verbs, OutOfMemoryIn,
                         testing::ValuesIn(verb_cases().begin(), verb_cases().end()),
                         [](const auto& one) { return std::string(one.param.name); });

// ---- files ----

namespace fs = std::filesystem;

/// A folder with a mesh file, removed at the end.
class MeshFolder {
 public:
  explicit MeshFolder(const std::string& suffix)
      : folder_(fs::path(testing::TempDir()) / ("dapple out of memory" + std::to_string(getpid()))),
        path_(folder_ / ("mesh" + suffix)) {
    fs::create_directories(folder_);
    write_mesh(path_, before_.vertices, before_.faces);
  }
  ~MeshFolder() { fs::remove_all(folder_); }
  MeshFolder(const MeshFolder&) = delete;
  MeshFolder& operator=(const MeshFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] const Shape& before() const { return before_; }
  [[nodiscard]] auto files() const { return std::distance(fs::directory_iterator(folder_), {}); }

 private:
  fs::path folder_;
  fs::path path_;
  Shape before_ = tetrahedron();
};

class OutOfMemoryWithFiles : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Formats, OutOfMemoryWithFiles,
                         testing::Values(".ply", ".off", ".obj", ".stl"),
                         [](const auto& one) { return std::string(one.param).substr(1); });

long allocations_of(const std::function<void()>& work) {
  const long before = allocations();
  work();
  return allocations() - before;
}

TEST_P(OutOfMemoryWithFiles, Reading) {
  const MeshFolder folder(GetParam());
  const Trial trial(again([&](Hash& hash) {
    const MeshArrays mesh = read_mesh(folder.path());
    hash.add(mesh.vertices);
    hash.add(mesh.faces);
  }));
  for (const long number : up_to(trial.count(), 1)) trial.fail(number, 1);
}

/// The file has either the old or the new content, and no other file is left beside it.
TEST_P(OutOfMemoryWithFiles, Writing) {
  const Shape after = blob(1);
  const MeshFolder folder(GetParam());
  const auto write = [&] { write_mesh(folder.path(), after.vertices, after.faces); };
  write();
  for (const long number : up_to(allocations_of(write), 1)) {
    write_mesh(folder.path(), folder.before().vertices, folder.before().faces);
    bool written = true;
    try {
      const OutOfMemory missing(number);
      write();
    } catch (const std::exception&) {
      written = false;
    }
    const std::size_t faces = read_mesh(folder.path()).faces.size();
    ASSERT_EQ(faces, written ? after.faces.size() : folder.before().faces.size()) << number;
    ASSERT_EQ(folder.files(), 1) << "allocation " << number << " left a part behind";
  }
}

}  // namespace
}  // namespace dapple::test
