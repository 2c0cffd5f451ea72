// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

/// The width or height of the pictures in an OSMP binary. The bytes of a picture do not contain its size. Therefore
/// Integer parameters declare it. For `x.frame`, these are `x.width` and `x.height` at the source, `x.frame_width` and
/// `x.frame_height` at the reader.
struct PictureSide {
  std::string parameter;  // name of the parameter, such as `soc.camera.frame_width`
  std::int32_t pixels = 0;
};

/// Returns the width of the pictures in `frame`. Returns nullopt if the FMU does not declare the width.
std::optional<PictureSide> picture_width(const ResolvedSystem& system, const VariableName& frame);

/// Throws InputError if both ends of a connection declare a picture size and these sizes differ. The size 0 matches
/// every size.
void check_picture_sizes(const ResolvedSystem& system, const ConnectionDescription& connection);

}  // namespace mebots::master
