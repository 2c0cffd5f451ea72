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

/// Prints the messages of a command. Lines go to standard output; in quiet mode, only always() prints lines. Warnings
/// and errors always go to standard error. On a terminal, redraw() replaces one line in place, and warnings and errors
/// are coloured unless NO_COLOR is set (no-color.org).
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
  /// Returns the current width of the terminal in characters.
  static std::size_t width();
  /// Draws a line that the next drawn line replaces. An empty text removes it.
  void redraw(std::string_view text);

 private:
  void put(std::FILE* stream, std::string_view text);
  std::string coloured(Severity severity, std::string text) const;

  std::mutex mutex_;
  bool quiet_;
  bool terminal_;
  bool colour_;  // true if standard error shows colours
  std::string drawn_;
  std::map<std::pair<std::string, Severity>, int> counts_;  // number of warnings and errors of each instance
};

}  // namespace mebots::app
