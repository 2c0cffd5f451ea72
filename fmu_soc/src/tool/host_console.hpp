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

/// Connects a program's console to standard input and output, or to a pseudo terminal.
class HostConsole final : public Console {
 public:
  enum class Kind : std::uint8_t {
    output,  // standard output only; the program has no input
    lines,   // standard input line by line, as the terminal delivers it
    stdio,   // standard input byte by byte; the terminal is in raw mode until the process ends
    pty,     // a pseudo terminal, whose name is printed on standard error
  };

  /// Throws Error if a pseudo terminal cannot be opened.
  explicit HostConsole(Kind kind);
  HostConsole(const HostConsole&) = delete;
  HostConsole& operator=(const HostConsole&) = delete;
  ~HostConsole() override;

  bool has_input() const { return input_ >= 0; }
  /// Writes to standard output or to the pseudo terminal. If no program has the pseudo terminal open, the bytes are
  /// lost.
  void write(std::span<const char> bytes) override;
  /// `repeats` must return true while a debugger repeats a part of the run, in which the console writes nothing.
  void mute_while(std::function<bool()> repeats) { repeats_ = std::move(repeats); }
  /// Ends an unfinished line on standard output. Must be called before other text is printed.
  void end_line();
  /// Removes and returns the next input byte. See ConsolePort::read_console(). A file on standard input returns its
  /// next byte at once. For other input, if `waits` is true, waits for a byte until the wall clock reaches `now`, but
  /// at most 100 ms.
  int read_byte(Picoseconds now, bool waits);
  /// Waits for input and reads it into `into`. Returns the number of bytes, or 0 at the end of the input.
  long read(std::span<char> into) override;

 private:
  using Clock = std::chrono::steady_clock;

  bool fill(int timeout_ms);
  int milliseconds_ahead(Picoseconds now);

  std::function<bool()> repeats_;
  Kind kind_;
  int input_ = -1;        // file descriptor of the input; -1 = no input
  bool is_file_ = false;  // input is a file, so that reading never waits
  bool ended_ = false;
  bool in_line_ = false;  // the last byte on standard output was not the end of a line
  std::array<char, 4096> buffer_{};
  std::size_t next_ = 0;
  std::size_t end_ = 0;
  std::optional<Clock::time_point> start_;  // wall-clock time that corresponds to time 0 of the chip
};

}  // namespace mebots::soc::tool
