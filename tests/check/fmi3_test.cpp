// SPDX-License-Identifier: Apache-2.0
// Tests `mebots check` on FMUs of FMI 3.0: correct ones, and one mistake at a time.
#include "check_fmu.hpp"
#include "checks.hpp"
#include "fmi3_description.hpp"
#include "support.hpp"
#include "trace_number.hpp"

#include "mebots/error.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace mebots::check {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kDescription = R"xml(<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="sound" instantiationToken="{culprit3:none}">
  <CoSimulation modelIdentifier="culprit3" canGetAndSetFMUState="true" canSerializeFMUState="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>
  <TypeDefinitions>
    <EnumerationType name="Mode"><Item name="off" value="0"/><Item name="on" value="1"/></EnumerationType>
    <Float64Type name="Length" unit="m"/>
  </TypeDefinitions>
  <LogCategories><Category name="logStatusError"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="1" stepSize="0.1"/>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <UInt64 name="n" valueReference="1" causality="structuralParameter" variability="fixed" start="2"/>
    <Float64 name="u" valueReference="2" causality="input" start="1 2" unit="m" min="0" max="9"><Dimension valueReference="1"/></Float64>
    <Enumeration name="mode" valueReference="3" declaredType="Mode" causality="input" start="1"/>
    <String name="label" valueReference="4" causality="parameter" variability="fixed"><Start value="a"/></String>
    <Float64 name="y" valueReference="5" causality="output" declaredType="Length"><Alias name="y2"/></Float64>
    <Float64 name="der(y)" valueReference="6" causality="local" derivative="5"/>
    <Clock name="tick" valueReference="7" causality="input" intervalVariability="fixed" intervalDecimal="0.1"/>
    <Int32 name="count" valueReference="8" causality="local" clocks="7" initial="exact" start="0"/>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="5" dependencies="2 3" dependenciesKind="dependent fixed"/>
    <InitialUnknown valueReference="5" dependencies=""/>
  </ModelStructure>
</fmiModelDescription>
)xml";

std::string replaced(const std::string& piece, const std::string& other) {
  std::string text = kDescription;
  const auto at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return text.replace(at, piece.size(), other);
}

/// Returns the findings of all checks of the description.
std::vector<std::string> of_text(const std::string& text) {
  Report report;
  const auto add = [&]() -> Check& { return report.checks.emplace_back(); };
  check_schema(text, add());
  const Fmi3Description description(text);
  for (auto* const check : {&check_fmi3_head, &check_fmi3_names, &check_fmi3_kinds, &check_fmi3_types,
                            &check_fmi3_arrays, &check_fmi3_clocks, &check_fmi3_structure})
    check(description, add());
  return findings(report);
}

TEST(CheckFmi3, ASoundDescriptionPasses) {
  EXPECT_THAT(of_text(kDescription), IsEmpty());
}

TEST(CheckFmi3, EachMistakeOfADescriptionIsNamed) {
  const auto expect = [](const std::string& piece, const std::string& other, const char* text) {
    EXPECT_THAT(of_text(replaced(piece, other)), Contains(HasSubstr(text))) << piece << " -> " << other;
  };
  // These changes break the grammar of FMI 3.0 for attributes and names.
  expect("instantiationToken=", "guid=", "line 2, <fmiModelDescription>: there is no attribute guid in FMI 3.0");
  expect("fmiVersion=\"3.0\"", "fmiVersion=\"3.x\"", "fmiVersion is \"3.x\"");
  expect("canGetAndSetFMUState", "canGetAndSetFMUstate", "there is no attribute canGetAndSetFMUstate");
  expect("start=\"2\"/>", "start=\"-2\"/>", "start is \"-2\"");
  expect("start=\"1 2\"", "start=\"1,2\"", "start is \"1,2\"");
  expect("variability=\"fixed\" start=\"2\"", "variability=\"fixed\" start=\"two\"", "start is \"two\"");
  expect("variability=\"fixed\" start=\"2\"", "variability=\"fixed\" start=\"99999999999999999999\"",
         "start is \"99999999999999999999\"");
  expect("<Output valueReference=\"5\"", "<Outputs valueReference=\"5\"", "has no such child in FMI 3.0");
  expect("<Int32 name=\"count\"", "<Real name=\"r\" valueReference=\"9\"/><Int32 name=\"count\"", "line 20, <Real>");
  expect("causality=\"structuralParameter\"", "causality=\"structural\"", "causality is \"structural\"");
  // These changes follow the grammar, but their meaning is wrong.
  expect("modelIdentifier=\"culprit3\"", "modelIdentifier=\"3x\"", "\"3x\" is not a C identifier");
  expect("canGetAndSetFMUState=\"true\" ", "", "canSerializeFMUState without canGetAndSetFMUState");
  expect("stopTime=\"1\"", "stopTime=\"-1\"", "stopTime -1 is before startTime 0");
  expect("name=\"y2\"", "name=\"u\"", "the name u is already taken");
  expect("valueReference=\"8\"", "valueReference=\"4\"", "the value reference 4 is also that of another variable");
  expect("causality=\"independent\"", "causality=\"local\"", "there are 0 independent variables");
  expect("causality=\"parameter\" variability=\"fixed\"", "causality=\"parameter\" variability=\"discrete\"",
         "causality parameter cannot have variability discrete");
  expect(" declaredType=\"Length\"", " declaredType=\"Length\" start=\"1\"",
         "has a start value, which the FMU computes");
  expect("<Start value=\"a\"/>", "", "label has no start value");
  expect("declaredType=\"Mode\"", "declaredType=\"Length\"", "Length is a <Float64Type>");
  expect("unit=\"m\" min", "unit=\"km\" min", "the unit km is not defined");
  expect("start=\"1 2\"", "start=\"1 20\"", "u: start 20 is above max 9");
  expect("causality=\"input\" start=\"1\"", "causality=\"input\" start=\"7\"", "start 7 is not an item of Mode");
  expect("start=\"1 2\"", "start=\"1 2 3\"", "u has 3 start values for 2 elements");
  expect("<Dimension valueReference=\"1\"/>", "<Dimension valueReference=\"3\"/>",
         "not a structural parameter or constant");
  expect("<Dimension valueReference=\"1\"/>", "<Dimension/>", "needs either start or valueReference");
  expect(" intervalDecimal=\"0.1\"", "", "intervalVariability fixed has no interval");
  expect("intervalDecimal=\"0.1\"", "intervalDecimal=\"-1\"", "its interval is -1 s");
  expect("clocks=\"7\"", "clocks=\"2\"", "count: clocks has u, which is not a clock");
  expect("<Output valueReference=\"5\"", "<Output valueReference=\"2\"", "y: it is missing as <Output>");
  expect("<InitialUnknown valueReference=\"5\" dependencies=\"\"/>", "", "y: it is missing as <InitialUnknown>");
  expect("dependencies=\"2 3\"", "dependencies=\"2 99\"", "it depends on 99, which is not a variable");
  expect("\"dependent fixed\"", "\"dependent\"", "1 kinds for 2 dependencies");
}

/// A folder with the files of an unpacked FMU.
class Fmi3FolderTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    std::ofstream(folder_.path() / name) << text;
  }
  template <typename Check>
  std::vector<std::string> found(const Check& check) {
    Report report;
    check(report.checks.emplace_back());
    return findings(report);
  }
  std::vector<std::string> terminals(const std::string& inside) {
    write("terminalsAndIcons/terminalsAndIcons.xml",
          "<fmiTerminalsAndIcons fmiVersion=\"3.0\">" + inside + "</fmiTerminalsAndIcons>");
    return found([&](Findings findings) { check_fmi3_terminals(description_, folder_.path(), findings); });
  }

  modeldesc::TemporaryFolder folder_{"fmi3-check"};
  Fmi3Description description_{kDescription};
};

TEST_F(Fmi3FolderTest, TerminalsNameVariablesAndMembersOnce) {
  const auto terminal = [](const std::string& members) {
    return "<Terminals><Terminal name=\"t\" matchingRule=\"bus\">" + members + "</Terminal></Terminals>";
  };
  const std::string u = "<TerminalMemberVariable variableName=\"u\" memberName=\"a\" variableKind=\"signal\"/>";
  EXPECT_THAT(terminals(terminal(u)), IsEmpty());
  EXPECT_THAT(terminals(terminal(u + u)), Contains(HasSubstr("two members are named a")));
  EXPECT_THAT(
      terminals(terminal("<TerminalMemberVariable variableName=\"w\" memberName=\"a\" variableKind=\"signal\"/>")),
      Contains(HasSubstr("terminal t: w is not a variable")));
  EXPECT_THAT(terminals("<Terminals/>"), Contains(HasSubstr("contains no <Terminal>")));
  EXPECT_THAT(
      terminals("<GraphicalRepresentation><Icon x1=\"0\" y1=\"0\" x2=\"1\" y2=\"1\"/></GraphicalRepresentation>"),
      Contains(HasSubstr("icon.png is missing")));
}

TEST_F(Fmi3FolderTest, ManifestsOfLayeredStandardsAreLookedAt) {
  const auto extra = [&] { return found([&](Findings findings) { check_extra(folder_.path(), findings); }); };
  write(
      "extra/org.example.ls/fmi-ls-manifest.xml",
      "<x xmlns:ls=\"urn:ls\" ls:fmi-ls-name=\"org.example.ls\" ls:fmi-ls-version=\"1\" ls:fmi-ls-description=\"d\"/>");
  EXPECT_THAT(extra(), IsEmpty());
  write("extra/org.example.ls/fmi-ls-manifest.xml", "<x fmi-ls-name=\"n\"/>");
  EXPECT_THAT(extra(), Contains(HasSubstr("the attribute fmi-ls-version is missing")));
  write("extra/org.example.ls/fmi-ls-manifest.xml", "<x");
  EXPECT_THAT(extra(), Contains(HasSubstr("fmi-ls-manifest.xml")));
  write("extra/mine/file.txt", "");
  EXPECT_THAT(extra(), Contains(HasSubstr("extra/mine is not named after a reversed domain")));
}

TEST_F(Fmi3FolderTest, PlatformsHaveTheNamesOfFmi3) {
  write("binaries/linux64/culprit3.so", "");
  write("binaries/aarch64-darwin/other.dylib", "");
  const auto platforms =
      found([&](Findings findings) { check_fmi3_platforms(description_, folder_.path(), findings); });
  EXPECT_THAT(platforms, Contains(HasSubstr("binaries/linux64 is not a platform that FMI 3.0 names")));
  EXPECT_THAT(platforms, Contains(HasSubstr("binaries/aarch64-darwin contains no culprit3.dylib")));
  EXPECT_THAT(platforms, Contains(HasSubstr("no binary for x86-64 Linux (binaries/x86_64-linux/culprit3.so)")));
}

constexpr const char* kManifest = R"(<fmiReferences xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"
    fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref" fmi-ls:fmi-ls-version="1.0.0" fmi-ls:fmi-ls-description="traces">
  <Related type="text/csv" source="it_out.csv" role="result"/>
</fmiReferences>
)";

/// Returns the findings about culprit3.cpp with this fault and more files, for co-simulation and model exchange.
std::vector<std::string> culprit3(const std::string& crime,
                                  std::vector<std::pair<std::string, std::string>> files = {}) {
  const auto description = fmt::format(R"xml(<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="culprit3" instantiationToken="{{culprit3:{}}}">
  <ModelExchange modelIdentifier="culprit3" canGetAndSetFMUState="true"/>
  <CoSimulation modelIdentifier="culprit3" canGetAndSetFMUState="true" canSerializeFMUState="true"/>
  <DefaultExperiment startTime="0" stopTime="1" stepSize="0.05"/>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="y" valueReference="1" causality="output"/>
    <Float64 name="der(y)" valueReference="2" derivative="1"/>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="1"/>
    <ContinuousStateDerivative valueReference="2"/>
    <InitialUnknown valueReference="1"/>
    <InitialUnknown valueReference="2"/>
  </ModelStructure>
</fmiModelDescription>
)xml",
                                       crime);
  Workshop workshop;
  files.emplace_back("modelDescription.xml", description);
  files.emplace_back("binaries/x86_64-linux/culprit3.so", text_of(CULPRIT3_LIBRARY));
  return findings(workshop.archive(files), true);
}

TEST(CheckFmi3, EachCrimeOfALibraryIsNamed) {
  EXPECT_THAT(culprit3("none"), IsEmpty());
  EXPECT_THAT(culprit3("refuses"), Contains(HasSubstr("no instance was created: no licence")));
  EXPECT_THAT(culprit3("crashes"), Contains(HasSubstr("fmi3DoStep")));
  EXPECT_THAT(culprit3("infinite"), Contains(HasSubstr("y is inf after step 1")));
  EXPECT_THAT(culprit3("early"), Contains(HasSubstr("returned early, though earlyReturnAllowed was false")));
  EXPECT_THAT(culprit3("past"), Contains(HasSubstr("lastSuccessfulTime is -0.05 s after a step to 0.05 s")));
  EXPECT_THAT(culprit3("shared"), Contains(HasSubstr("next to another instance: y has other bits")));
  EXPECT_THAT(culprit3("keeps"), Contains(HasSubstr("after fmi3Reset: y has other bits")));
  EXPECT_THAT(culprit3("forgets"), Contains(HasSubstr("after fmi3SetFMUState: y has other bits")));
  EXPECT_THAT(culprit3("truncates"), Contains(HasSubstr("after fmi3SetFMUState: y has other bits")));
  EXPECT_THAT(culprit3("divides"), Contains(HasSubstr("the derivative of the state y is nan at step 0")));
  EXPECT_THAT(culprit3("endless"),
              Contains(HasSubstr("fmi3UpdateDiscreteStates requests another update after 1000 updates")));
}

TEST(CheckFmi3, ReferenceTracesAreReplayed) {
  // culprit3 integrates 1 + y^2 by Euler's method with the step of the trace: y is 0, 1, 3.
  const auto with_trace = [](const std::string& folder, const std::string& out,
                             const std::string& in = "time,y\n0,0\n") {
    return culprit3("none", {{folder + "it_out.csv", out},
                             {folder + "it_in.csv", in},
                             {"extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml", kManifest}});
  };
  const std::string own = "documentation/reference/";
  const std::string layered = "extra/org.fmi-standard.fmi-ls-ref/";
  for (const auto& folder : {own, layered}) {
    EXPECT_THAT(with_trace(folder, "time,y,text\n0,0,a\n1,1,b\n2,3,c\n"), IsEmpty()) << folder;
    EXPECT_THAT(with_trace(folder, "time,y\n0,0\n1,1\n2,3.1\n"),
                Contains(HasSubstr("it_out.csv: first divergence at 2 s: y is 3, the trace has 3.1")))
        << folder;
    EXPECT_THAT(with_trace(folder, "time,y\n0,0 0\n1,1 1\n"), Contains(HasSubstr("y is 0, the trace has 0 0")));
    EXPECT_THAT(with_trace(folder, "time,y\n0,0\n1,one\n"), Contains(HasSubstr("this is not a number")));
    EXPECT_THAT(with_trace(folder, "time,y\n0,1\n", "time,y.x\n0,0\n"), IsEmpty())
        << "skipped: inputs of another version";
    EXPECT_THAT(with_trace(folder, "time,y\n0,0\n", "\n"), Contains(HasSubstr("there is no header"))) << folder;
    EXPECT_THAT(with_trace(folder, "time,y\n0,0\n", "time;y\n0;0\n"), Contains(HasSubstr("it_in.csv"))) << folder;
    EXPECT_THAT(with_trace(folder, "time;y\n0;0\n"), Contains(HasSubstr("it_out.csv"))) << folder;
  }
}

/// Returns the check of reference traces in bank.fmu, which has arrays of several types.
Check check_of_bank(const std::string& in, const std::string& out) {
  const modeldesc::TemporaryFolder folder("bank");
  modeldesc::unpack(MEBOTS_BINARY_DIR "/test_fmus/bank.fmu", folder.path());
  std::vector<std::pair<std::string, std::string>> files{{"documentation/reference/it_in.csv", in},
                                                         {"documentation/reference/it_out.csv", out}};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
    if (entry.is_regular_file())
      files.emplace_back(entry.path().lexically_relative(folder.path()).string(), text_of(entry.path()));
  }
  Workshop workshop;
  auto report = check_fmu(workshop.archive(files), {});
  const auto found = std::ranges::find_if(
      report.checks, [](const Check& check) { return check.name.starts_with("reference traces are reproduced"); });
  return found == report.checks.end() ? Check{} : *found;
}

std::vector<std::string> texts_of(const Check& check) {
  std::vector<std::string> texts;
  for (const auto& finding : check.findings) texts.push_back(finding.text);
  return texts;
}

TEST(CheckFmi3, ReferenceTracesHaveArraysOfAllTypes) {
  // bank.fmu integrates the inputs, from the start values 0 and 10. The mode 0 holds an output.
  const std::string in = "time,line.u,line.mode\n0,1 2,1 0\n";
  const std::string out = "time,line.y,line.moving,far.bytes\n0,0 10,true true,0\n0.5,0.5 10,1 1,0\n";
  const auto good = check_of_bank(in, out);
  EXPECT_EQ(good.name, "reference traces are reproduced");
  EXPECT_EQ(good.skipped, "");
  EXPECT_THAT(texts_of(good), IsEmpty());
  EXPECT_THAT(texts_of(check_of_bank(in, out + "1,1 10,true false,0\n")),
              Contains(HasSubstr("at 1 s: line.moving is 1 1, the trace has 1 0")));
  EXPECT_THAT(texts_of(check_of_bank(in, out + "1,1 10,true true,3\n")),
              Contains(HasSubstr("at 1 s: far.bytes is 0, the trace has 3")));
  EXPECT_THAT(texts_of(check_of_bank("time,line.mode\n0,0.5 1\n", out)),
              Contains(HasSubstr("the trace has 0.5 for the Enumeration line.mode")));
}

TEST(CheckFmi3, ReferenceTracesSayHowManyColumnsAreCompared) {
  const std::string in = "time,line.u\n0,0 0\n";
  EXPECT_EQ(check_of_bank(in, "time,line[1].y,line.y\n0,0,0 10\n").name,
            "reference traces are reproduced, in 1 of 2 columns");
  EXPECT_EQ(check_of_bank(in, "time,line[1].y\n0,0\n").skipped, "it_out.csv has no column with numbers of this FMU");
}

TEST(CheckFmi3, ReferenceTracesHaveNumbersThatTheirTypesHold) {
  EXPECT_EQ(converted<std::uint8_t>(255, "UInt8 x"), 255);
  EXPECT_EQ(converted<std::int64_t>(-9223372036854775808.0, "Int64 x"), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(converted<float>(0.1, "Float32 x"), 0.1F);
  EXPECT_TRUE(converted<bool>(1, "Boolean x"));
  EXPECT_THROW(converted<std::uint8_t>(256, "UInt8 x"), Error);
  EXPECT_THROW(converted<std::uint32_t>(-1, "UInt32 x"), Error);
  EXPECT_THROW(converted<std::int32_t>(1.5, "Int32 x"), Error);
  EXPECT_THROW(converted<std::int64_t>(9223372036854775808.0, "Int64 x"), Error);
  EXPECT_THROW(converted<float>(1e300, "Float32 x"), Error);
  EXPECT_THROW(converted<bool>(2, "Boolean x"), Error);
}

TEST(CheckFmi3, OurOwnFmusAreCleanAndAreRun) {
  for (const char* const fmu : {"bank", "lag_fmi3"}) {
    const auto archive = fmt::format(MEBOTS_BINARY_DIR "/test_fmus/{}.fmu", fmu);
    EXPECT_THAT(findings(archive, true), IsEmpty()) << fmu;
  }
}

}  // namespace
}  // namespace mebots::check
