// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace mebots::data {

/// One thing that is wrong in a file.
struct Mistake {
  ErrorCode code = ErrorCode::unspecified;
  std::string place;       // "cell.json:12:5: /mass/value"
  std::string text;        // what is wrong, and what to do
  std::size_t offset = 0;  // bytes into the file
};

/// Everything that is wrong with a file, in the order of the file. Its text has a line for each mistake, the code is
/// that of the first.
class Mistakes : public Error {
 public:
  /// At least one.
  explicit Mistakes(std::vector<Mistake> mistakes);

  const std::vector<Mistake>& list() const { return mistakes_; }

 private:
  std::vector<Mistake> mistakes_;
};

}  // namespace mebots::data
