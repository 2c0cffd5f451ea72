// SPDX-License-Identifier: Apache-2.0
#include "sandbox.hpp"

#include "model/sandbox_mechanisms.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace mebots::master::isolation {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTemporaryFolder = "/tmp";
constexpr std::uint64_t kTemporaryBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kSharedMemoryBytes = std::uint64_t{64} << 20;

/// Folders of the system for programs and libraries. Some are symbolic links into /usr.
constexpr auto kSystemFolders =
    std::to_array<const char*>({"/usr", "/lib", "/lib32", "/lib64", "/libx32", "/bin", "/sbin", "/opt", "/nix"});
/// Files that the loader and the C library read.
constexpr auto kSystemFiles = std::to_array<const char*>(
    {"/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives", "/etc/localtime"});
constexpr auto kDevices =
    std::to_array<const char*>({"/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom"});
/// Environment variables with lists of folders that the FMU may read.
constexpr auto kSearchPaths = std::to_array<const char*>({"LD_LIBRARY_PATH", "PYTHONPATH", "PYTHONHOME"});
/// Environment variables for a sandboxed FMU. Other variables may contain secrets.
constexpr auto kPassedVariables = std::to_array<const char*>(
    {"LANG", "LANGUAGE", "LC_ALL", "LC_CTYPE", "LC_NUMERIC", "LC_COLLATE", "LC_MESSAGES", "TZ", "LD_LIBRARY_PATH",
     "PYTHONPATH", "PYTHONHOME", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"});

std::string system_text() {
  return std::strerror(errno);
}

/// Returns $MEBOTS_BUBBLEWRAP or, if it is not set, the name of the program.
std::string bubblewrap() {
  const char* chosen = std::getenv("MEBOTS_BUBBLEWRAP");
  return chosen == nullptr ? "bwrap" : chosen;
}

void pass_only_listed_variables() {
  std::map<std::string, std::string> kept;
  for (const auto* name : kPassedVariables) {
    if (const char* value = std::getenv(name); value != nullptr) kept.emplace(name, value);
  }
  clearenv();
  for (const auto& [name, value] : kept) setenv(name.c_str(), value.c_str(), 1);
  setenv("PATH", "/usr/local/bin:/usr/bin:/bin", 1);
}

void set_home(const std::string& folder) {
  setenv("HOME", folder.c_str(), 1);
  setenv("TMPDIR", folder.c_str(), 1);
}

/// Returns the absolute paths in the variables of kSearchPaths.
std::vector<std::string> searched_folders() {
  std::vector<std::string> folders;
  for (const auto* variable : kSearchPaths) {
    const char* value = std::getenv(variable);
    std::string_view rest = value == nullptr ? "" : value;
    while (!rest.empty()) {
      const auto folder = rest.substr(0, rest.find(':'));
      rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
      if (folder.starts_with('/')) folders.emplace_back(folder);
    }
  }
  return folders;
}

std::vector<std::string> readable_places(const Sandbox& sandbox) {
  auto places = searched_folders();
  places.insert(places.end(), sandbox.reads.begin(), sandbox.reads.end());
  places.push_back(sandbox.folder.string());
  return places;
}

std::vector<std::string> namespace_options(const Sandbox& sandbox, const std::string& program) {
  std::vector<std::string> words{"--unshare-user",
                                 "--disable-userns",
                                 "--unshare-ipc",
                                 "--unshare-pid",
                                 "--unshare-net",
                                 "--unshare-uts",
                                 "--unshare-cgroup-try",
                                 "--new-session",
                                 "--die-with-parent",
                                 "--cap-drop",
                                 "ALL",
                                 "--hostname",
                                 "sandbox"};
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  for (const auto* folder : kSystemFolders) {
    std::error_code ignored;
    if (fs::is_symlink(folder, ignored)) {
      add({"--symlink", fs::read_symlink(folder, ignored).string(), folder});
    } else {
      add({"--ro-bind-try", folder, folder});
    }
  }
  for (const auto* file : kSystemFiles) add({"--ro-bind-try", file, file});
  for (const auto* device : kDevices) add({"--dev-bind", device, device});
  add({"--proc", "/proc"});
  add({"--size", fmt::format("{}", kSharedMemoryBytes), "--perms", "1777", "--tmpfs", "/dev/shm"});
  add({"--size", fmt::format("{}", kTemporaryBytes), "--perms", "1777", "--tmpfs", kTemporaryFolder});
  for (const auto& place : readable_places(sandbox)) add({"--ro-bind-try", place, place});
  add({"--ro-bind", program, program, "--remount-ro", "/", "--chdir", kTemporaryFolder, "--"});
  return words;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Runs a program. Returns nullopt if its exit code is 0. Otherwise, returns the last line of its output or another
/// description of the error.
std::optional<std::string> failure_of(std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return system_text();
  const auto arguments = pointers_to(words);
  const auto child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execvp(arguments[0], arguments.data());
    _exit(errno == ENOENT ? 127 : 126);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 512> part{};
  for (ssize_t count = 0; child > 0 && (count = read(ends[0], part.data(), part.size())) > 0;) {
    text.append(part.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  int status = -1;
  if (child < 0 || waitpid(child, &status, 0) != child) return system_text();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return std::nullopt;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    return fmt::format("the program {} was not found; install the package bubblewrap", words.front());
  while (text.ends_with('\n')) text.pop_back();
  return text.empty() ? "it ended without a message" : text.substr(text.rfind('\n') + 1);
}

/// Limits the number of open files and the size of files. Inside namespaces, also limits the number of processes, which
/// the kernel counts per user and user namespace.
void set_limits(bool has_namespaces) {
  constexpr rlim_t kOpenFiles = 1024;
  constexpr rlim_t kFileBytes = rlim_t{1} << 30;
  constexpr rlim_t kProcesses = 256;
  const auto limit = [](auto resource, rlim_t value) {
    rlimit now{};
    getrlimit(resource, &now);
    value = std::min(value, now.rlim_max);
    const rlimit lower{value, value};
    setrlimit(resource, &lower);
  };
  limit(RLIMIT_NOFILE, kOpenFiles);
  limit(RLIMIT_FSIZE, kFileBytes);
  if (has_namespaces) limit(RLIMIT_NPROC, kProcesses);
}

}  // namespace

Refusal enter_namespaces(const Sandbox& sandbox, const std::string& program,
                         const std::vector<std::string>& arguments) {
  std::vector<std::string> words{bubblewrap()};
  pass_only_listed_variables();
  set_home(kTemporaryFolder);
  const auto options = namespace_options(sandbox, program);
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(program);
  // Starts the program once with --version, because the exit code of bubblewrap does not show that a namespace was
  // refused.
  auto trial = words;
  trial.emplace_back("--version");
  if (auto problem = failure_of(std::move(trial))) return {kNamespaces, *std::move(problem)};
  words.insert(words.end(), arguments.begin(), arguments.end());
  execvp(words.front().c_str(), pointers_to(words).data());
  return {kNamespaces, system_text()};
}

std::vector<Refusal> restrict_process(const Sandbox& sandbox, bool has_namespaces) {
  std::vector<Refusal> refusals;
  auto writes = std::vector<std::string>{kTemporaryFolder, "/dev/shm"};
  if (!has_namespaces) {
    writes = {(sandbox.folder / "sandbox-temporary").string()};
    mkdir(writes.front().c_str(), S_IRWXU);
    set_home(writes.front());
    if (chdir(writes.front().c_str()) != 0) refusals.push_back({kNamespaces, system_text()});
  }
  set_limits(has_namespaces);
  FileAccess access{readable_places(sandbox), std::move(writes), {}};
  access.reads.insert(access.reads.end(), kSystemFolders.begin(), kSystemFolders.end());
  access.reads.insert(access.reads.end(), kSystemFiles.begin(), kSystemFiles.end());
  access.writes_in_place.assign(kDevices.begin(), kDevices.end());
  for (const auto* file : {"/proc/cpuinfo", "/proc/meminfo", "/proc/stat", "/proc/self"})
    access.reads.emplace_back(file);
  if (has_namespaces) access.reads.emplace_back("/proc");
  if (auto problem = restrict_files(access)) refusals.push_back({kLandlock, *std::move(problem)});
  return refusals;
}

}  // namespace mebots::master::isolation
