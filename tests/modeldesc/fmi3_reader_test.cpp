// SPDX-License-Identifier: Apache-2.0
// Tests reading modelDescription.xml of FMI 3.0, and the replacement of arrays by their elements.
#include "mebots/error.hpp"
#include "mebots/modeldesc/array_elements.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <gmock/gmock.h>

#include <string>

namespace mebots::modeldesc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string fmi3_text(const std::string& variables, const std::string& structure = "",
                      const std::string& version = "3.0") {
  return R"(<fmiModelDescription fmiVersion=")" + version + R"(" modelName="m" instantiationToken="{t}">
<CoSimulation modelIdentifier="m" hasEventMode="true" canGetAndSetFMUState="true" maxOutputDerivativeOrder="2"/>
<TypeDefinitions><EnumerationType name="Mode"><Item name="off" value="-5000000000"/></EnumerationType></TypeDefinitions>
<ModelVariables>)" +
         variables + "</ModelVariables><ModelStructure>" + structure + "</ModelStructure></fmiModelDescription>";
}

ModelDescription read_fmi3_text(const std::string& variables, const std::string& structure = "") {
  return read_xml_text(fmi3_text(variables, structure), "m.xml");
}

std::string error_of(const std::string& variables) {
  try {
    read_fmi3_text(variables);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// Declares an array whose size is the structural parameter "n".
constexpr const char* kSized = R"(
  <UInt64 name="n" valueReference="1" causality="structuralParameter" start="2"/>
  <Float64 name="m" valueReference="2" causality="output" start="1 2 3 4 5 6">
    <Dimension valueReference="1"/><Dimension start="3"/></Float64>)";

TEST(Fmi3Reader, ReadsEveryType) {
  const auto m = read_fmi3_text(R"(
    <Float32 name="f" valueReference="1" start="0.5"/>
    <Int8 name="a" valueReference="2" causality="input" start="-128"/>
    <UInt64 name="b" valueReference="3" causality="parameter" start="18446744073709551615"/>
    <Boolean name="c" valueReference="4" causality="input" start="true"/>
    <String name="d" valueReference="5" causality="parameter"><Start value="a text"/></String>
    <Binary name="e" valueReference="6" causality="input" mimeType="image/png" maxSize="9"><Start value="00fF"/></Binary>
    <Enumeration name="g" valueReference="7" causality="input" declaredType="Mode" start="-5000000000"/>
    <Clock name="h" valueReference="8" causality="input" intervalVariability="constant" intervalDecimal="0.5"/>
    <Int16 name="i" valueReference="9" causality="output" clocks="8"><Alias name="j"/></Int16>)");
  EXPECT_TRUE(m.is_fmi3());
  EXPECT_EQ(m.guid, "{t}");
  EXPECT_TRUE(m.co_simulation->has_event_mode);
  EXPECT_TRUE(m.co_simulation->can_get_and_set_fmu_state);
  EXPECT_EQ(m.co_simulation->max_output_derivative_order, 2U);
  EXPECT_EQ(m.find("f")->start, Value(0.5));
  EXPECT_EQ(m.find("a")->start, Value(std::int64_t{-128}));
  EXPECT_EQ(m.find("b")->start, Value(std::int64_t{-1})) << "a UInt64 has its bits";
  EXPECT_EQ(m.find("c")->start, Value(true));
  EXPECT_EQ(m.find("d")->start, Value(std::string("a text")));
  EXPECT_EQ(m.find("e")->start, Value(std::string("\0\xff", 2)));
  EXPECT_EQ(m.find("e")->fmi3->mime_type, "image/png");
  EXPECT_EQ(m.find("g")->start, Value(std::int64_t{-5'000'000'000}));
  EXPECT_EQ(m.find("h")->fmi3->timing->interval_s, 0.5);
  EXPECT_THAT(m.find("i")->fmi3->clocks, ElementsAre(8U));
  EXPECT_EQ(m.find("j")->value_reference, 9U);
  EXPECT_EQ(m.find("j")->fmi3->alias_of, "i");
}

TEST(Fmi3Reader, AcceptsVersionsOfFmi3Alone) {
  EXPECT_TRUE(read_xml_text(fmi3_text("", "", "3.0.2"), "m.xml").is_fmi3());
  EXPECT_THROW(read_xml_text(fmi3_text("", "", "4.0"), "m.xml"), Error);
}

TEST(Fmi3Reader, NamesWhatIsWrong) {
  EXPECT_THAT(error_of(R"(<Int8 name="a" valueReference="1" causality="input" start="128"/>)"),
              HasSubstr("the start value \"128\" of \"a\" is not a value of type Int8"));
  EXPECT_THAT(error_of(R"(<Binary name="a" valueReference="1"><Start value="0g"/></Binary>)"),
              HasSubstr("not pairs of hexadecimal digits"));
  EXPECT_THAT(error_of(R"(<Int8 name="a" valueReference="1"/><Int8 name="b" valueReference="1"/>)"),
              HasSubstr("\"a\" and \"b\" have the value reference 1"));
  EXPECT_THAT(error_of(R"(<Int8 name="a" valueReference="1" clocks="7"/>)"), HasSubstr("which no variable has"));
  EXPECT_THAT(error_of(R"(<Float64 name="a" valueReference="1"><Dimension/></Float64>)"),
              HasSubstr("either a start or a valueReference"));
  EXPECT_THAT(error_of(R"(<Float64 name="a" valueReference="1" start="1 2"/>)"), HasSubstr("no <Dimension>"));
  EXPECT_THAT(error_of(R"(<Real name="a" valueReference="1"/>)"), HasSubstr("not a type of FMI 3.0"));
}

TEST(ArrayElements, HaveIndicesAndStartsInRowMajorOrder) {
  const auto m = with_elements(read_fmi3_text(kSized, R"(<Output valueReference="2" dependencies="1"/>)"));
  ASSERT_EQ(m.variables.size(), 7U);
  const auto* element = m.find("m[2,1]");
  ASSERT_NE(element, nullptr);
  EXPECT_EQ(element->start, Value(4.0));
  EXPECT_EQ(element->fmi3->element->index, 3U);
  EXPECT_EQ(element->fmi3->element->array_reference, 2U);
  EXPECT_EQ(m.outputs.size(), 6U);
  EXPECT_THAT(*m.outputs[3].dependencies, ElementsAre(0U));
}

TEST(ArrayElements, FollowTheStructuralParameter) {
  const auto description = read_fmi3_text(kSized);
  EXPECT_EQ(with_elements(description, {{1, 4}}).variables.size(), 13U);
  EXPECT_EQ(with_elements(description, {{1, 0}}).variables.size(), 1U);
  EXPECT_EQ(with_elements(description, {{1, 4}}).find("m[1,1]")->start, Value()) << "of another size";
  EXPECT_THROW(with_elements(description, {{1, 1'000'000}}), Error);
  EXPECT_THROW(with_elements(description, {{1, UINT64_MAX}}), Error);
}

TEST(ArrayElements, TheNumberOfDependenciesIsLimited) {
  const std::string variables =
      R"(<UInt64 name="n" valueReference="1" causality="structuralParameter" variability="tunable" start="2"/>
         <Float64 name="u" valueReference="2" causality="input" start="0 0"><Dimension valueReference="1"/></Float64>
         <Float64 name="y" valueReference="3" causality="output"><Dimension valueReference="1"/></Float64>)";
  const auto some = read_fmi3_text(variables, R"(<Output valueReference="3" dependencies="2"/>)");
  EXPECT_EQ(with_elements(some, {{1, 100}}).outputs[99].dependencies->size(), 100U);
  EXPECT_THAT(
      [&] {
        with_elements(some, {{1, 20'001}});
      },
      ThrowsMessage<Error>(HasSubstr("\"y\": the elements of the arrays have more than 400000000 dependencies")));
  const auto all = read_fmi3_text(variables, R"(<Output valueReference="3"/>)");
  EXPECT_EQ(with_elements(all, {{1, 20'001}}).outputs.size(), 20'001U);
}

TEST(ArrayElements, ADerivativeHasAsManyElementsAsItsState) {
  const auto description = read_fmi3_text(
      R"(<UInt64 name="n" valueReference="1" causality="structuralParameter" variability="tunable" start="2"/>
         <Float64 name="x" valueReference="2"><Dimension valueReference="1"/></Float64>
         <Float64 name="rate" valueReference="3" derivative="2"><Dimension start="2"/></Float64>)");
  const auto fitting = with_elements(description);
  EXPECT_EQ(fitting.variables[*fitting.find("rate[2]")->derivative_of].name, "x[2]");
  for (const std::uint64_t size : {0, 1, 3}) {
    const auto expand = [&] { with_elements(description, {{1, size}}); };
    EXPECT_THAT(expand, ThrowsMessage<Error>(HasSubstr("\"rate\" is the derivative of \"x\", but has 2 elements")))
        << size;
  }
}

}  // namespace
}  // namespace mebots::modeldesc
