// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"
#include "tool/console.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace mebots::soc::tool {

/// The console of a program: standard output with or without standard input, or a pseudo terminal.
class HostConsole final : public Console {
 public:
  enum class Kind : std::uint8_t {
    output,  // no input
    lines,   // standard input as its terminal delivers it
    stdio,   // standard input byte by byte: sets its terminal to raw mode, until the process ends
    pty,     // announces the name of a pseudo terminal on standard error
  };

  /// Throws Error if there is no pseudo terminal.
  explicit HostConsole(Kind kind);
  HostConsole(const HostConsole&) = delete;
  HostConsole& operator=(const HostConsole&) = delete;
  ~HostConsole() override;

  bool has_input() const { return input_ >= 0; }
  /// Writes to standard output, or to the terminal. While no program has the pseudo terminal open, the bytes are lost.
  void write(std::span<const char> bytes) override;
  /// Sets a function that returns true while the console must not write because a debugger repeats a part of the run.
  void mute_while(std::function<bool()> repeats) { repeats_ = std::move(repeats); }
  /// Ends an unfinished line on standard output. Must be called before other text is printed.
  void end_line();
  /// Removes and returns the next input byte, like ConsolePort::read_console(). A file on standard input returns its
  /// next byte at once. For other input, if `waits` is true, the function waits for a byte until the wall clock has
  /// advanced as far as `now`.
  int read_byte(Picoseconds now, bool waits);
  /// Waits for input. Returns the number of bytes read; 0 at the end of the input.
  long read(std::span<char> into) override;

 private:
  using Clock = std::chrono::steady_clock;

  bool fill(int timeout_ms);
  int milliseconds_ahead(Picoseconds now);

  std::function<bool()> repeats_;
  Kind kind_;
  int input_ = -1;        // file descriptor; -1 = none
  bool is_file_ = false;  // input is always available without waiting
  bool ended_ = false;
  bool in_line_ = false;  // the last byte on standard output was not the end of a line
  std::array<char, 4096> buffer_{};
  std::size_t next_ = 0;
  std::size_t end_ = 0;
  std::optional<Clock::time_point> start_;  // when the chip's time was 0
};

}  // namespace mebots::soc::tool
