// SPDX-License-Identifier: Apache-2.0
#include "observe/profile.hpp"

#include "observe/profile_formats.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <filesystem>

namespace mebots::soc::observe {
namespace {

bool wants_callgrind(const std::string& option, const std::string& path) {
  const auto ending = std::filesystem::path(path).extension();
  if (ending == ".json") return false;
  if (ending == ".callgrind" || ending == ".out") return true;
  throw Error(fmt::format(
      "{} {}: the name must end in .json (for speedscope) or in .callgrind or .out (for KCachegrind)", option, path));
}

}  // namespace

Profile::Profile(const std::string& option, const std::string& path, const Soc& soc)
    : soc_(soc),
      functions_(soc.program()),
      windows_(soc.now(), soc.harts()),
      callgrind_(wants_callgrind(option, path)),
      file_(option, path) {
  for (unsigned number = 0; number < soc.harts(); ++number) harts_.emplace_back(soc, number, functions_);
}

void Profile::restored() {
  windows_.restart(soc_.now(), harts_);
  for (auto& hart : harts_) hart.restored();
}

void Profile::stepped() {
  for (auto& hart : harts_) hart.settle();
  windows_.stepped(soc_.now(), harts_);
}

void Profile::finish() {
  std::vector<HartTree> trees;
  for (auto& hart : harts_) hart.finish();
  windows_.stepped(soc_.now(), harts_);
  windows_.restart(soc_.now(), harts_);
  for (auto& hart : harts_) {
    const auto number = hart.number();
    if (number == kFabricControllerHart) {
      trees.push_back({number, "", &hart.tree()});
    } else if (hart.total().instructions != 0) {
      trees.push_back({number, fmt::format("cluster core {}", core_of_hart(number)), &hart.tree()});
    }
  }
  if (callgrind_) {
    write_callgrind(trees, functions_, soc_.program().origin(), file_);
  } else {
    write_speedscope(trees, functions_, windows_.windows(), soc_.program().origin(), file_);
  }
  file_.close();
}

}  // namespace mebots::soc::observe
