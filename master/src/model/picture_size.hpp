// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

/// The width or height of the pictures in an OSMP binary. An Integer parameter of the FMU contains it. For the output
/// `x.frame`, these parameters are `x.width` and `x.height`. For an input `x.frame`, they are `x.frame_width` and
/// `x.frame_height`.
struct PictureSide {
  std::string parameter;  // name of the parameter, such as `soc.camera.frame_width`
  std::int32_t pixels = 0;
};

/// Returns the width of the pictures in `frame`; nullopt if the FMU has no parameter for the width.
std::optional<PictureSide> picture_width(const ResolvedSystem& system, const VariableName& frame);

/// Throws InputError if both ends of a connection declare a picture size and the sizes differ. The size 0 is equal to
/// every size.
void check_picture_sizes(const ResolvedSystem& system, const ConnectionDescription& connection);

}  // namespace mebots::master
