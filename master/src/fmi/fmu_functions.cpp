// SPDX-License-Identifier: Apache-2.0
#include "fmi/fmu_functions.hpp"

#include "fmi/call/library_call.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {
namespace {

std::string shown_text(const std::optional<std::string>& text, const char* address) {
  if (text) return fmt::format("'{}'", *text);
  return address == nullptr ? "nothing" : "an address where nothing can be read";
}

struct Expected {
  const char* function;
  const char* doing;  ///< completes "the library was ..." in crash messages
  const char* text;
  const char* consequence = "";
  bool may_continue = false;  ///< true permits a longer text, such as "3.0.2"
};

template <typename Function>
void require_text(const LibraryOwner& owner, const Expected& expected, Function* function) {
  const char* const answer = call_library(owner.archive, expected.doing, function);
  const auto text = read_text(answer);
  if (text && (expected.may_continue ? text->starts_with(expected.text) : text == expected.text)) return;
  throw InputError(*expected.consequence == 0 ? ErrorCode::fmu_inconsistent : ErrorCode::fmu_unsupported,
                   fmt::format("{}: {} returns {} instead of '{}'{}", owner.archive.string(), expected.function,
                               shown_text(text, answer), expected.text, expected.consequence));
}

constexpr const char* kVersionCall = "asked for its version";
constexpr const char* kPlatformCall = "asked for its platform";
constexpr const char* kOtherSizes = ": the FMU's number types differ in size from those of mebots";

/// Throws InputError if a needed function is null. `for_each` must be for_each_function() of the FMI version.
template <typename Functions, typename ForEach, typename IsNeeded>
void require_functions(const LibraryOwner& owner, const Functions& functions, ForEach for_each, IsNeeded is_needed) {
  std::vector<std::string> missing;
  for_each([&](const char* name, auto member, auto need) {
    if (is_needed(need) && functions.*member() == nullptr) missing.emplace_back(name);
  });
  if (missing.empty()) return;
  throw InputError(ErrorCode::fmu_inconsistent,
                   fmt::format("{}: the FMU's shared library lacks functions that FMI {} demands: {}",
                               owner.archive.string(), owner.description.fmi_version, fmt::join(missing, ", ")));
}

void check(const Fmi1Functions& functions, const LibraryOwner& owner) {
  require_functions(
      owner, functions, [](auto action) { fmi1::for_each_function(action); },
      [](fmi1::Need need) { return need == fmi1::Need::to_run; });
  require_text(owner, {"fmiGetVersion", kVersionCall, "1.0"}, functions.get_version);
  require_text(owner, {"fmiGetTypesPlatform", kPlatformCall, "standard32", kOtherSizes}, functions.get_types_platform);
}

void check(const Fmi2Functions& functions, const LibraryOwner& owner) {
  using fmi2::Need;
  const auto to_run_kind = owner.kind == FmuKind::co_simulation ? Need::to_step : Need::to_integrate;
  require_functions(
      owner, functions, [](auto action) { fmi2::for_each_function(action); },
      [&](Need need) { return need == Need::to_run || need == to_run_kind; });
  require_text(owner, {"fmi2GetVersion", kVersionCall, "2.0"}, functions.get_version);
  require_text(owner, {"fmi2GetTypesPlatform", kPlatformCall, "default", kOtherSizes}, functions.get_types_platform);
}

void check(const Fmi3Functions& functions, const LibraryOwner& owner) {
  using fmi3::Need;
  const bool integrates = owner.kind == FmuKind::model_exchange;
  const bool has_event_mode = !integrates && owner.description.co_simulation->has_event_mode;
  require_functions(
      owner, functions, [](auto action) { fmi3::for_each_function(action); },
      [&](Need need) {
        return need == Need::to_run || need == (integrates ? Need::to_integrate : Need::to_step) ||
               (need == Need::events && (integrates || has_event_mode)) || (need == Need::event_mode && has_event_mode);
      });
  require_text(owner, {"fmi3GetVersion", kVersionCall, "3.0", "", true}, functions.get_version);
}

void check(const std::monostate& /*none*/, const LibraryOwner& /*owner*/) {}

FmuFunctions find_functions(void* library, const modeldesc::ModelDescription& description) {
  if (description.is_fmi1()) return fmi1::find_functions(library, description.co_simulation->model_identifier);
  if (description.is_fmi3()) return fmi3::find_functions(library);
  return fmi2::find_functions(library);
}

}  // namespace

void check_functions(const FmuFunctions& functions, const LibraryOwner& owner) {
  std::visit([&](const auto& table) { check(table, owner); }, functions);
}

FmuFunctions load_functions(void* library, const LibraryOwner& owner) {
  auto functions = find_functions(library, owner.description);
  check_functions(functions, owner);
  return functions;
}

}  // namespace mebots::master
