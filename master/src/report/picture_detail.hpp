// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/result_table.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace mebots::master::report {

/// A picture that a run kept.
struct Picture {
  double time_s = 0;
  std::string png;      ///< the file's bytes
  unsigned shrunk = 1;  ///< so many pixels of the file, in both directions, are one here
};

/// The pictures of one camera, in the order of time.
struct PictureSeries {
  std::string name;  ///< "world.camera.frame"
  std::vector<Picture> pictures;
  std::size_t every = 1;  ///< one in so many is here
};

/// Bytes of pictures that a page holds at most, so that it stays one that people send to each other.
inline constexpr std::size_t kMostPictureBytes = 1'500'000;

/// Makes the pictures fit into a page: first smaller, by means of 2 x 2 pixels, but not under 128 pixels of width;
/// then fewer, evenly in time. Those within the spans `whole` stay as they are. A file that is not a PNG of grey pixels
/// is not made smaller.
void fit_into_page(PictureSeries& series, const std::vector<TimeSpan>& whole);

}  // namespace mebots::master::report
