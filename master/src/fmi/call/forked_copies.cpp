// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/forked_copies.hpp"

#include "base/signal_guard.hpp"
#include "fmi/call/callbacks.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <new>

namespace mebots::master {
namespace {

constinit std::atomic<char> always_original{1};

}  // namespace

constinit std::atomic<char>* detail::original = &always_original;

namespace {

/// The maximum wait for forked copies that are still running. A copy that returns from a call to the FMU needs less
/// time.
constexpr int kGraceMs = 100;

/// The file descriptors for reports of forked copies. They are atomic, because a copy contains only the forking thread
/// and must not lock a mutex.
std::array<std::atomic<int>, ForkedCopies::kMost>& write_ends() {
  static auto& all = *[] {
    auto* const made = new std::array<std::atomic<int>, ForkedCopies::kMost>;
    for (auto& end : *made) end = -1;
    return made;
  }();
  return all;
}

/// Returns a page of memory that the kernel fills with zeros in forked processes; null if the system does not support
/// this.
void* page_wiped_on_fork() {
  constexpr std::size_t kBytes = 4096;
  void* const page = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) return nullptr;
  if (madvise(page, kBytes, MADV_WIPEONFORK) == 0) return page;
  munmap(page, kBytes);
  return nullptr;
}

/// Called in the forked copy, on its only thread.
void after_fork() {
  const auto call = current_call();
  if (call.instance == nullptr && call.library == nullptr) detail::original->store(1, std::memory_order_relaxed);
}

}  // namespace

void detect_forked_copies() {
  static const bool installed = [] {
    write_ends();
    pthread_atfork(nullptr, nullptr, &after_fork);
    if (void* const page = page_wiped_on_fork()) detail::original = new (page) std::atomic<char>{1};
    return true;
  }();
  static_cast<void>(installed);
}

void end_forked_copy() noexcept {
  const auto call = current_call();
  SignalLine line;
  if (call.instance != nullptr) {
    constexpr std::int64_t kPerMillisecond = 1'000'000;
    line << "instance '" << call.instance << "' at " << call.time_ns / kPerMillisecond << " ms: its FMU";
  } else {
    line << "the library of the FMU " << (call.library == nullptr ? "?" : call.library);
  }
  line << " forked the process in " << call.function
       << ", and the copy returned from the call. It was ended: a forked process must end or replace itself";
  for (auto& end : write_ends()) {
    if (const int descriptor = end.load(); descriptor >= 0) line.write_to(descriptor);
  }
  SignalLine shown;
  shown << "mebots: error: " << line.text() << "\n";
  shown.write_to(STDERR_FILENO);
  for (;;) syscall(SYS_exit_group, EXIT_FAILURE);
}

ForkedCopies::ForkedCopies() {
  detect_forked_copies();
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
  read_end_ = ends[0];
  write_end_ = ends[1];
  for (int i = 0; i < kMost && slot_ < 0; ++i) {
    int free = -1;
    if (write_ends()[static_cast<std::size_t>(i)].compare_exchange_strong(free, write_end_)) slot_ = i;
  }
}

ForkedCopies::~ForkedCopies() {
  close_end(write_end_);
  close_end(read_end_);
}

void ForkedCopies::close_end(int& end) {
  if (end < 0) return;
  if (end == write_end_ && slot_ >= 0) write_ends()[static_cast<std::size_t>(slot_)] = -1;
  close(end);
  end = -1;
}

std::optional<std::string> ForkedCopies::returned() {
  close_end(write_end_);  // then only copies have this end open; without copies, poll() returns at once
  pollfd reports{read_end_, POLLIN, 0};
  if (read_end_ < 0 || poll(&reports, 1, kGraceMs) <= 0) return std::nullopt;
  std::array<char, 1024> text;
  const auto size = read(read_end_, text.data(), text.size());
  if (size <= 0) return std::nullopt;
  return std::string(text.data(), static_cast<std::size_t>(size));
}

}  // namespace mebots::master
