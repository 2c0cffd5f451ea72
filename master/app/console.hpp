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

/// The output on the terminal. Lines go to standard output; in quiet mode, most of them are not printed. Warnings and
/// errors always go to standard error. On a terminal, one line can be redrawn in place. On a terminal, warnings and
/// errors are coloured unless NO_COLOR is set (no-color.org).
class Console final {
 public:
  explicit Console(bool quiet);

  void message(const Message& message);
  void line(std::string_view text);
  /// Prints a line even in quiet mode, because the user needs it.
  void always(std::string_view text);
  void warning(std::string_view text);
  void error(std::string_view text);

  /// True if standard output is a terminal, so that a line can be redrawn.
  bool is_terminal() const { return terminal_; }
  /// Returns the present width of the terminal in characters.
  static std::size_t width();
  /// Draws a line that the next drawn line replaces. An empty text removes it.
  void redraw(std::string_view text);

 private:
  void put(std::FILE* stream, std::string_view text);
  std::string coloured(Severity severity, std::string text) const;

  std::mutex mutex_;
  bool quiet_;
  bool terminal_;
  bool colour_;  // of standard error
  std::string drawn_;
  std::map<std::pair<std::string, Severity>, int> counts_;  // of warnings and errors, by instance
};

}  // namespace mebots::app
