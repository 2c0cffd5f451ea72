// SPDX-License-Identifier: Apache-2.0
#include "slave/access_slave.hpp"

namespace mebots::master {

void AccessSlave::pass_get(ValueKind kind, std::span<const ValueReference> references, Destination values) {
  if (const auto* reals = std::get_if<std::span<double>>(&values)) return inner().get_reals(references, *reals);
  if (const auto* texts = std::get_if<std::span<std::string>>(&values)) {
    if (kind == ValueKind::binary) return inner().get_binaries(references, *texts);
    return inner().get_strings(references, *texts);
  }
  const auto numbers = std::get<std::span<std::int64_t>>(values);
  if (kind == ValueKind::boolean) return inner().get_booleans(references, numbers);
  inner().get_integers(references, numbers);
}

void AccessSlave::pass_set(ValueKind kind, std::span<const ValueReference> references, Source values) {
  if (const auto* reals = std::get_if<std::span<const double>>(&values)) return inner().set_reals(references, *reals);
  if (const auto* texts = std::get_if<std::span<const std::string>>(&values)) {
    if (kind == ValueKind::binary) return inner().set_binaries(references, *texts);
    return inner().set_strings(references, *texts);
  }
  const auto numbers = std::get<std::span<const std::int64_t>>(values);
  if (kind == ValueKind::boolean) return inner().set_booleans(references, numbers);
  inner().set_integers(references, numbers);
}

}  // namespace mebots::master
