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

/// Prints messages. Lines go to standard output, warnings and errors to standard error. In quiet mode, only always()
/// prints lines. On a terminal, redraw() replaces one line in place, and warnings and errors have colours unless
/// NO_COLOR is set (no-color.org).
class Console final {
 public:
  explicit Console(bool quiet);

  void message(const Message& message);
  void line(std::string_view text);
  /// Prints a line even in quiet mode.
  void always(std::string_view text);
  void warning(std::string_view text);
  void error(std::string_view text);

  /// True if standard output is a terminal, on which redraw() works.
  bool is_terminal() const { return terminal_; }
  static std::size_t width();
  /// Draws a line that the next redraw() replaces. An empty text removes the line.
  void redraw(std::string_view text);

 private:
  void put(std::FILE* stream, std::string_view text);
  std::string coloured(Severity severity, std::string text) const;

  std::mutex mutex_;
  bool quiet_;
  bool terminal_;
  bool colour_;  // true if standard error is in colour
  std::string drawn_;
  std::map<std::pair<std::string, Severity>, int> counts_;  // number of messages by instance and severity
};

}  // namespace mebots::app
