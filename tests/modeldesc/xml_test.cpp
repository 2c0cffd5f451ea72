// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/xml.hpp"
#include "description.hpp"
#include "generate.hpp"
#include "mebots/error.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace mebots::modeldesc {
namespace {

using testing::HasSubstr;

ModelDescription of(const std::string& fmu, const std::string& board = "") {
  const std::string root = MEBOTS_SOURCE_DIR;
  return to_model_description(
      read_description(root + "/" + fmu + "/description.json", board.empty() ? "" : root + "/" + board));
}

void expect_round_trip(const ModelDescription& written) {
  const std::string text = write_xml(written);
  const ModelDescription read = read_xml_text(text, "test");
  EXPECT_EQ(read.variables.size(), written.variables.size());
  for (std::size_t i = 0; i < read.variables.size(); ++i)
    EXPECT_TRUE(read.variables[i] == written.variables[i]) << written.variables[i].name;
  EXPECT_TRUE(read == written);
  EXPECT_EQ(write_xml(read), text);
}

TEST(Xml, ReadsBackAsWrittenForTheShippedFmus) {
  expect_round_trip(of("fmu_battery"));
  expect_round_trip(of("fmu_motors"));
  expect_round_trip(of("fmu_world"));
  expect_round_trip(of("fmu_soc", "configs/boards/ai_deck.json"));
  expect_round_trip(of("tests/fmus/lag"));
}

TEST(Xml, KeepsNumbersToTheLastBitAndTextToTheLastCharacter) {
  ModelDescription x = of("tests/fmus/lag");
  x.text = "<\"quoted\" & 'marked'> \xC3\xA9\ntwo lines";
  x.default_experiment.stop_time_s = 0.1 + 0.2;
  x.default_experiment.tolerance = std::numeric_limits<double>::denorm_min();
  x.units[0].factor = 1.0 / 3.0;
  expect_round_trip(x);
}

/// Returns a description in the style of another tool: flat names, omitted defaults, unknown attributes and elements.
std::string foreign(const std::string& variables, const std::string& structure = "") {
  return R"(<?xml version="1.0"?>
<!DOCTYPE fmiModelDescription [<!ENTITY secret SYSTEM "file:///etc/passwd">]>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g" xmlns:v="urn:v">
  <ModelExchange modelIdentifier="m_me" completedIntegratorStepNotNeeded="true"/>
  <CoSimulation modelIdentifier="m_cs" canHandleVariableCommunicationStepSize="1"/>
  <UnitDefinitions><Unit name="V"><BaseUnit kg="1" m="2" s="-3" A="-1"/><DisplayUnit name="mV" factor="1000"/></Unit>
    <Unit name="bag"/></UnitDefinitions>
  <TypeDefinitions><SimpleType name="Voltage"><Real quantity="U" unit="V" displayUnit="mV" min="0" nominal="10"/></SimpleType></TypeDefinitions>
  <VendorAnnotations><Tool name="t"><v:anything deep="1"/></Tool></VendorAnnotations>
  <ModelVariables>)" +
         variables + "</ModelVariables>\n<ModelStructure>" + structure + "</ModelStructure></fmiModelDescription>";
}

TEST(Xml, FillsInWhatFmiLeavesOut) {
  const ModelDescription x = read_xml_text(foreign(R"xml(
    <ScalarVariable name="a" valueReference="0"><Real declaredType="Voltage" max="5" start="+1e0"/></ScalarVariable>
    <ScalarVariable name="n" valueReference="0" causality="parameter"><Integer start=" 3 "/></ScalarVariable>
    <ScalarVariable name="b" valueReference="4294967295" causality="output"><Boolean/></ScalarVariable>
    <ScalarVariable name="der(a)" valueReference="1"><Real derivative="1" unit="V"/></ScalarVariable>)xml",
                                                   R"(<Outputs><Unknown index="3"/></Outputs>
    <Derivatives><Unknown index="4" dependencies="1 2" dependenciesKind="dependent fixed"/></Derivatives>)"),
                                           "foreign.xml");
  ASSERT_TRUE(x.model_exchange);
  EXPECT_EQ(x.model_exchange->model_identifier, "m_me");
  EXPECT_TRUE(x.model_exchange->completed_integrator_step_not_needed);
  EXPECT_FALSE(x.model_exchange->can_serialize_fmu_state);
  EXPECT_EQ(x.co_simulation->model_identifier, "m_cs");
  EXPECT_TRUE(x.co_simulation->can_handle_variable_communication_step_size);
  EXPECT_FALSE(x.co_simulation->can_get_and_set_fmu_state);
  const Variable& a = *x.find("a");
  EXPECT_EQ(a.causality, Causality::local);
  EXPECT_EQ(a.variability, Variability::continuous);
  EXPECT_EQ(a.initial, Initial::calculated);
  EXPECT_EQ(a.unit, "V");
  EXPECT_EQ(a.min, 0);
  EXPECT_EQ(a.max, 5);
  EXPECT_EQ(a.nominal, 10);
  EXPECT_EQ(std::get<double>(a.start), 1);
  const Variable& n = *x.find("n");
  EXPECT_EQ(n.variability, Variability::fixed);
  EXPECT_EQ(n.initial, Initial::exact);
  EXPECT_EQ(std::get<std::int64_t>(n.start), 3);
  EXPECT_EQ(x.find("b")->value_reference, 4294967295U);
  EXPECT_EQ(x.find("b")->variability, Variability::discrete);
  EXPECT_EQ(x.find("der(a)")->derivative_of, 0U);
  EXPECT_EQ(x.find("nobody"), nullptr);
  EXPECT_FALSE(x.unit("bag")->has_base);
  EXPECT_EQ(x.unit("V")->display_units.at(0).factor, 1000);
  EXPECT_FALSE(x.outputs.at(0).dependencies.has_value());
  EXPECT_THAT(*x.derivatives.at(0).dependencies, testing::ElementsAre(0U, 1U));
  EXPECT_THAT(x.derivatives.at(0).dependency_kinds, testing::ElementsAre("dependent", "fixed"));
}

TEST(Xml, FindsVariablesUnitsAndTypesByName) {
  const ModelDescription x = of("fmu_battery");
  for (const auto& variable : x.variables) EXPECT_EQ(x.find(variable.name), &variable);
  for (const auto& unit : x.units) EXPECT_EQ(x.unit(unit.name), &unit);
  for (const auto& type : x.types) EXPECT_EQ(x.type_definition(type.name), &type);
  EXPECT_EQ(x.find(""), nullptr);
  EXPECT_EQ(x.find("cell.voltag"), nullptr);
  EXPECT_EQ(x.unit("zzz"), nullptr);
}

TEST(Xml, FindsNamesInADescriptionThatGrewAfterItWasIndexed) {
  ModelDescription x = of("tests/fmus/lag");
  x.variables.emplace_back().name = "late";
  EXPECT_EQ(x.find("late"), &x.variables.back());
}

TEST(Xml, FindsOsmpBinariesWhateverTheirPrefix) {
  const ModelDescription x = read_xml_text(foreign(R"(
    <ScalarVariable name="p.base.lo" valueReference="0" causality="input"><Integer start="0"/>
      <Annotations><Tool name="net.pmsf.osmp"><x:osmp-binary-variable xmlns:x="u" name="p" role="base.lo" mime-type="image/png"/></Tool></Annotations>
    </ScalarVariable>)"),
                                           "foreign.xml");
  ASSERT_TRUE(x.variables[0].osmp.has_value());
  EXPECT_EQ(x.variables[0].osmp->name, "p");
  EXPECT_EQ(x.variables[0].osmp->role, "base.lo");
  EXPECT_EQ(x.variables[0].osmp->mime_type, "image/png");
}

void expect_error(const std::string& text, const char* message) {
  try {
    read_xml_text(text, "f.xml");
    ADD_FAILURE() << "no error, expected: " << message;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(message));
    EXPECT_THAT(error.what(), HasSubstr("f.xml, line "));
  }
}

TEST(Xml, ErrorsNameFileLineElementAttributeAndValue) {
  const auto variable = [](const std::string& attributes, const std::string& type) {
    return foreign("\n<ScalarVariable " + attributes + ">" + type + "</ScalarVariable>");
  };
  expect_error("", "not well-formed XML");
  expect_error("<a>\n\n<b></a>", "line 3: not well-formed XML");
  expect_error("<other/>", "the root element must be <fmiModelDescription>");
  expect_error("<fmiModelDescription fmiVersion=\"4.0\"/>", "of FMI version 4.0; only 1.0, 2.0 and 3.0 can");
  expect_error("<fmiModelDescription fmiVersion=\"2.0\" modelName=\"m\"/>", "the attribute guid is missing");
  expect_error("<fmiModelDescription fmiVersion=\"2.0\" modelName=\"m\" guid=\"g\"/>",
               "there is neither <CoSimulation> nor");
  expect_error(variable("valueReference=\"1\"", "<Real/>"), "line 11, <ScalarVariable>: the attribute name is missing");
  expect_error(variable("name=\"a\"", "<Real/>"), "the attribute valueReference is missing");
  expect_error(variable("name=\"a\" valueReference=\"-1\"", "<Real/>"), "valueReference is \"-1\"");
  expect_error(variable("name=\"a\" valueReference=\"1\"", ""), "\"a\" has no type");
  expect_error(variable("name=\"a\" valueReference=\"1\"", "<Real/><Integer/>"), "\"a\" has two types");
  expect_error(variable("name=\"a\" valueReference=\"1\" causality=\"up\"", "<Real/>"),
               "the attribute causality is \"up\"; it must be one of parameter, ");
  expect_error(variable("name=\"a\" valueReference=\"1\"", "<Real start=\"1,5\"/>"),
               "start is \"1,5\", but a number is expected");
  expect_error(variable("name=\"a\" valueReference=\"1\"", "<Integer start=\"1e3\"/>"), "start is \"1e3\"");
  expect_error(variable("name=\"a\" valueReference=\"1\"", "<Boolean start=\"yes\"/>"),
               "start is \"yes\", but true or false");
  expect_error(variable("name=\"a\" valueReference=\"1\" variability=\"continuous\"", "<Integer/>"),
               "cannot be continuous");
  expect_error(variable("name=\"a\" valueReference=\"1\"", "<Real declaredType=\"T\"/>"),
               "declared type \"T\", which <TypeDefinitions> does not define");
  expect_error(variable("name=\"a\" valueReference=\"1\"", "<Integer declaredType=\"Voltage\"/>"),
               "its declared type \"Voltage\" is of type Real");
  const std::string a = "<ScalarVariable name=\"a\" valueReference=\"1\"><Real/></ScalarVariable>";
  expect_error(foreign(a + a), "two variables have the name \"a\"");
  expect_error(foreign(a, "<Outputs><Unknown index=\"one\"/></Outputs>"), "\"one\" is not an index of a variable");
}

TEST(Xml, IndicesWithoutAVariableInModelStructureAreFaultsButNoErrors) {
  const auto x =
      read_xml_text(foreign(R"(<ScalarVariable name="a" valueReference="1" causality="output"><Real/></ScalarVariable>
      <ScalarVariable name="b" valueReference="2" causality="output"><Real/></ScalarVariable>)",
                            R"(<Outputs><Unknown index="1" dependencies="0 2" dependenciesKind="fixed dependent"/>
      <Unknown index="3"/><Unknown index="2" dependencies="1"/><Unknown index="0" dependencies=""/></Outputs>)"),
                    "f.xml");
  ASSERT_EQ(x.outputs.size(), 2U);
  EXPECT_EQ(x.outputs[0].variable, 0U);
  EXPECT_FALSE(x.outputs[0].dependencies.has_value()) << "a lost dependency may be any";
  EXPECT_TRUE(x.outputs[0].dependency_kinds.empty());
  EXPECT_EQ(x.outputs[1].variable, 1U);
  EXPECT_EQ(x.outputs[1].dependencies, std::vector<std::size_t>{0});
  EXPECT_THAT(
      x.structure_faults,
      testing::ElementsAre(testing::EndsWith("<Unknown>: \"0\" is not an index of a variable; they go from 1 to 2"),
                           HasSubstr("\"3\" is not an index"), HasSubstr("\"0\" is not an index")));
}

TEST(Xml, EntitiesOfADtdAreNeverExpanded) {
  const std::string a = "<ScalarVariable name=\"&secret;\" valueReference=\"1\"><Real/></ScalarVariable>";
  expect_error(foreign(a), "the entity &secret; of the DTD is not expanded");
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY l0 \"lol\">";
  for (int i = 1; i < 10; ++i) {
    bomb += "<!ENTITY l" + std::to_string(i) + " \"";
    for (int j = 0; j < 10; ++j) bomb += "&l" + std::to_string(i - 1) + ";";
    bomb += "\">";
  }
  expect_error(bomb + "]><fmiModelDescription modelName=\"&l9;\"/>", "is not expanded");
}

constexpr const char* kUnicode =
    R"xml(<ScalarVariable name="Größe" valueReference="0" description="10 µm"><Real/></ScalarVariable>)xml";

/// Returns the code points of a text in UTF-8. All must be below U+0100.
std::u32string code_points(const std::string& text) {
  std::u32string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    result +=
        byte < 0x80 ? char32_t{byte} : (char32_t{byte} & 0x1FU) << 6U | (static_cast<unsigned char>(text[++i]) & 0x3FU);
  }
  return result;
}

TEST(Xml, IsReadInWhateverEncodingItIsWritten) {
  const auto text = foreign(kUnicode);
  const auto expected = read_xml_text(text, "f.xml");
  EXPECT_EQ(expected.variables.at(0).name, "Größe");
  EXPECT_TRUE(read_xml_text("\xEF\xBB\xBF" + text, "f.xml") == expected);

  const auto points = code_points(text);
  std::string latin;
  std::string little = "\xFF\xFE";
  std::string big;  // big-endian, without byte order mark
  for (const auto point : points) {
    latin += static_cast<char>(point);
    little += {static_cast<char>(point), '\0'};
    big += {'\0', static_cast<char>(point)};
  }
  for (const char* name : {"ISO-8859-1", "Windows-1252", "latin1"}) {
    auto declared = latin;
    declared.replace(0, std::string("<?xml version=\"1.0\"?>").size(),
                     std::string("<?xml version=\"1.0\" encoding='") + name + "'?>");
    EXPECT_TRUE(read_xml_text(declared, "f.xml") == expected) << name;
  }
  EXPECT_TRUE(read_xml_text(little, "f.xml") == expected);
  EXPECT_TRUE(read_xml_text(big, "f.xml") == expected);
  expect_error(latin, "bytes that are not UTF-8 text");
  expect_error("<?xml version=\"1.0\" encoding=\"klingon\"?><a/>", "the encoding \"klingon\" is unknown");
}

TEST(Xml, DeepNestingIsRefusedAndDoesNotCrash) {
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  for (int i = 0; i < 100'000; ++i) deep += "</a>";
  expect_error(deep, "nested more than 200 levels deep");
}

TEST(Xml, AUnitThatConvertsNothingIsRefused) {
  auto text = foreign("");
  text.replace(text.find("A=\"-1\""), 6, "A=\"-1\" factor=\"0\"");
  expect_error(text, "the factor 0");
}

}  // namespace
}  // namespace mebots::modeldesc
