// SPDX-License-Identifier: Apache-2.0
#include "sandbox.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>

namespace mebots::master::isolation {
namespace {

// The interface of the kernel (Documentation/userspace-api/landlock.rst). The headers of Debian 12 contain only its
// first versions.
constexpr long kCreateRuleset = 444;
constexpr long kAddRule = 445;
constexpr long kRestrictSelf = 446;
constexpr std::uint32_t kAskVersion = 1;
constexpr int kPathBeneath = 1;

struct Ruleset {
  std::uint64_t files;    // since version 1
  std::uint64_t network;  // since version 4
  std::uint64_t scoped;   // since version 6
};
struct [[gnu::packed]] PathBeneath {
  std::uint64_t allowed;
  std::int32_t parent;
};

// Bits of Ruleset::scoped.
constexpr std::uint64_t kAbstractSockets = 1U << 0;
constexpr std::uint64_t kSignals = 1U << 1;
constexpr long kScopesSince = 6;  // first version with scopes

constexpr std::uint64_t kExecute = 1U << 0;
constexpr std::uint64_t kWrite = 1U << 1;
constexpr std::uint64_t kReadFile = 1U << 2;
constexpr std::uint64_t kReadFolder = 1U << 3;
constexpr std::uint64_t kMakeBlockDevice = 1U << 11;
constexpr std::uint64_t kRefer = 1U << 13;  // moving files between folders; since version 2
constexpr std::uint64_t kTruncate = 1U << 14;
constexpr std::uint64_t kReading = kExecute | kReadFile | kReadFolder;
constexpr std::uint64_t kOfOneFile = kExecute | kReadFile | kWrite | kTruncate;

std::uint64_t all_access(long version) {
  if (version >= 5) return (1U << 16) - 1;
  if (version >= 3) return (1U << 15) - 1;
  return version == 2 ? (1U << 14) - 1 : (1U << 13) - 1;
}

std::size_t known_size(long version) {
  if (version >= kScopesSince) return sizeof(Ruleset);
  return version >= 4 ? 2 * sizeof(std::uint64_t) : sizeof(std::uint64_t);
}

void allow(int rules, const std::string& path, std::uint64_t access) {
  const int place = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (place < 0) return;
  struct stat status {};
  if (fstat(place, &status) == 0 && !S_ISDIR(status.st_mode)) access &= kOfOneFile;
  const PathBeneath rule{access, place};
  syscall(kAddRule, rules, kPathBeneath, &rule, 0);
  close(place);
}

long offered_version() {
  return syscall(kCreateRuleset, nullptr, 0, kAskVersion);
}

int create(const Ruleset& wanted, long version) {
  return static_cast<int>(syscall(kCreateRuleset, &wanted, known_size(version), 0));
}

/// Applies the rules to this process and closes their descriptor. Returns the error; an empty text on success.
std::string enter(int rules) {
  std::string problem;
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || syscall(kRestrictSelf, rules, 0) != 0)
    problem = std::strerror(errno);
  close(rules);
  return problem;
}

}  // namespace

bool shield_other_processes() {
  const long version = offered_version();
  if (version < 2) return false;  // version 1 forbids moving files between folders
  const bool scopes = version >= kScopesSince;
  // A ruleset must not be empty. If the kernel cannot restrict signals, the ruleset restricts a kind of file access and
  // then permits it everywhere.
  const Ruleset wanted{scopes ? 0 : kRefer | kMakeBlockDevice, 0, scopes ? kSignals : 0};
  const int rules = create(wanted, version);
  if (rules < 0) return false;
  if (!scopes) allow(rules, "/", wanted.files);
  return enter(rules).empty() && scopes;
}

std::optional<std::string> restrict_files(const FileAccess& access) {
  const long version = offered_version();
  if (version < 1) return std::strerror(errno);
  constexpr std::uint64_t kTcp = 3;  // bind and connect
  const Ruleset wanted{all_access(version), kTcp, kAbstractSockets | kSignals};
  const int rules = create(wanted, version);
  if (rules < 0) return std::strerror(errno);
  for (const auto& path : access.reads) allow(rules, path, kReading);
  for (const auto& path : access.writes_in_place) allow(rules, path, (kReading | kWrite | kTruncate) & wanted.files);
  for (const auto& path : access.writes) allow(rules, path, wanted.files);
  auto problem = enter(rules);
  return problem.empty() ? std::nullopt : std::optional(std::move(problem));
}

}  // namespace mebots::master::isolation
