// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace mebots {

/// Identifies the kind of an error. The name of a code keeps its meaning across versions, in C++, Python and files. The
/// number of a code may change, and new codes may be added.
enum class ErrorCode {
  unspecified,
  // Errors of access to files.
  file_not_found,
  file_unreadable,
  file_unwritable,
  // Errors in the contents of files, in command lines and in calls.
  syntax_error,
  unknown_key,
  missing_key,
  duplicate_key,
  wrong_type,
  wrong_unit,
  value_out_of_range,
  invalid_value,
  unknown_name,
  duplicate_name,
  invalid_connection,
  algebraic_loop,
  // Errors in FMU archives and in the search for FMUs.
  archive_damaged,
  fmu_not_found,
  fmu_unsupported,
  fmu_inconsistent,
  // Errors in the arguments or the order of function calls.
  invalid_argument,
  wrong_call_order,
  not_offered,
  // Errors during a run.
  fmu_failed,
  fmu_lost,
  fmu_timeout,
  not_finite,
  not_converged,
  interrupted,
  // Errors when a saved state is restored.
  state_damaged,
  state_of_other_fmu,
  state_of_other_build,
  // Errors that the operating system reports.
  system_failure,
};

struct ErrorCodeRow {
  ErrorCode code;
  std::string_view name;
  std::string_view meaning;
};

/// Lists all codes with name and meaning, in the order of the enumeration.
inline constexpr std::array kErrorCodes{
    ErrorCodeRow{ErrorCode::unspecified, "unspecified", "the function that found the error gave no code"},
    ErrorCodeRow{ErrorCode::file_not_found, "file_not_found", "there is no such file or folder"},
    ErrorCodeRow{ErrorCode::file_unreadable, "file_unreadable", "the file is there but cannot be read"},
    ErrorCodeRow{ErrorCode::file_unwritable, "file_unwritable", "a file or folder cannot be made, written or removed"},
    ErrorCodeRow{ErrorCode::syntax_error, "syntax_error", "the text does not follow its format: JSON, XML, CSV, ELF"},
    ErrorCodeRow{ErrorCode::unknown_key, "unknown_key", "a key or option that is unknown"},
    ErrorCodeRow{ErrorCode::missing_key, "missing_key", "a key or option that is needed is absent"},
    ErrorCodeRow{ErrorCode::duplicate_key, "duplicate_key", "a key occurs twice in one object"},
    ErrorCodeRow{ErrorCode::wrong_type, "wrong_type", "a text where a number is needed, and the like"},
    ErrorCodeRow{ErrorCode::wrong_unit, "wrong_unit", "a unit that is unknown or does not fit"},
    ErrorCodeRow{ErrorCode::value_out_of_range, "value_out_of_range", "a number outside its limits"},
    ErrorCodeRow{ErrorCode::invalid_value, "invalid_value", "a value of the right type that is not possible here"},
    ErrorCodeRow{ErrorCode::unknown_name, "unknown_name", "no instance, variable, unit or file entry has this name"},
    ErrorCodeRow{ErrorCode::duplicate_name, "duplicate_name", "a name is already used"},
    ErrorCodeRow{ErrorCode::invalid_connection, "invalid_connection", "two variables that cannot be connected"},
    ErrorCodeRow{ErrorCode::algebraic_loop, "algebraic_loop", "values that depend on each other without a delay"},
    ErrorCodeRow{ErrorCode::archive_damaged, "archive_damaged", "not a zip archive, or a damaged or hostile one"},
    ErrorCodeRow{ErrorCode::fmu_not_found, "fmu_not_found", "no FMU of this name in the places searched"},
    ErrorCodeRow{ErrorCode::fmu_unsupported, "fmu_unsupported", "another FMI version, platform or kind of FMU"},
    ErrorCodeRow{ErrorCode::fmu_inconsistent, "fmu_inconsistent",
                 "description, archive and library contradict each other"},
    ErrorCodeRow{ErrorCode::invalid_argument, "invalid_argument", "an invalid argument of a call"},
    ErrorCodeRow{ErrorCode::wrong_call_order, "wrong_call_order", "a call that is not allowed now"},
    ErrorCodeRow{ErrorCode::not_offered, "not_offered", "a capability that this FMU does not have"},
    ErrorCodeRow{ErrorCode::fmu_failed, "fmu_failed", "an FMU refused a call in a run"},
    ErrorCodeRow{ErrorCode::fmu_lost, "fmu_lost", "the process of an isolated FMU ended"},
    ErrorCodeRow{ErrorCode::fmu_timeout, "fmu_timeout", "an FMU did not answer in time"},
    ErrorCodeRow{ErrorCode::not_finite, "not_finite", "NaN or infinity where a number is needed"},
    ErrorCodeRow{ErrorCode::not_converged, "not_converged", "a solver or an iteration found no solution"},
    ErrorCodeRow{ErrorCode::interrupted, "interrupted", "the end was requested: Ctrl-C, SIGTERM, cancel"},
    ErrorCodeRow{ErrorCode::state_damaged, "state_damaged", "the bytes of a saved state are cut short or changed"},
    ErrorCodeRow{ErrorCode::state_of_other_fmu, "state_of_other_fmu", "a saved state of another FMU or system"},
    ErrorCodeRow{ErrorCode::state_of_other_build, "state_of_other_build",
                 "a saved state with another layout of the variables"},
    ErrorCodeRow{ErrorCode::system_failure, "system_failure", "no memory, process or library of the operating system"},
};

static_assert(
    [] {
      for (std::size_t i = 0; i < kErrorCodes.size(); ++i) {
        if (kErrorCodes[i].code != static_cast<ErrorCode>(i)) return false;
      }
      return kErrorCodes.size() == static_cast<std::size_t>(ErrorCode::system_failure) + 1;
    }(),
    "one row per code, in the order of the enumeration");

constexpr std::string_view name_of(ErrorCode code) {
  return kErrorCodes[static_cast<std::size_t>(code)].name;
}

/// Returns the code with this name; empty if the name is unknown, which can happen if it comes from a file or from
/// another process.
constexpr std::optional<ErrorCode> error_code_of(std::string_view name) {
  const auto* const found =
      std::find_if(kErrorCodes.begin(), kErrorCodes.end(), [&](const ErrorCodeRow& row) { return row.name == name; });
  if (found == kErrorCodes.end()) return std::nullopt;
  return found->code;
}

}  // namespace mebots
