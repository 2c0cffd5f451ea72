// SPDX-License-Identifier: Apache-2.0
#include "slave/process_state.hpp"

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
constexpr int kFirstDescriptor = 100;  // copies stay out of the way of whoever opens a file

/// umask() cannot be asked without changing it, which would be for all threads.
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

/// Nothing for a descriptor that is not open.
std::optional<File> file_behind(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return std::nullopt;
  return File{status.st_dev, status.st_ino};
}

/// Whoever serves somebody in the network, such as the page of a live run, closes a connection when that one leaves.
/// The peer may have gone already.
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

/// False for the default action, and where the handler's code was unloaded.
bool is_code(const struct sigaction& action) {
  Dl_info info{};
  return dladdr(reinterpret_cast<const void*>(action.sa_handler), &info) != 0;
}

/// The signals by which a user ends a run.
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

std::string signal_name(int signal) {
  const char* const name = sigabbrev_np(signal);
  return name == nullptr ? fmt::format("signal {}", signal) : fmt::format("SIG{}", name);
}

ProcessState::ProcessState(const Files& files)
    : umask_(current_umask()),
      folder_(current_folder()),
      locale_(current_locale()),
      environment_(EnvironmentVariables::now()),
      files_(files) {
  std::erase_if(files_, [](const auto& file) { return file_behind(file.first) != file.second; });
  for (std::size_t i = 0; i < kLimits.size(); ++i) getrlimit(kLimits[i], &limits_[i]);
  for (int i = 0; i < kStandard; ++i) {
    copies_[static_cast<std::size_t>(i)] = fcntl(i, F_DUPFD_CLOEXEC, kFirstDescriptor);
  }
  handlers_ = current_handlers();
}

ProcessState::~ProcessState() {
  for (const int copy : copies_) {
    if (copy >= 0) close(copy);
  }
}

ProcessState::Files ProcessState::open_files() {
  Files files;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", problem)) {
    const auto name = entry.path().filename().string();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (is_connection(descriptor)) continue;
    if (const auto file = file_behind(descriptor)) files[descriptor] = *file;
  }
  std::erase_if(files, [](const auto& file) { return fcntl(file.first, F_GETFD) == -1; });  // the folder's own
  return files;
}

ProcessState::Files ProcessState::standard_files() {
  Files files;
  for (int i = 0; i < kStandard; ++i) {
    if (const auto file = file_behind(i)) files[i] = *file;
  }
  return files;
}

void ProcessState::compare_files(std::vector<std::string>& texts) const {
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

void ProcessState::compare_limits(std::vector<std::string>& texts) const {
  for (std::size_t i = 0; i < kLimits.size(); ++i) {
    rlimit now{};
    getrlimit(kLimits[i], &now);
    if (now.rlim_cur == limits_[i].rlim_cur && now.rlim_max == limits_[i].rlim_max) continue;
    const bool back = setrlimit(kLimits[i], &limits_[i]) == 0;
    if (!back && !is_new_change(fmt::format("limit {}: {} {}", i, now.rlim_cur, now.rlim_max))) continue;
    texts.push_back(fmt::format("the limit {} became {}{}", kLimitNames[i], now.rlim_cur, back ? " (put back)" : ""));
  }
}

void ProcessState::compare_handlers(std::vector<std::string>& texts) const {
  for (const auto& [signal, before] : handlers_) {
    auto* const now = action_of(signal).sa_handler;
    if (now == before.sa_handler) continue;
    // A handler for one signal is gone when that came.
    if (now == SIG_DFL && (before.sa_flags & static_cast<int>(SA_RESETHAND)) != 0) continue;
    const bool back = ends_a_run(signal) && sigaction(signal, &before, nullptr) == 0;
    if (!back && !is_new_change(fmt::format("handler {}: {}", signal, reinterpret_cast<std::uintptr_t>(now)))) continue;
    texts.push_back(fmt::format("the handler of signal {} ({}) is another ({})", signal, signal_name(signal),
                                back ? "put back" : "left as it is"));
  }
}

std::vector<std::string> ProcessState::put_right() const {
  std::vector<std::string> texts;
  if (const auto mask = current_umask(); mask != umask_) {
    ::umask(umask_);
    texts.push_back(fmt::format("the mask of file modes became {:03o} (put back to {:03o})", mask, umask_));
  }
  if (const auto folder = current_folder(); folder != folder_) {
    const bool back = chdir(folder_.c_str()) == 0;
    texts.push_back(fmt::format("the working directory became {}{}", folder, back ? " (put back)" : ""));
  }
  if (const auto locale = current_locale(); locale != locale_) {
    const bool back = std::setlocale(LC_ALL, locale_.c_str()) != nullptr;
    texts.push_back(fmt::format("the locale became {}{}", locale, back ? " (put back)" : ""));
  }
  for (auto& text : environment_.restore()) texts.push_back(std::move(text));
  compare_limits(texts);
  compare_files(texts);
  timers_.put_right(texts);
  compare_handlers(texts);
  thread_.put_right(texts);
  return texts;
}

}  // namespace mebots::master
