// SPDX-License-Identifier: Apache-2.0
#include "fmi/process/process_state.hpp"

#include "fmi/call/exit_guard.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <clocale>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <set>

namespace mebots::master {
namespace {

constexpr std::array kLimitNames = {"of address space", "of core files",       "of processor time", "of data",
                                    "of file sizes",    "of open descriptors", "of the stack"};
constexpr int kFirstDescriptor = 100;  // leaves low numbers for FMUs that expect them

/// Reads the mask from /proc, because umask() would change it for all threads.
mode_t current_umask() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    mode_t mask = 0;
    if (key == "Umask:" && status >> std::oct >> mask) return mask;
  }
  return 0;
}

std::string current_folder() {
  std::error_code problem;
  return std::filesystem::current_path(problem).string();
}

std::string current_locale() {
  return std::setlocale(LC_ALL, nullptr);
}

using File = std::pair<dev_t, ino_t>;

/// Returns the file of a descriptor; nullopt if the descriptor is not open.
std::optional<File> file_behind(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return std::nullopt;
  return File{status.st_dev, status.st_ino};
}

/// True for a network connection, for example of a browser with the live page. The live server closes such a connection
/// when its peer disconnects.
bool is_connection(int descriptor) {
  const auto option = [descriptor](int name) {
    int value = -1;
    socklen_t size = sizeof value;
    return getsockopt(descriptor, SOL_SOCKET, name, &value, &size) == 0 ? value : -1;
  };
  const int family = option(SO_DOMAIN);
  return descriptor > STDERR_FILENO && (family == AF_INET || family == AF_INET6) && option(SO_ACCEPTCONN) == 0;
}

struct sigaction action_of(int signal) {
  struct sigaction action {};
  sigaction(signal, nullptr, &action);
  return action;
}

Handlers current_handlers() {
  Handlers handlers;
  for (int signal = 1; signal < SIGRTMIN; ++signal) handlers[signal] = action_of(signal);
  return handlers;
}

/// True if the handler is a function in a loaded library.
bool is_code(const struct sigaction& action) {
  Dl_info info{};
  return dladdr(reinterpret_cast<const void*>(action.sa_handler), &info) != 0;
}

bool ends_a_run(int signal) {
  return signal == SIGINT || signal == SIGTERM || signal == SIGHUP;
}

}  // namespace

Handlers handlers_in_libraries() {
  auto handlers = current_handlers();
  std::erase_if(handlers, [](const auto& handler) { return !is_code(handler.second); });
  return handlers;
}

void reset_unloaded_handlers(const Handlers& before) {
  for (const auto& [signal, action] : before) {
    if (is_code(action) || action_of(signal).sa_handler != action.sa_handler) continue;
    stop_timers_of(signal);
    std::signal(signal, SIG_DFL);
  }
}

bool is_new_change(std::string text) {
  static std::mutex mutex;
  static std::set<std::string> reported;
  const std::lock_guard lock(mutex);
  return reported.insert(std::move(text)).second;
}

OpenFiles open_files() {
  OpenFiles files;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", problem)) {
    const auto name = entry.path().filename().string();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (is_connection(descriptor)) continue;
    if (const auto file = file_behind(descriptor)) files[descriptor] = *file;
  }
  // The list contains the descriptor with which this loop has read /proc/self/fd. It is closed now.
  std::erase_if(files, [](const auto& file) { return fcntl(file.first, F_GETFD) == -1; });
  return files;
}

OpenFiles standard_files() {
  OpenFiles files;
  for (int i = STDIN_FILENO; i <= STDERR_FILENO; ++i) {
    if (const auto file = file_behind(i)) files[i] = *file;
  }
  return files;
}

DescriptorState::DescriptorState(const OpenFiles& files) : files_(files) {
  std::erase_if(files_, [](const auto& file) { return file_behind(file.first) != file.second; });
  for (int i = 0; i < kStandard; ++i) {
    copies_[static_cast<std::size_t>(i)] = fcntl(i, F_DUPFD_CLOEXEC, kFirstDescriptor);
  }
}

DescriptorState::~DescriptorState() {
  for (const int copy : copies_) {
    if (copy >= 0) close(copy);
  }
}

void DescriptorState::put_right(std::vector<std::string>& texts) const {
  for (const auto& [descriptor, file] : files_) {
    const auto now = file_behind(descriptor);
    if (now == file) continue;
    const auto* what = now ? "leads to another file" : "is closed";
    const int copy = descriptor < kStandard ? copies_[static_cast<std::size_t>(descriptor)] : -1;
    const bool back = copy >= 0 && dup2(copy, descriptor) == descriptor;
    if (!back && !is_new_change(fmt::format("descriptor {}: {} {}", descriptor, file.first, file.second))) continue;
    texts.push_back(fmt::format("descriptor {} {}{}", descriptor, what, back ? " (put back)" : ""));
  }
}

ProcessState::Rest::Rest()
    : umask(current_umask()),
      folder(current_folder()),
      locale(current_locale()),
      environment(EnvironmentVariables::now()),
      handlers(current_handlers()) {
  for (std::size_t i = 0; i < kLimits.size(); ++i) getrlimit(kLimits[i], &limits[i]);
}

void ProcessState::Rest::compare_limits(std::vector<std::string>& texts) const {
  for (std::size_t i = 0; i < kLimits.size(); ++i) {
    rlimit now{};
    getrlimit(kLimits[i], &now);
    if (now.rlim_cur == limits[i].rlim_cur && now.rlim_max == limits[i].rlim_max) continue;
    const bool back = setrlimit(kLimits[i], &limits[i]) == 0;
    if (!back && !is_new_change(fmt::format("limit {}: {} {}", i, now.rlim_cur, now.rlim_max))) continue;
    texts.push_back(fmt::format("the limit {} became {}{}", kLimitNames[i], now.rlim_cur, back ? " (put back)" : ""));
  }
}

void ProcessState::Rest::compare_handlers(std::vector<std::string>& texts) const {
  for (const auto& [signal, before] : handlers) {
    auto* const now = action_of(signal).sa_handler;
    if (now == before.sa_handler) continue;
    // The kernel resets a one-shot handler when its signal arrives.
    if (now == SIG_DFL && (before.sa_flags & static_cast<int>(SA_RESETHAND)) != 0) continue;
    const bool back = ends_a_run(signal) && sigaction(signal, &before, nullptr) == 0;
    if (!back && !is_new_change(fmt::format("handler {}: {}", signal, reinterpret_cast<std::uintptr_t>(now)))) continue;
    texts.push_back(fmt::format("the handler of signal {} ({}) changed ({})", signal, signal_name(signal),
                                back ? "put back" : "left as it is"));
  }
}

void ProcessState::Rest::put_right(std::vector<std::string>& texts) const {
  if (const auto mask = current_umask(); mask != umask) {
    ::umask(umask);
    texts.push_back(fmt::format("the mask of file modes became {:03o} (put back to {:03o})", mask, umask));
  }
  if (const auto now = current_folder(); now != folder) {
    const bool back = chdir(folder.c_str()) == 0;
    texts.push_back(fmt::format("the working directory became {}{}", now, back ? " (put back)" : ""));
  }
  if (const auto now = current_locale(); now != locale) {
    const bool back = std::setlocale(LC_ALL, locale.c_str()) != nullptr;
    texts.push_back(fmt::format("the locale became {}{}", now, back ? " (put back)" : ""));
  }
  for (auto& text : environment.restore()) texts.push_back(std::move(text));
  compare_limits(texts);
  timers.put_right(texts);
  compare_handlers(texts);
  thread.put_right(texts);
}

ProcessState::ProcessState(const OpenFiles& files, ProcessReach reach) : descriptors_(files) {
  if (reach == ProcessReach::everything) rest_.emplace();
}

std::vector<std::string> ProcessState::put_right() const {
  std::vector<std::string> texts;
  descriptors_.put_right(texts);
  if (rest_) rest_->put_right(texts);
  return texts;
}

}  // namespace mebots::master
