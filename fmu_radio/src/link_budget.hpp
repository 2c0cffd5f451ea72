// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_radio/variables.hpp"

#include <cstdint>

/// Computes the received power from the distance, the loss of packets from the received power, and the time on the air
/// from the number of bytes.
///
///     P_r = P_t (c / (4 pi f 1 m))^2 (d / 1 m)^-n            Friis 1946, and log-distance path loss (Rappaport)
///     BER = exp(-s / 2) / 2                                  binary FSK, not coherent (Proakis)
///     PER = 1 - (1 - BER)^bits
///
/// s is the ratio of signal to noise. The noise follows from the data sheet, because BER is 1e-3 at the sensitivity.
namespace mebots::radio {

/// Minimum distance in the formula of the received power; smaller distances are replaced by it. The formula is only
/// valid in the far field.
inline constexpr double kLeastDistance_m = 0.1;

double received_power_w(const Parameters& parameters, double distance_m);

/// Returns the probability that a packet is lost. A packet is lost if at least one of its `bits` is wrong, or for other
/// reasons with the probability packet.loss.
double loss_probability(const Parameters& parameters, double power_w, std::int32_t bits);

/// Returns the number of bits of a packet with `size` bytes.
std::int32_t bits_of(const Parameters& parameters, std::int32_t size);

/// Returns the time on the air of a packet with `size` bytes: bits / rate, rounded to nanoseconds.
std::int64_t airtime_ns(const Parameters& parameters, std::int32_t size);

/// Converts a time in seconds to nanoseconds, with rounding.
std::int64_t nanoseconds(double time_s);

}  // namespace mebots::radio
