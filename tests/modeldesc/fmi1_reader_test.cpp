// SPDX-License-Identifier: Apache-2.0
// Tests reading modelDescription.xml of FMI 1.0 in the terms of FMI 2.0.
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <gmock/gmock.h>

#include <string>

namespace mebots::modeldesc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string fmi1_text(const std::string& variables, const std::string& implementation = "<Implementation/>") {
  return R"(<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="g" numberOfContinuousStates="0"
 numberOfEventIndicators="3">
<UnitDefinitions><BaseUnit unit="rad"><DisplayUnitDefinition displayUnit="deg" gain="57.3"/></BaseUnit></UnitDefinitions>
<TypeDefinitions><Type name="Mode"><EnumerationType><Item name="off"/><Item name="on"/></EnumerationType></Type>
<Type name="Angle"><RealType unit="rad" min="-3"/></Type></TypeDefinitions>
<DefaultExperiment startTime="1" stopTime="2" tolerance="1e-4"/><ModelVariables>)" +
         variables + "</ModelVariables>" + implementation + "</fmiModelDescription>";
}

ModelDescription read_fmi1_text(const std::string& variables) {
  return read_xml_text(fmi1_text(variables), "m.xml");
}

std::string fmi1_error(const std::string& variables) {
  try {
    read_fmi1_text(variables);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Fmi1Reader, ReadsHeadUnitsAndTypes) {
  const auto m =
      read_fmi1_text(R"(<ScalarVariable name="a" valueReference="0"><Real declaredType="Angle"/></ScalarVariable>)");
  EXPECT_TRUE(m.is_fmi1());
  EXPECT_EQ(m.guid, "g");
  EXPECT_EQ(m.number_of_event_indicators, 3U);
  EXPECT_EQ(m.co_simulation->model_identifier, "m");
  EXPECT_EQ(m.default_experiment.start_time_s, 1);
  EXPECT_EQ(m.default_experiment.tolerance, 1e-4);
  ASSERT_NE(m.unit("rad"), nullptr);
  EXPECT_FALSE(m.unit("rad")->has_base);
  EXPECT_EQ(m.unit("rad")->display_units.front().factor, 57.3);
  EXPECT_EQ(m.find("a")->unit, "rad");
  EXPECT_EQ(m.find("a")->min, -3);
  ASSERT_NE(m.type_definition("Mode"), nullptr);
  EXPECT_EQ(m.type_definition("Mode")->items.back().value, 2) << "items count from 1";
}

TEST(Fmi1Reader, DescribesRolesInTheTermsOfFmi2) {
  const auto m = read_fmi1_text(R"(
    <ScalarVariable name="a" valueReference="0" causality="input"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="b" valueReference="1" causality="output"><Integer/></ScalarVariable>
    <ScalarVariable name="c" valueReference="2" causality="input" variability="parameter"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="d" valueReference="3" variability="parameter"><Real/></ScalarVariable>
    <ScalarVariable name="e" valueReference="4" variability="constant"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="f" valueReference="5" causality="none"><Real start="2" fixed="false"/></ScalarVariable>
    <ScalarVariable name="g" valueReference="6"><Real start="3"/></ScalarVariable>)");
  EXPECT_EQ(m.find("a")->causality, Causality::input);
  EXPECT_FALSE(m.find("a")->initial);
  EXPECT_EQ(m.find("b")->causality, Causality::output);
  EXPECT_EQ(m.find("b")->variability, Variability::discrete) << "only Real can be continuous";
  EXPECT_EQ(m.find("c")->causality, Causality::parameter);
  EXPECT_EQ(m.find("c")->variability, Variability::fixed);
  EXPECT_EQ(m.find("d")->causality, Causality::calculated_parameter);
  EXPECT_EQ(m.find("e")->variability, Variability::constant);
  EXPECT_EQ(m.find("f")->causality, Causality::local);
  EXPECT_EQ(m.find("f")->initial, Initial::approx);
  EXPECT_EQ(m.find("g")->initial, Initial::exact);
}

TEST(Fmi1Reader, GivesNegatedAliasesReferencesOfTheirOwn) {
  const auto m = read_fmi1_text(R"(
    <ScalarVariable name="a" valueReference="4294967294"><Real/></ScalarVariable>
    <ScalarVariable name="b" valueReference="4294967294" alias="alias"><Real/></ScalarVariable>
    <ScalarVariable name="c" valueReference="4294967294" alias="negatedAlias"><Real/></ScalarVariable>
    <ScalarVariable name="d" valueReference="0" alias="negatedAlias"><Integer/></ScalarVariable>)");
  EXPECT_EQ(m.find("b")->value_reference, 4294967294U);
  EXPECT_FALSE(m.find("b")->negated_reference);
  EXPECT_EQ(m.find("c")->value_reference, 4294967293U);
  EXPECT_EQ(m.find("c")->negated_reference, 4294967294U);
  EXPECT_EQ(m.find("d")->value_reference, 4294967292U);
  EXPECT_EQ(m.find("d")->negated_reference, 0U);
}

TEST(Fmi1Reader, ReadsDependenciesOfOutputs) {
  const auto m = read_fmi1_text(R"(
    <ScalarVariable name="y" valueReference="0" causality="output"><Real/><DirectDependency><Name>u</Name><Name>v</Name></DirectDependency></ScalarVariable>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="z" valueReference="2" causality="output"><Real/></ScalarVariable>)");
  ASSERT_EQ(m.outputs.size(), 2U);
  EXPECT_THAT(*m.outputs[0].dependencies, ElementsAre(1U));
  EXPECT_FALSE(m.outputs[1].dependencies) << "it may depend on all inputs";
  EXPECT_THAT(m.structure_faults, ElementsAre(HasSubstr("\"v\", which is not a variable")));
}

TEST(Fmi1Reader, LeavesOutASecondVariableOfTheSameName) {
  const auto m = read_fmi1_text(R"(
    <ScalarVariable name="a" valueReference="1"><Real/></ScalarVariable>
    <ScalarVariable name="a" valueReference="2" causality="output"><Real/></ScalarVariable>)");
  ASSERT_EQ(m.variables.size(), 1U);
  EXPECT_EQ(m.variables[0].value_reference, 1U);
  EXPECT_TRUE(m.outputs.empty());
  EXPECT_EQ(m.structure_faults.size(), 1U);
}

TEST(Fmi1Reader, DistinguishesKinds) {
  const auto exchange = read_xml_text(fmi1_text("", ""), "m.xml");
  EXPECT_FALSE(exchange.co_simulation);
  EXPECT_EQ(exchange.model_exchange->model_identifier, "m");
  const auto tool =
      read_xml_text(fmi1_text("", R"(<Implementation><CoSimulation_Tool><Capabilities maxOutputDerivativeOrder="2"
 canBeInstantiatedOnlyOncePerProcess="1"/></CoSimulation_Tool></Implementation>)"),
                    "m.xml");
  EXPECT_TRUE(tool.co_simulation->needs_execution_tool);
  EXPECT_EQ(tool.co_simulation->max_output_derivative_order, 2U);
  EXPECT_TRUE(tool.co_simulation->can_be_instantiated_only_once_per_process);
}

TEST(Fmi1Reader, NamesWhatIsWrong) {
  EXPECT_THAT(
      fmi1_error(R"(<ScalarVariable name="a" valueReference="0" alias="negatedAlias"><String/></ScalarVariable>)"),
      HasSubstr("a value of type String has no negative"));
  EXPECT_THAT(fmi1_error(R"(<ScalarVariable name="a" valueReference="0" causality="local"><Real/></ScalarVariable>)"),
              HasSubstr("input, output, internal, none"));
  EXPECT_THAT(fmi1_error(R"(<ScalarVariable name="a" valueReference="0"/>)"), HasSubstr("has no type"));
  EXPECT_THAT(fmi1_error(R"(<ScalarVariable name="a" valueReference="0"><Real declaredType="B"/></ScalarVariable>)"),
              HasSubstr("which <TypeDefinitions> does not define"));
}

}  // namespace
}  // namespace mebots::modeldesc
