// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "version.hpp"

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::shell {

/// Hands messages of one instance to the importing tool's logger. Errors always pass; warnings and the rest pass
/// when their category, or logAll, is on.
class Logger {
 public:
  /// Calls the tool's logger as its version of FMI has it.
  using Sink = std::function<void(Status status, const char* category, std::string_view message)>;

  /// An empty sink drops all messages.
  Logger(Sink sink, bool logging_on, std::span<const std::string_view> own_categories);

  void log(Status status, std::string_view category, std::string_view message);

  /// No categories mean all. Throws mebots::Error for an unknown one, with nothing changed.
  void set_logging(bool on, std::span<const char* const> categories);

 private:
  struct Category {
    std::string name;
    bool on;
  };

  bool is_on(std::string_view category) const;

  Sink sink_;
  std::vector<Category> categories_;
};

/// The text with each `mark` written twice: tools take a single one for a sign of their own.
std::string doubled(std::string_view text, char mark);

}  // namespace mebots::shell
