// SPDX-License-Identifier: Apache-2.0
#include "tool/host_console.hpp"

#include "devices/core/chip_host.hpp"
#include "mebots/error.hpp"

#include <fmt/core.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace mebots::soc::tool {
namespace {

/// Original mode of the terminal on standard input. Signal handlers restore this mode, which is therefore global.
termios saved_mode{};

void restore_terminal() {
  ::tcsetattr(STDIN_FILENO, TCSANOW, &saved_mode);
}

void restore_and_end(int signal) {
  restore_terminal();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Switches the terminal to raw mode without echo, so that each typed byte arrives at once. Signals from the keyboard
/// still end the process.
void set_raw_terminal() {
  if (::isatty(STDIN_FILENO) == 0 || ::tcgetattr(STDIN_FILENO, &saved_mode) != 0) return;
  auto raw = saved_mode;
  raw.c_iflag &= ~static_cast<tcflag_t>(INLCR | IGNCR | ICRNL | IXON | ISTRIP);
  raw.c_lflag &= ~static_cast<tcflag_t>(ECHO | ECHONL | ICANON | IEXTEN);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  std::atexit(restore_terminal);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, restore_and_end);
}

bool is_regular_or_null(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0) return true;
  return S_ISREG(status.st_mode) || (S_ISCHR(status.st_mode) && ::isatty(file) == 0);
}

/// Opens a pseudo terminal in raw mode and returns its master's descriptor.
int open_terminal() {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0) {
    throw Error(fmt::format("--console pty: no pseudo terminal: {}", std::strerror(errno)));
  }
  const std::string name = ::ptsname(master);
  // Opens the slave once. Afterwards, poll() on the master reports whether a program has the slave open.
  if (const int other = ::open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC); other >= 0) {
    termios mode{};
    ::tcgetattr(other, &mode);
    ::cfmakeraw(&mode);
    ::tcsetattr(other, TCSANOW, &mode);
    ::close(other);
  }
  fmt::print(stderr, "mebots-soc: the console is {}\n", name);
  return master;
}

bool is_hung_up(int file) {
  pollfd state{file, POLLOUT, 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & POLLHUP) != 0;
}

}  // namespace

HostConsole::HostConsole(Kind kind) : kind_(kind) {
  if (kind == Kind::pty) {
    input_ = open_terminal();
  } else if (kind != Kind::output) {
    input_ = STDIN_FILENO;
    is_file_ = is_regular_or_null(input_);
    if (kind == Kind::stdio) set_raw_terminal();
  }
}

HostConsole::~HostConsole() {
  if (kind_ == Kind::pty) ::close(input_);
}

void HostConsole::write(std::span<const char> bytes) {
  if (repeats_ && repeats_()) return;
  if (kind_ != Kind::pty) {
    std::fwrite(bytes.data(), 1, bytes.size(), stdout);
    if (!bytes.empty()) in_line_ = bytes.back() != '\n';
    return;
  }
  while (!bytes.empty() && !is_hung_up(input_)) {
    const auto count = ::write(input_, bytes.data(), bytes.size());
    if (count < 0 && errno != EINTR) return;
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void HostConsole::end_line() {
  if (in_line_) std::fputc('\n', stdout);
  in_line_ = false;
}

/// If the buffer is empty, waits for input, at most `timeout_ms` (-1: without limit). Returns true if input is
/// available.
bool HostConsole::fill(int timeout_ms) {
  if (next_ < end_) return true;
  if (ended_ || input_ < 0) return false;
  std::fflush(stdout);
  pollfd state{input_, POLLIN, 0};
  if (!is_file_ && ::poll(&state, 1, timeout_ms) <= 0) return false;
  if (!is_file_ && (state.revents & POLLIN) == 0 && kind_ == Kind::pty) {  // no program has the pseudo terminal open
    ::poll(nullptr, 0, timeout_ms < 0 ? 100 : timeout_ms);
    return false;
  }
  const auto count = ::read(input_, buffer_.data(), buffer_.size());
  next_ = 0;
  end_ = static_cast<std::size_t>(std::max<long>(count, 0));
  ended_ = count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN && kind_ != Kind::pty);
  return end_ != 0;
}

/// Returns how far the chip's time is ahead of the wall clock, in whole milliseconds from 0 to 100.
int HostConsole::milliseconds_ahead(Picoseconds now) {
  const std::chrono::nanoseconds chip(now / kPsPerNs);
  if (!start_) start_ = Clock::now() - chip;
  const auto ahead = std::chrono::duration_cast<std::chrono::milliseconds>(*start_ + chip - Clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(ahead.count(), 0, 100));
}

int HostConsole::read_byte(Picoseconds now, bool waits) {
  if (!fill(waits && !is_file_ ? milliseconds_ahead(now) : 0)) {
    return ended_ || input_ < 0 ? ConsolePort::kEnded : ConsolePort::kNothingYet;
  }
  return static_cast<std::uint8_t>(buffer_[next_++]);
}

long HostConsole::read(std::span<char> into) {
  if (into.empty()) return 0;
  while (!fill(-1)) {
    if (ended_ || input_ < 0) return 0;
  }
  const auto count = std::min(into.size(), end_ - next_);
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(next_), count, into.begin());
  next_ += count;
  return static_cast<long>(count);
}

}  // namespace mebots::soc::tool
