// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/message.hpp"

#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace mebots::app {

/// What the user sees: lines on standard output (few when quiet), warnings and errors on standard error (always), and
/// one line that is redrawn in place on a terminal. Warnings and errors are coloured on a terminal, unless NO_COLOR is
/// set (no-color.org).
class Console final {
 public:
  explicit Console(bool quiet);

  void message(const Message& message);
  void line(std::string_view text);
  /// A line that is wanted even when quiet: nothing could be done without it.
  void always(std::string_view text);
  void warning(std::string_view text);
  void error(std::string_view text);

  /// True when standard output is a terminal, so that a line can be redrawn.
  bool is_terminal() const { return terminal_; }
  /// Characters in a row of the terminal, as it is now.
  static std::size_t width();
  /// Draws a line that the next one replaces; empty removes it.
  void redraw(std::string_view text);

 private:
  void put(std::FILE* stream, std::string_view text);
  std::string coloured(Severity severity, std::string text) const;

  std::mutex mutex_;
  bool quiet_;
  bool terminal_;
  bool colour_;  // on standard error
  std::string drawn_;
  std::map<std::pair<std::string, Severity>, int> counts_;  // of warnings and errors, per instance
};

}  // namespace mebots::app
