// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/document.hpp"
#include "scene/sensor_data.hpp"

/// Readers for sections of a drone's file that describe sensors. Each reader reports errors to the document.
namespace mebots::world::scene {

RangeData read_range(const data::Node& node);
FlowData read_flow(const data::Node& node);
MultirangerData read_multiranger(const data::Node& node);
BarometerData read_barometer(const data::Node& node);
MagnetometerData read_magnetometer(const data::Node& node);

}  // namespace mebots::world::scene
