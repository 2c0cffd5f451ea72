// SPDX-License-Identifier: Apache-2.0
#include "curve.hpp"

#include "mebots/data_file.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::battery {

Curve Curve::analytic(double factor, double rate, std::vector<double> polynomial) {
  if (polynomial.size() > 4) throw Error("a curve's polynomial has at most 4 coefficients");
  Curve curve;
  curve.factor_ = factor;
  curve.rate_ = rate;
  std::copy(polynomial.begin(), polynomial.end(), curve.polynomial_);
  return curve;
}

Curve Curve::read(const data::Node& parent, std::string_view key, std::string_view unit) {
  const data::Node node = parent.object(key);
  node.only({"unit", "source", "exponential", "polynomial", "state_of_charge", "value"});
  node.require_unit(unit);
  if (!node.has("state_of_charge")) {
    const auto exponential = node.numbers("exponential");
    if (exponential.size() != 2) node.fail("exponential", "must hold two numbers: factor and rate");
    const auto polynomial = node.numbers("polynomial");
    if (polynomial.size() > 4) node.fail("polynomial", "must hold at most 4 coefficients");
    return analytic(exponential[0], exponential[1], polynomial);
  }
  Curve curve;
  curve.table_s_ = node.rising_numbers("state_of_charge", data::Limits::between(0, 1));
  curve.table_value_ = node.numbers("value");
  if (curve.table_s_.front() != 0) node.fail("state_of_charge", "must begin at 0");
  if (curve.table_s_.back() != 1) node.fail("state_of_charge", "must end at 1");
  if (curve.table_value_.size() != curve.table_s_.size()) {
    node.fail("value", fmt::format("has {} entries but state_of_charge has {}", curve.table_value_.size(),
                                   curve.table_s_.size()));
  }
  return curve;
}

double Curve::operator()(double s) const {
  if (table_s_.empty()) {
    const double polynomial = polynomial_[0] + s * (polynomial_[1] + s * (polynomial_[2] + s * polynomial_[3]));
    return factor_ == 0 ? polynomial : factor_ * std::exp(-rate_ * s) + polynomial;
  }
  const auto last_segment = table_s_.size() - 2;
  const auto above = std::upper_bound(table_s_.begin(), table_s_.end(), s);
  const auto index = static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - table_s_.begin() - 1, 0));
  const auto i = std::min(index, last_segment);
  const double weight = (s - table_s_[i]) / (table_s_[i + 1] - table_s_[i]);
  return table_value_[i] + weight * (table_value_[i + 1] - table_value_[i]);
}

Curve Curve::scaled(double factor) const {
  Curve curve = *this;
  curve.factor_ *= factor;
  for (double& coefficient : curve.polynomial_) coefficient *= factor;
  for (double& value : curve.table_value_) value *= factor;
  return curve;
}

}  // namespace mebots::battery
