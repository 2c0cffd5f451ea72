// SPDX-License-Identifier: Apache-2.0
#include "debug/threads.hpp"

#include "debug/hex.hpp"

#include <fmt/core.h>

namespace mebots::soc::debug {

std::optional<unsigned> Threads::parse(std::string_view text) const {
  if (text == "-1" || text == "0") return chosen_;
  const auto thread = parse_hex(text);
  return thread && *thread - 1 < soc_.harts() ? std::optional<unsigned>(*thread - 1) : std::nullopt;
}

std::string Threads::list() const {
  std::string text;
  for (unsigned number = 0; number < soc_.harts(); ++number) {
    text += fmt::format("{}{:x}", text.empty() ? 'm' : ',', number + 1);
  }
  return text;
}

std::string Threads::describe(unsigned number) const {
  const auto name =
      number == kFabricControllerHart ? "fabric controller" : fmt::format("cluster core {}", core_of_hart(number));
  if (!soc_.is_on(number)) return name + ", off";
  return std::as_const(soc_).hart(number).sleeping() ? name + ", asleep" : name;
}

}  // namespace mebots::soc::debug
