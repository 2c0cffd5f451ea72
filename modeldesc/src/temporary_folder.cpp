// SPDX-License-Identifier: Apache-2.0
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive.hpp"

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

namespace mebots::modeldesc {

TemporaryFolder::TemporaryFolder() : owner_(getpid()) {}

TemporaryFolder::TemporaryFolder(std::string_view prefix, const std::filesystem::path& parent) : TemporaryFolder() {
  std::error_code error;
  const std::filesystem::path base = parent.empty() ? std::filesystem::temp_directory_path(error) : parent;
  if (error)
    throw Error(ErrorCode::system_failure,
                fmt::format("there is no folder for temporary files: {}; set TMPDIR", error.message()));
  std::string name = (base / fmt::format("{}-XXXXXX", prefix)).string();
  if (mkdtemp(name.data()) == nullptr)
    throw Error(ErrorCode::system_failure,
                fmt::format("{}: no temporary folder can be made there: {}; set TMPDIR to another place", base.string(),
                            std::generic_category().message(errno)));
  path_ = name;
}

std::optional<TemporaryFolder> TemporaryFolder::at(std::filesystem::path path) {
  constexpr mode_t kOwnerOnly = 0700;
  if (mkdir(path.c_str(), kOwnerOnly) != 0) return std::nullopt;
  TemporaryFolder folder;
  folder.path_ = std::move(path);
  return folder;
}

TemporaryFolder::~TemporaryFolder() {
  remove();
}

TemporaryFolder::TemporaryFolder(TemporaryFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), owner_(other.owner_) {}

TemporaryFolder& TemporaryFolder::operator=(TemporaryFolder&& other) noexcept {
  if (this != &other) {
    remove();
    path_ = std::exchange(other.path_, {});
    owner_ = other.owner_;
  }
  return *this;
}

void TemporaryFolder::remove() noexcept {
  if (path_.empty() || getpid() != owner_) return;
  std::error_code ignored;  // a file that remains in the temporary folder is harmless
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace mebots::modeldesc
