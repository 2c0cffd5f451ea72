// SPDX-License-Identifier: Apache-2.0
#include "slave/isolation/child_process.hpp"

#include "fmi/fmu.hpp"
#include "fmi/library_state.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace mebots::master {
namespace {

namespace fs = std::filesystem;

struct Python {
  std::string library;
  std::string packages;
};

/// Python code that prints the path of the interpreter's library, and in a second line the package folder of the
/// virtual environment. The second line is empty if there is no virtual environment.
constexpr const char* kQuestion =
    "import os, sys, sysconfig\n"
    "print(os.path.join(sysconfig.get_config_var('LIBDIR') or '', sysconfig.get_config_var('INSTSONAME') or ''))\n"
    "print(sysconfig.get_path('purelib') if sys.prefix != sys.base_prefix else '')\n";

/// Runs a program and returns its output; an empty text if it fails.
std::string output_of(std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const bool started = posix_spawnp(&child, words[0].c_str(), &actions, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string text;
  if (started) {
    std::array<char, 4096> part{};
    for (ssize_t count = 0; (count = read(ends[0], part.data(), part.size())) > 0 || (count < 0 && errno == EINTR);) {
      if (count > 0) text.append(part.data(), static_cast<std::size_t>(count));
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) text.clear();
  }
  close(ends[0]);
  return text;
}

/// Returns the path of the newest libpython in the system's folders.
std::string library_of_system() {
  fs::path best;
  for (const auto* folder : {"/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib"}) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      const auto name = entry.path().filename().string();
      if (!name.starts_with("libpython3.") || !name.ends_with(".so.1.0")) continue;
      const bool newer = best.empty() || std::pair(name.size(), name) >
                                             std::pair(best.filename().native().size(), best.filename().native());
      if (newer) best = entry.path();
    }
  }
  return best.string();
}

Python find_python() {
  const char* named = std::getenv("MEBOTS_PYTHON");
  const auto answer = output_of({named != nullptr && *named != '\0' ? named : "python3", "-c", kQuestion});
  const auto line_end = answer.find('\n');
  if (line_end == std::string::npos) return {library_of_system(), {}};
  Python python{answer.substr(0, line_end), answer.substr(line_end + 1)};
  if (const auto end = python.packages.find('\n'); end != std::string::npos) python.packages.resize(end);
  if (python.library.find(".so") == std::string::npos || !is_there(python.library)) return {library_of_system(), {}};
  return python;
}

bool uses_python(const modeldesc::ElfSymbol& symbol) {
  return !symbol.defined && (symbol.name.starts_with("Py") || symbol.name.starts_with("_Py"));
}

}  // namespace

Interpreter interpreter_of(const Fmu& fmu) {
  Interpreter interpreter;
  LibraryNeeds needs;
  try {
    needs = read_library_needs(fmu.library_file(), fmu.folder(),
                               modeldesc::loaded_libraries(modeldesc::UniqueSymbols::skip));
  } catch (const Error&) {  // the host process reports the error
    return interpreter;
  }
  interpreter.embedded = !needs.interpreter.empty();
  const bool named = std::ranges::any_of(needs.names, [](const auto& name) { return name.starts_with("libpython"); });
  const bool undefined =
      !needs.libraries.empty() && std::ranges::any_of(needs.libraries.front().elf.symbols, uses_python);
  if (!interpreter.embedded || named || !undefined) return interpreter;
  auto python = find_python();
  interpreter.library = std::move(python.library);
  interpreter.python_path = std::move(python.packages);
  return interpreter;
}

}  // namespace mebots::master
