// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

/// What an FMU says about the pictures of an OSMP binary: bytes alone say nothing of rows. Its Integer parameters
/// beside `x.frame` are `x.width` and `x.height` where pictures come from, `x.frame_width` and `x.frame_height` where
/// they go to.
struct PictureSide {
  std::string parameter;  // `soc.camera.frame_width`
  std::int32_t pixels = 0;
};

/// The width of the pictures that come out of `frame`; nothing where the FMU does not say it.
std::optional<PictureSide> picture_width(const ResolvedSystem& system, const VariableName& frame);

/// Throws InputError when both ends of a connection say the size of its pictures, and not the same. 0 is any.
void check_picture_sizes(const ResolvedSystem& system, const ConnectionDescription& connection);

}  // namespace mebots::master
