// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model.hpp"

#include <optional>
#include <string>

namespace mebots::master::ssp {

/// The change of a value along its way: factor * value + offset, or a map.
class Course {
 public:
  /// `unit`: of the value at the start; nothing where it has none. `difference`: of two values (relativeQuantity), so
  /// that a unit's offset falls out.
  explicit Course(std::optional<modeldesc::Unit> unit, bool difference = false)
      : unit_(std::move(unit)), difference_(difference) {}

  /// Appends a hop to a connector with this unit, or with none: converts units first, then transforms the value
  /// (SSP 2.0, 4.5.2.1). Throws InputError that names the transformation's place.
  void pass(const Transformation& transformation, const std::optional<modeldesc::Unit>& unit);

  double factor() const { return factor_; }
  double offset() const { return offset_; }
  const std::optional<ValueMap>& map() const { return map_; }
  const std::optional<modeldesc::Unit>& unit() const { return unit_; }
  bool converts_units() const { return converts_units_; }
  /// True if a conversion of units has an offset, as from Celsius to kelvin.
  bool shifts_units() const { return shifts_units_; }
  /// Returns the changed value. Throws InputError that begins with `name` if the value cannot be changed
  /// this way.
  Json apply(const Json& value, const std::string& name) const;

 private:
  void convert(const std::optional<modeldesc::Unit>& unit, const std::string& place);
  void transform(const Linear& linear, const std::string& place);
  void transform(const ValueMap& map, const std::string& place);
  void check_range(const std::string& place) const;

  std::optional<modeldesc::Unit> unit_;
  bool difference_;
  bool converts_units_ = false;
  bool shifts_units_ = false;
  double factor_ = 1;
  double offset_ = 0;
  std::optional<ValueMap> map_;
};

}  // namespace mebots::master::ssp
