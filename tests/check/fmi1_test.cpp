// SPDX-License-Identifier: Apache-2.0
// Tests `mebots check` on FMUs of FMI 1.0: a correct one (tests/fmus/tank1.c), and one mistake at a time.
#include "support.hpp"

#include "mebots/modeldesc/archive.hpp"
#include "mebots/text_file.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace mebots::check {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Replaces `part` of the tank's description by `text`. Returns the findings of a check that also runs the tank.
std::vector<std::string> of_changed_tank(const std::string& part, const std::string& text,
                                         Level level = Level::standard) {
  const modeldesc::TemporaryFolder folder("mebots-check-test");
  modeldesc::unpack(TANK1_FMU, folder.path());
  const auto description = folder.path() / "modelDescription.xml";
  auto xml = text_of(description);
  const auto at = xml.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  xml.replace(at, part.size(), text);
  std::ofstream(description) << xml;
  const auto archive = folder.path() / "changed.fmu";
  modeldesc::pack(archive, {{"modelDescription.xml", description},
                            {"binaries/linux64/tank1.so", folder.path() / "binaries/linux64/tank1.so"}});
  return findings(archive, true, 30, level);
}

TEST(CheckFmi1, FindsNothingInASoundFmu) {
  EXPECT_THAT(findings(TANK1_FMU, true, 30, Level::standard), IsEmpty());
}

TEST(CheckFmi1, AppliesTheGrammarOfFmi1) {
  EXPECT_THAT(of_changed_tank(R"(modelIdentifier="tank1")", R"(modelIdentifier="tank1" license="none")"),
              ElementsAre(HasSubstr("there is no attribute license in FMI 1.0")));
  EXPECT_THAT(of_changed_tank(R"(causality="input")", R"(causality="parameter")"), Contains(HasSubstr("causality")));
  EXPECT_THAT(of_changed_tank("<DirectDependency/>", "<Annotations/>"), Contains(HasSubstr("Annotations")));
}

TEST(CheckFmi1, ReportsFaultyVariables) {
  EXPECT_THAT(of_changed_tank(R"(name="rate")", R"(name="level")"),
              Contains(HasSubstr("an earlier variable also has the name \"level\"")));
  EXPECT_THAT(of_changed_tank("<Name>inflow</Name>", "<Name>flow</Name>"),
              ElementsAre(HasSubstr("\"flow\", which is not a variable")));
  EXPECT_THAT(of_changed_tank(R"(<Real start="0.25"/>)", "<Real/>", Level::pedantic),
              Contains(HasSubstr("\"initial_level\" has no start value, although it is an input")));
}

TEST(CheckFmi1, RunsTheFmu) {
  EXPECT_THAT(of_changed_tank(R"(guid="{tank}")", R"(guid="{other}")"),
              ElementsAre(HasSubstr("fmiInstantiateSlave returned no instance")));
}

}  // namespace
}  // namespace mebots::check
