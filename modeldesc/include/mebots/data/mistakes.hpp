// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace mebots::data {

struct Mistake {
  ErrorCode code = ErrorCode::unspecified;
  std::string place;       // file, line, column and JSON pointer: "cell.json:12:5: /mass/value"
  std::string text;        // the problem and its remedy
  std::size_t offset = 0;  // byte offset in the file
};

/// Contains all errors of a file, in the order of their places in the file. what() has one line for each of the first
/// 20 errors. code() is the code of the first error.
class Mistakes : public Error {
 public:
  /// `mistakes` must not be empty.
  explicit Mistakes(std::vector<Mistake> mistakes);

  const std::vector<Mistake>& list() const { return mistakes_; }

 private:
  std::vector<Mistake> mistakes_;
};

}  // namespace mebots::data
