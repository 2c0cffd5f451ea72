// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/forwarding_slave.hpp"

#include <variant>

namespace mebots::master {

/// A forwarding slave whose ten access functions call get() or set(). The argument `kind` distinguishes Booleans from
/// Integers and Binaries from Strings, because each pair has the same C++ type.
class AccessSlave : public ForwardingSlave {
 public:
  using ForwardingSlave::ForwardingSlave;

  void get_reals(std::span<const ValueReference> references, std::span<double> values) final {
    get(ValueKind::real, references, values);
  }
  void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) final {
    get(ValueKind::integer, references, values);
  }
  void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) final {
    get(ValueKind::boolean, references, values);
  }
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) final {
    get(ValueKind::string, references, values);
  }
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) final {
    set(ValueKind::real, references, values);
  }
  void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) final {
    set(ValueKind::integer, references, values);
  }
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) final {
    set(ValueKind::boolean, references, values);
  }
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) final {
    set(ValueKind::string, references, values);
  }
  void get_binaries(std::span<const ValueReference> references, std::span<std::string> values) final {
    get(ValueKind::binary, references, values);
  }
  void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) final {
    set(ValueKind::binary, references, values);
  }

 protected:
  using Destination = std::variant<std::span<double>, std::span<std::int64_t>, std::span<std::string>>;
  using Source = std::variant<std::span<const double>, std::span<const std::int64_t>, std::span<const std::string>>;

  virtual void get(ValueKind kind, std::span<const ValueReference> references, Destination values) = 0;
  virtual void set(ValueKind kind, std::span<const ValueReference> references, Source values) = 0;

  /// Calls the access function of the wrapped slave for `kind`.
  void pass_get(ValueKind kind, std::span<const ValueReference> references, Destination values);
  void pass_set(ValueKind kind, std::span<const ValueReference> references, Source values);
};

}  // namespace mebots::master
