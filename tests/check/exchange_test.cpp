// SPDX-License-Identifier: Apache-2.0
// Tests `mebots check` on an FMU for model exchange of FMI 2.0, tests/fmus/mass.c. The FMU's GUID selects its fault.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace mebots::check {
namespace {

using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

std::string whole_file(const char* path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Returns the findings about mass.c with this fault.
std::vector<std::string> mass_findings(const std::string& fault) {
  auto description = whole_file(MASS_DESCRIPTION);
  const std::string guid = "{mass}";
  description.replace(description.find(guid), guid.size(), fmt::format("{{mass:{}}}", fault));
  Workshop workshop;
  return findings(
      workshop.archive({{"modelDescription.xml", description}, {"binaries/linux64/mass.so", whole_file(MASS_LIBRARY)}}),
      true, 30, Level::standard);
}

TEST(CheckModelExchange, EachFaultIsNamed) {
  EXPECT_THAT(mass_findings("none"), Each(Not(HasSubstr("error"))));
  EXPECT_THAT(mass_findings("nan"), Contains(HasSubstr("the derivative of the state v is nan at step 0")));
  EXPECT_THAT(mass_findings("endless"),
              Contains(HasSubstr("fmi2NewDiscreteStates requests another update after 1000 updates")));
  EXPECT_THAT(mass_findings("forgets"),
              Contains(HasSubstr("after a restored state, the continuous states have other bits")));
}

TEST(CheckModelExchange, ATimeEventAfterTheSavedStateOccursAgain) {
  EXPECT_THAT(mass_findings("kicked"), Each(Not(HasSubstr("other bits"))));
}

}  // namespace
}  // namespace mebots::check
