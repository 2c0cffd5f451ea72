// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "face.hpp"
#include "mebots/fmi2/types.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::shell {

/// Hands messages of one instance to the importing tool's logger. Errors always pass; warnings and the rest pass
/// when their category, or logAll, is on.
class Logger {
 public:
  Logger(const fmi2CallbackFunctions& callbacks, std::string instance_name, bool logging_on,
         std::span<const std::string_view> own_categories);

  void log(fmi2Status status, std::string_view category, std::string_view message);

  /// No categories mean all. Throws mebots::Error for an unknown one, with nothing changed.
  void set_logging(bool on, std::span<const fmi2String> categories);

  const std::string& instance_name() const { return instance_name_; }

 private:
  struct Category {
    std::string name;
    bool on;
  };

  bool is_on(std::string_view category) const;

  fmi2CallbackLogger callback_;
  fmi2ComponentEnvironment environment_;
  std::string instance_name_;
  std::vector<Category> categories_;
};

}  // namespace mebots::shell
