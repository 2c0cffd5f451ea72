// SPDX-License-Identifier: Apache-2.0
#include "curve.hpp"

#include "mebots/assert.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::battery {
namespace {

constexpr std::size_t kCoefficients = 4;

}  // namespace

Curve Curve::analytic(double factor, double rate, std::vector<double> polynomial) {
  if (polynomial.size() > kCoefficients) throw Error("a curve's polynomial has at most 4 coefficients");
  Curve curve;
  curve.factor_ = factor;
  curve.rate_ = rate;
  std::copy(polynomial.begin(), polynomial.end(), curve.polynomial_);
  return curve;
}

Curve Curve::read(const data::Node& node, std::string_view unit) {
  data::Object object(node);
  data::read_unit(object, unit);
  object.comment("source");
  object.comment("fitted_on");
  std::vector<double> exponential;
  std::vector<double> polynomial;
  Curve curve;
  if (object.has("state_of_charge")) {
    object.read("state_of_charge", curve.table_s_, data::rising_numbers(data::Limits::between(0, 1)));
    object.read("value", curve.table_value_, data::numbers());
    object.allow({"exponential", "polynomial"});
  } else {
    object.read("exponential", exponential, data::numbers());
    object.read("polynomial", polynomial, data::numbers());
    object.allow({"state_of_charge", "value"});
  }
  object.finish();
  if (!object.sound()) return curve;
  if (curve.table_s_.empty()) {
    if (exponential.size() != 2)
      node.at("exponential").fail(ErrorCode::invalid_value, "two numbers are needed: factor and rate");
    if (polynomial.size() > kCoefficients)
      node.at("polynomial").fail(ErrorCode::invalid_value, "at most 4 coefficients are allowed");
    return analytic(exponential[0], exponential[1], polynomial);
  }
  const auto table = node.at("state_of_charge");
  if (curve.table_s_.front() != 0) table.complain(ErrorCode::invalid_value, "the table must begin at 0");
  if (curve.table_s_.back() != 1) table.complain(ErrorCode::invalid_value, "the table must end at 1");
  if (curve.table_value_.size() != curve.table_s_.size()) {
    node.at("value").fail(ErrorCode::invalid_value, fmt::format("there are {} entries here, but {} in state_of_charge",
                                                                curve.table_value_.size(), curve.table_s_.size()));
  }
  return curve;
}

double Curve::operator()(double s) const {
  if (table_s_.empty()) {
    const double polynomial = polynomial_[0] + s * (polynomial_[1] + s * (polynomial_[2] + s * polynomial_[3]));
    return factor_ == 0 ? polynomial : factor_ * std::exp(-rate_ * s) + polynomial;
  }
  const auto last_segment = table_s_.size() - 2;
  MEBOTS_ASSERT(table_s_.size() >= 2 && table_value_.size() == table_s_.size(), "read() refuses other tables");
  const auto above = std::upper_bound(table_s_.begin(), table_s_.end(), s);
  const auto index = static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - table_s_.begin() - 1, 0));
  const auto i = std::min(index, last_segment);
  const double weight = (s - table_s_[i]) / (table_s_[i + 1] - table_s_[i]);
  MEBOTS_ASSERT(table_s_[i + 1] > table_s_[i]);
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
