// SPDX-License-Identifier: Apache-2.0
#include "console.hpp"

#include "message/message_text.hpp"

#include <fmt/format.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

namespace mebots::app {
namespace {

/// Maximum number of printed messages per instance and severity. An FMU may send a message in each step.
constexpr int kShown = 20;

constexpr std::string_view kClearLine = "\r\x1b[K";
constexpr std::size_t kUsualWidth = 80;

bool wants_colour(int stream) {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  if (no_colour != nullptr && *no_colour != '\0') return false;
  return ::isatty(stream) == 1 && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

}  // namespace

Console::Console(bool quiet)
    : quiet_(quiet), terminal_(::isatty(STDOUT_FILENO) == 1), colour_(wants_colour(STDERR_FILENO)) {}

std::size_t Console::width() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return kUsualWidth;
}

std::string Console::coloured(Severity severity, std::string text) const {
  if (!colour_ || severity == Severity::info) return text;
  return fmt::format("\x1b[{}m{}\x1b[0m", severity == Severity::warning ? "33" : "31", text);
}

void Console::put(std::FILE* stream, std::string_view text) {
  if (!drawn_.empty()) std::fwrite(kClearLine.data(), 1, kClearLine.size(), stdout);
  if (stream == stderr) std::fflush(stdout);
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fputc('\n', stream);
  if (!drawn_.empty()) std::fwrite(drawn_.data(), 1, drawn_.size(), stdout);
  std::fflush(stream);
  if (terminal_) std::fflush(stdout);
}

void Console::message(const Message& message) {
  const std::lock_guard lock(mutex_);
  const auto text = master::message_text(message);
  if (message.severity == Severity::info) {
    if (!quiet_) put(stdout, text);
    return;
  }
  const auto count = ++counts_[{std::string(message.instance), message.severity}];
  if (count == kShown + 1) {
    const auto* what = message.severity == Severity::warning ? "warnings" : "errors";
    put(stderr, coloured(message.severity, fmt::format("{} {}: more {} follow; they are in log.txt only",
                                                       master::time_stamp(message.time_ns), message.instance, what)));
  }
  if (count > kShown) return;
  put(stderr, coloured(message.severity, text));
}

void Console::line(std::string_view text) {
  const std::lock_guard lock(mutex_);
  if (!quiet_) put(stdout, text);
}

void Console::always(std::string_view text) {
  const std::lock_guard lock(mutex_);
  put(stdout, text);
}

void Console::warning(std::string_view text) {
  const std::lock_guard lock(mutex_);
  put(stderr, coloured(Severity::warning, fmt::format("mebots: warning: {}", text)));
}

void Console::error(std::string_view text) {
  const std::lock_guard lock(mutex_);
  put(stderr, coloured(Severity::error, fmt::format("mebots: error: {}", text)));
}

void Console::redraw(std::string_view text) {
  const std::lock_guard lock(mutex_);
  if (quiet_ || !terminal_ || (text.empty() && drawn_.empty())) return;
  std::fwrite(kClearLine.data(), 1, kClearLine.size(), stdout);
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
  drawn_ = text;
}

}  // namespace mebots::app
