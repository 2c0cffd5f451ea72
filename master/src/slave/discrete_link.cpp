// SPDX-License-Identifier: Apache-2.0
#include "slave/discrete_link.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <bit>
#include <span>

namespace mebots::master {
namespace {

template <typename T>
LinkValue got(Slave& slave, ValueReference reference,
              void (Slave::*get)(std::span<const ValueReference>, std::span<T>)) {
  T value{};
  (slave.*get)({&reference, 1}, {&value, 1});
  return value;
}

template <typename T>
void give(Slave& slave, ValueReference reference, const LinkValue& value,
          void (Slave::*set)(std::span<const ValueReference>, std::span<const T>)) {
  (slave.*set)({&reference, 1}, {&std::get<T>(value), 1});
}

}  // namespace

LinkValue get_value(Slave& slave, ValueKind kind, ValueReference reference) {
  switch (kind) {
    case ValueKind::real:
      return got(slave, reference, &Slave::get_reals);
    case ValueKind::integer:
      return got(slave, reference, &Slave::get_integers);
    case ValueKind::boolean:
      return got(slave, reference, &Slave::get_booleans);
    case ValueKind::string:
      return got(slave, reference, &Slave::get_strings);
    case ValueKind::binary:
      return got(slave, reference, &Slave::get_binaries);
    case ValueKind::clock:
      break;
  }
  MEBOTS_ASSERT(false, "clocks have no value");
  return 0.0;
}

void set_value(Slave& slave, ValueKind kind, ValueReference reference, const LinkValue& value) {
  switch (kind) {
    case ValueKind::real:
      return give(slave, reference, value, &Slave::set_reals);
    case ValueKind::integer:
      return give(slave, reference, value, &Slave::set_integers);
    case ValueKind::boolean:
      return give(slave, reference, value, &Slave::set_booleans);
    case ValueKind::string:
      return give(slave, reference, value, &Slave::set_strings);
    case ValueKind::binary:
      return give(slave, reference, value, &Slave::set_binaries);
    case ValueKind::clock:
      break;
  }
  MEBOTS_ASSERT(false, "clocks have no value");
}

bool is_same(const LinkValue& a, const LinkValue& b) {
  const auto* const one = std::get_if<double>(&a);
  const auto* const other = std::get_if<double>(&b);
  if (one == nullptr || other == nullptr) return a == b;
  return std::bit_cast<std::uint64_t>(*one) == std::bit_cast<std::uint64_t>(*other);
}

LinkValue DiscreteLink::read(Slave& source) const {
  auto value = get_value(source, from_kind, from_reference);
  if (auto* const whole = std::get_if<std::int64_t>(&value)) {
    const auto mapped = std::ranges::find(map, *whole, [](const auto& pair) { return pair.first; });
    if (mapped != map.end()) *whole = mapped->second;
    if (to_kind != ValueKind::real) return value;
    return factor * static_cast<double>(*whole) + offset;
  }
  if (const auto* const real = std::get_if<double>(&value)) return factor * *real + offset;
  return value;
}

}  // namespace mebots::master
