// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calls.hpp"
#include "mebots/fmi3/functions.hpp"

/// What the files of the C functions of FMI 3.0 share.
namespace mebots::shell {

static_assert(static_cast<int>(Status::ok) == fmi3OK && static_cast<int>(Status::warning) == fmi3Warning &&
              static_cast<int>(Status::discard) == fmi3Discard && static_cast<int>(Status::error) == fmi3Error &&
              static_cast<int>(Status::fatal) == fmi3Fatal);

template <typename Body>
fmi3Status guarded3(fmi3Instance instance, const Function& function, Body body) noexcept {
  return static_cast<fmi3Status>(guarded(instance, function, body));
}

/// Returns the rows of the table that the elements of these variables are in, one after the other; of a Binary, that of
/// its first part. The independent variable's is the number of rows. Throws mebots::Error for a reference without a
/// variable, one of another type, and if the rows are not as many as the values.
std::vector<fmi2ValueReference> rows_of(const Instance& instance, std::span<const fmi3ValueReference> references,
                                        std::string_view type, std::size_t value_count);

}  // namespace mebots::shell
