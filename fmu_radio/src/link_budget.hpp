// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_radio/variables.hpp"

#include <cstdint>

/// Computes received power, loss of packets, and time on the air.
///
///     P_r = P_t (c / (4 pi f 1 m))^2 (d / 1 m)^-n            Friis 1946, and log-distance path loss (Rappaport)
///     BER = exp(-s / 2) / 2                                  binary FSK, not coherent (Proakis)
///     PER = 1 - (1 - BER)^bits
///
/// s is the ratio of signal to noise. The noise is computed from the sensitivity of the data sheet, at which BER is
/// 1e-3.
namespace mebots::radio {

/// Minimum distance in the formula of the received power, which is only valid in the far field.
inline constexpr double kLeastDistance_m = 0.1;

double received_power_w(const Parameters& parameters, double distance_m);

/// Returns the probability that at least one of a packet's `bits` is wrong, or that the packet is lost for other
/// reasons (packet.loss).
double loss_probability(const Parameters& parameters, double power_w, std::int32_t bits);

std::int32_t bits_of(const Parameters& parameters, std::int32_t size);

/// Returns the time on the air of a packet with `size` bytes: bits / rate.
std::int64_t airtime_ns(const Parameters& parameters, std::int32_t size);

std::int64_t nanoseconds(double time_s);

}  // namespace mebots::radio
