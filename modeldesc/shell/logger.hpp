// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "version.hpp"

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::shell {

/// Sends an instance's messages to the importing tool. Always sends errors. Sends other messages if their category or
/// logAll is enabled.
class Logger {
 public:
  /// Calls the logger of the tool, whose signature depends on the version of FMI.
  using Sink = std::function<void(Status status, const char* category, std::string_view message)>;

  /// An empty sink drops all messages.
  Logger(Sink sink, bool logging_on, std::span<const std::string_view> own_categories);

  void log(Status status, std::string_view category, std::string_view message);

  /// Enables or disables categories. An empty list means all categories. If a category is unknown, throws mebots::Error
  /// and changes nothing.
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

/// Doubles each `mark`, because tools treat a single mark as a special character.
std::string doubled(std::string_view text, char mark);

}  // namespace mebots::shell
