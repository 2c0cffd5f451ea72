// SPDX-License-Identifier: Apache-2.0
#include "message/console.hpp"

#include "base/time.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>

namespace mebots::master {
namespace {

/// An FMU that warns at every step must not bury everything else.
constexpr int kWarningsShown = 20;

constexpr std::string_view kClearLine = "\r\x1b[K";

}  // namespace

std::string time_stamp(std::int64_t time_ns) {
  return fmt::format("[{:>9.3f} s]", to_seconds(time_ns));
}

Console::Console(bool quiet) : quiet_(quiet), terminal_(::isatty(STDOUT_FILENO) == 1) {}

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
  const char* kind = message.severity == Severity::info      ? ""
                     : message.severity == Severity::warning ? "warning: "
                                                             : "error: ";
  const auto text = fmt::format("{} {}: {}{}", time_stamp(message.time_ns), message.instance, kind, message.text);
  if (log_file_ != nullptr) log_file_->append(text + "\n");
  if (message.severity == Severity::info) {
    if (!quiet_) put(stdout, text);
    return;
  }
  if (message.severity == Severity::warning) {
    const auto count = ++warnings_[std::string(message.instance)];
    if (count == kWarningsShown + 1) {
      put(stderr, fmt::format("{} {}: more warnings follow; they are in log.txt only", time_stamp(message.time_ns),
                              message.instance));
    }
    if (count > kWarningsShown) return;
  }
  put(stderr, text);
}

void Console::line(std::string_view text) {
  const std::lock_guard lock(mutex_);
  if (!quiet_) put(stdout, text);
}

void Console::warning(std::string_view text) {
  const std::lock_guard lock(mutex_);
  put(stderr, fmt::format("mebots: warning: {}", text));
}

void Console::error(std::string_view text) {
  const std::lock_guard lock(mutex_);
  put(stderr, fmt::format("mebots: error: {}", text));
}

void Console::redraw(std::string_view text) {
  const std::lock_guard lock(mutex_);
  if (quiet_ || !terminal_ || (text.empty() && drawn_.empty())) return;
  std::fwrite(kClearLine.data(), 1, kClearLine.size(), stdout);
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
  drawn_ = text;
}

}  // namespace mebots::master
