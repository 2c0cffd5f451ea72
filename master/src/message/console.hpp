// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message.hpp"
#include "sink/output_file.hpp"

#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace mebots::master {

/// What the user sees: lines on standard output (none when quiet), warnings and errors on standard error
/// (always), and one line that is redrawn in place on a terminal. FMU messages also go to a log file.
class Console final : public MessageSink {
 public:
  explicit Console(bool quiet);

  /// From now on FMU messages are written there too; null = no longer.
  void set_log_file(OutputFile* file) { log_file_ = file; }

  void message(const Message& message) override;
  void line(std::string_view text);
  void warning(std::string_view text);
  void error(std::string_view text);

  /// True when standard output is a terminal, so that a line can be redrawn.
  bool is_terminal() const { return terminal_; }
  bool quiet() const { return quiet_; }
  /// Draws a line that the next one replaces; empty removes it.
  void redraw(std::string_view text);

 private:
  void put(std::FILE* stream, std::string_view text);

  std::mutex mutex_;
  bool quiet_;
  bool terminal_;
  std::string drawn_;
  OutputFile* log_file_ = nullptr;
  std::map<std::string, int, std::less<>> warnings_;  // per instance
};

/// "[   12.345 s]", the stamp of a message.
std::string time_stamp(std::int64_t time_ns);

}  // namespace mebots::master
