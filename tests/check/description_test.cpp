// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"
#include "support.hpp"

#include <gmock/gmock.h>

namespace mebots::check {
namespace {

TEST(CheckModelStructure, IndicesWithoutAVariableAreFindings) {
  Workshop workshop;
  auto description = culprit_description("none");
  const std::string outputs = "<Unknown index=\"2\" dependencies=\"\"/>";
  description.replace(description.find(outputs), outputs.size(), "<Unknown index=\"2\" dependencies=\"0\"/>");
  EXPECT_THAT(findings(workshop.culprit_with(description), true, 30, Level::standard),
              testing::ElementsAre(testing::AllOf(testing::StartsWith("error: modelDescription.xml, line "),
                                                  testing::EndsWith("<Unknown>: \"0\" is not an index of a variable; "
                                                                    "they go from 1 to 3"))));
}

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class CheckDescription : public testing::Test {
 protected:
  /// Returns the findings about culprit.cpp's description with one piece of text replaced.
  std::vector<std::string> with(const std::string& piece, const std::string& other) {
    auto text = culprit_description("none");
    const auto at = text.find(piece);
    EXPECT_NE(at, std::string::npos) << piece;
    text.replace(at, piece.size(), other);
    Options files_only;
    files_only.run = false;
    return findings(check_fmu(workshop_.described(text), files_only));
  }
  /// Returns the findings for a description with one more variable, which has index 4.
  std::vector<std::string> and_variable(const std::string& element) {
    return with("</ModelVariables>", element + "</ModelVariables>");
  }

  Workshop workshop_;
};

TEST_F(CheckDescription, ASoundOneHasNoFindings) {
  EXPECT_THAT(with("culprit", "culprit"), IsEmpty());
}

TEST_F(CheckDescription, HeadAndCapabilities) {
  EXPECT_THAT(with("modelIdentifier=\"culprit\"", "modelIdentifier=\"my-model\""),
              Contains(HasSubstr("not a C identifier")));
  EXPECT_THAT(with("canGetAndSetFMUstate=\"true\" ", ""), Contains(HasSubstr("canSerializeFMUstate is true")));
  EXPECT_THAT(with("stopTime=\"2\"", "stopTime=\"-2\""), Contains(HasSubstr("stopTime -2 is not after startTime 0")));
  EXPECT_THAT(with("stepSize=\"0.1\"", "stepSize=\"0\""), Contains(HasSubstr("stepSize is 0")));
  EXPECT_THAT(with("<Category name=\"logStatusError\"/>", "<Category name=\"a\"/><Category name=\"a\"/>"),
              Contains(HasSubstr("log category \"a\" occurs twice")));
  EXPECT_THAT(with("canSerializeFMUstate=\"true\"/>",
                   "canSerializeFMUstate=\"true\"><SourceFiles><File name=\"a.c\"/></SourceFiles></CoSimulation>"),
              Contains(HasSubstr("SourceFiles names \"a.c\"")));
}

TEST_F(CheckDescription, CombinationsOfCausalityVariabilityInitialAndStart) {
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="p" valueReference="9" causality="parameter" variability="discrete"><Integer start="1"/></ScalarVariable>)"),
      Contains(HasSubstr("causality parameter cannot have variability discrete")));
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="p" valueReference="9" causality="parameter" variability="fixed" initial="calculated"><Real/></ScalarVariable>)"),
      Contains(HasSubstr("initial calculated is not compatible with causality parameter")));
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="p" valueReference="9" causality="parameter" variability="fixed"><Real/></ScalarVariable>)"),
      Contains(HasSubstr("\"p\" has no start value")));
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="i" valueReference="9" causality="input" initial="exact"><Real start="0"/></ScalarVariable>)"),
      Contains(HasSubstr("an input has no initial")));
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="l" valueReference="9" initial="calculated"><Real start="0"/></ScalarVariable>)"),
      Contains(HasSubstr("\"l\" has a start value")));
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="t" valueReference="9" causality="independent"><Real start="0"/></ScalarVariable>)"),
      Contains(HasSubstr("\"t\" has a start value")));
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="l" valueReference="9" initial="exact"><Real start="0" min="1"/></ScalarVariable>)"),
      Contains(HasSubstr("below its min 1")));
}

TEST_F(CheckDescription, UnitsAndTypes) {
  EXPECT_THAT(with("<Unit name=\"m\">", "<Unit name=\"km\">"), Contains(HasSubstr("the unit \"m\" is not defined")));
  EXPECT_THAT(with("unit=\"m\"", "unit=\"m\" displayUnit=\"mile\""),
              Contains(HasSubstr("the display unit \"mile\" is not defined")));
  EXPECT_THAT(with("<BaseUnit m=\"1\"/>", "<BaseUnit m=\"1\" factor=\"0\"/>"), Contains(HasSubstr("has the factor 0")));
  EXPECT_THAT(with("max=\"100\"", "max=\"100\" min=\"200\""), Contains(HasSubstr("min 200 is above max 100")));
  EXPECT_THAT(with("max=\"100\"", "nominal=\"0\""), Contains(HasSubstr("nominal is 0")));
}

TEST_F(CheckDescription, NamesFollowTheDeclaredConvention) {
  EXPECT_THAT(with("name=\"gain\"", "name=\"two words\""),
              Contains(HasSubstr("\"two words\" is not a structured name")));
  for (const char* name : {"a", "a.b.c", "a[1].b[2,3]", "der(x)", "der(a.b[1],2)", "'odd name!'.x", "_a1", "'it\\'s'"})
    EXPECT_TRUE(is_structured_name(name)) << name;
  for (const char* name : {"", "1a", "a..b", "a.", "a[", "a[x]", "der(x", "a b", "'open", "''", "a[1]b"})
    EXPECT_FALSE(is_structured_name(name)) << name;
}

TEST_F(CheckDescription, AliasesAgree) {
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="alias" valueReference="1" causality="local" initial="calculated"><Real unit="m"/></ScalarVariable>)"),
      IsEmpty());
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="alias" valueReference="1" causality="local" initial="calculated"><Real/></ScalarVariable>)"),
      Contains(HasSubstr("but not their unit")));
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="alias" valueReference="0" causality="input"><Real unit="m" start="1"/></ScalarVariable>)"),
      Contains(HasSubstr("more than one of them can be set")));
}

TEST_F(CheckDescription, StructureIsComplete) {
  EXPECT_THAT(with("<Outputs><Unknown index=\"2\" dependencies=\"\"/></Outputs>", ""),
              Contains(HasSubstr("Outputs lacks \"y\"")));
  EXPECT_THAT(with("<Unknown index=\"2\" dependencies=\"\"/>", "<Unknown index=\"1\"/><Unknown index=\"2\"/>"),
              Contains(HasSubstr("Outputs lists \"u\"")));
  EXPECT_THAT(with("initial=\"exact\"><Real start=\"0\"", "><Real"),
              Contains(HasSubstr("InitialUnknowns lacks \"y\"")));
  EXPECT_THAT(with("</Outputs>", "</Outputs><InitialUnknowns><Unknown index=\"3\"/></InitialUnknowns>"),
              Contains(HasSubstr("InitialUnknowns lists \"gain\"")));
}

TEST_F(CheckDescription, OsmpBinariesAreWhole) {
  EXPECT_THAT(
      and_variable(
          R"(<ScalarVariable name="b.size" valueReference="9" causality="input" variability="discrete"><Integer start="7"/><Annotations><Tool name="net.pmsf.osmp"><osmp:osmp-binary-variable xmlns:osmp="x" name="b" role="size" mime-type="x"/></Tool></Annotations></ScalarVariable>)"),
      testing::AllOf(Contains(HasSubstr("starts at 7")), Contains(HasSubstr("has the parts size"))));
}

}  // namespace
}  // namespace mebots::check
