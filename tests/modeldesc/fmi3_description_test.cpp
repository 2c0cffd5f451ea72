// SPDX-License-Identifier: Apache-2.0
// Tests the parts of a description for FMI 3.0: versions, arrays, structural parameters and terminals.
#include "description.hpp"
#include "fmi3_variables.hpp"
#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/text_file.hpp"

#include <gmock/gmock.h>
#include <pugixml.hpp>

#include <filesystem>
#include <fstream>

namespace mebots::modeldesc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kPosition = R"({"name": "position.{axis}", "causality": "input", "unit": "m", "start": [1, 2],
  "text": "Where"})";

class Fmi3DescriptionTest : public testing::Test {
 protected:
  Description read(const std::string& variables, const std::string& more) {
    const auto file = folder_.path() / "description.json";
    std::ofstream(file) << R"({"name": "x", "text": "An x", "step": 0.1, "stop_time": 1,
      "groups": {"axis": ["x", "y"], "rotor": ["rotor[1]", "rotor[2]", "rotor[3]"]}, )"
                        << more << R"("variables": [)" << variables << "]}";
    return read_description(file);
  }
  std::string error_of(const std::string& variables, const std::string& more) {
    try {
      const auto description = read(variables, more);
      fmi3_variables(description);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  std::vector<std::string> names(const Description& description) {
    std::vector<std::string> result;
    for (const auto& variable : fmi3_variables(description)) result.push_back(variable.name);
    return result;
  }
  pugi::xml_node variable(const pugi::xml_document& document, const char* name) {
    return document.document_element().child("ModelVariables").find_child_by_attribute("name", name);
  }
  void parse(const Description& description, pugi::xml_document& document) {
    document.load_string(write_fmi3_xml(description, to_model_description(description)).xml.c_str());
  }

  TemporaryFolder folder_{"description"};
};

TEST_F(Fmi3DescriptionTest, GroupsBecomeArraysIfTheDescriptionRequestsIt) {
  const std::string variables = std::string(kPosition) + R"(,
    {"name": "{rotor}.thrust", "causality": "output", "unit": "N", "text": "Thrust"},
    {"name": "{axis}.limit", "causality": "parameter", "unit": "m", "start": 1, "text": "Limit"})";
  EXPECT_THAT(names(read(variables, "")), ElementsAre("position.x", "position.y", "rotor[1].thrust", "rotor[2].thrust",
                                                      "rotor[3].thrust", "x.limit", "y.limit"));
  const auto arrays = read(variables, R"("arrays": {"axis": true, "rotor": true}, )");
  EXPECT_THAT(names(arrays), ElementsAre("position", "rotor.thrust", "axis.limit"));
  pugi::xml_document document;
  parse(arrays, document);
  const auto position = variable(document, "position");
  EXPECT_STREQ(position.name(), "Float64");
  EXPECT_STREQ(position.attribute("start").value(), "1 2");
  EXPECT_STREQ(position.attribute("description").value(), "Where (x, y)");
  EXPECT_STREQ(position.child("Dimension").attribute("start").value(), "2");
  EXPECT_EQ(variable(document, "rotor.thrust").attribute("valueReference").as_int(), 2)
      << "the row of its first element";
  EXPECT_EQ(variable(document, "time").attribute("valueReference").as_int(), 7) << "after all rows";
}

TEST_F(Fmi3DescriptionTest, TheSizeOfAnArrayCanBeAParameter) {
  const std::string rotors =
      R"({"name": "{rotor}.thrust", "causality": "input", "unit": "N", "start": 0, "text": "t"})";
  const auto count = [&](const std::string& rest) {
    return R"({"name": "rotors", "type": "Integer", "causality": "parameter", "text": "t", )" + rest + "}, " + rotors;
  };
  const std::string more = R"("arrays": {"rotor": "rotors"}, )";
  pugi::xml_document document;
  parse(read(count(R"("start": 2, "min": 0, "max": 3)"), more), document);
  const auto rotors_parameter = variable(document, "rotors");
  EXPECT_STREQ(rotors_parameter.name(), "UInt64");
  EXPECT_STREQ(rotors_parameter.attribute("causality").value(), "structuralParameter");
  const auto thrust = variable(document, "rotor.thrust");
  EXPECT_STREQ(thrust.child("Dimension").attribute("valueReference").value(), "0");
  EXPECT_STREQ(thrust.attribute("start").value(), "0 0") << "as many as the start of the parameter";
  EXPECT_THAT(error_of(count(R"("start": 2, "min": 0, "max": 4)"), more), HasSubstr("a max of at most 3 (the words"));
  EXPECT_THAT(error_of(count(R"("start": 0, "min": 0, "max": 3)"), more), HasSubstr("a start of at least 1"));
  EXPECT_THAT(error_of(rotors, more), HasSubstr("/arrays/rotor: the parameter 'rotors' is unknown"));
  EXPECT_THAT(error_of(rotors, R"("arrays": {"rotors": true}, )"), HasSubstr("the group 'rotors' is unknown"));
  EXPECT_THAT(error_of(rotors, R"("arrays": {"rotor": false}, )"), HasSubstr("this must be true, or the name of"));
}

TEST_F(Fmi3DescriptionTest, RefusesAnArrayWithTheNameOfAnotherVariable) {
  const std::string twice = std::string(kPosition) + R"(,
    {"name": "position", "causality": "output", "unit": "km", "text": "t"})";
  EXPECT_THAT(error_of(twice, R"("arrays": {"axis": true}, )"),
              HasSubstr("would have the name position, which is taken"));
  EXPECT_EQ(error_of(twice, ""), "no error");
  EXPECT_THAT(error_of(R"({"name": "time", "causality": "output", "unit": "s", "text": "t"})", ""),
              HasSubstr("that of the independent variable"));
}

TEST_F(Fmi3DescriptionTest, BinariesAreOneVariableWithTheirMediaType) {
  pugi::xml_document document;
  parse(read(R"({"name": "frame", "type": "Binary", "causality": "input", "mime_type": "image/png", "text": "t"},
    {"name": "{axis}.frame", "type": "Binary", "causality": "output", "mime_type": "image/png", "text": "t"})",
             R"("arrays": {"axis": true}, )"),
        document);
  EXPECT_STREQ(variable(document, "frame").attribute("mimeType").value(), "image/png");
  EXPECT_TRUE(variable(document, "frame").child("Start"));
  EXPECT_EQ(variable(document, "axis.frame").attribute("valueReference").as_int(), 3);
  EXPECT_EQ(variable(document, "time").attribute("valueReference").as_int(), 9);
}

TEST_F(Fmi3DescriptionTest, TerminalsNameVariablesAsTheDescriptionDoes) {
  const std::string variables = std::string(kPosition) + R"(,
    {"name": "{rotor}.thrust", "causality": "output", "unit": "N", "text": "t"},
    {"name": "power", "causality": "output", "unit": "W", "text": "t"})";
  const auto terminals = [](const std::string& text) {
    return R"("arrays": {"axis": true}, "terminals": )" + text + ", ";
  };
  const auto description = read(variables, terminals(R"({
    "place": {"kind": "org.x", "matching_rule": "plug", "members": {"p": "position.{axis}", "first": "rotor[1].thrust"}},
    "{rotor}": {"kind": "org.y", "members": {"thrust": "{rotor}.thrust", "power": "power"}}})"));
  pugi::xml_document document;
  document.load_string(write_terminals_and_icons(description, true).c_str());
  std::vector<std::string> found;
  for (const auto member : document.select_nodes("//TerminalMemberVariable"))
    found.push_back(std::string(member.node().parent().attribute("name").value()) + "/" +
                    member.node().attribute("memberName").value() + "=" +
                    member.node().attribute("variableName").value());
  EXPECT_THAT(found, ElementsAre("place/p=position", "place/first=rotor[1].thrust", "rotor[1]/thrust=rotor[1].thrust",
                                 "rotor[1]/power=power", "rotor[2]/thrust=rotor[2].thrust", "rotor[2]/power=power",
                                 "rotor[3]/thrust=rotor[3].thrust", "rotor[3]/power=power"));
  EXPECT_THAT(error_of(variables, terminals(R"({"a": {"kind": "k", "members": {"m": "powr"}}})")),
              HasSubstr("/terminals/a/members/m: the variable 'powr' is unknown. Did you mean 'power'?"));
  EXPECT_THAT(error_of(variables, terminals(R"({"a": {"kind": "k", "members": {"m": "{rotor}.thrust"}}})")),
              HasSubstr("{rotor}.thrust stands for several variables"));
  EXPECT_THAT(error_of(variables, terminals(R"({"a": {"kind": "k", "members": {}}})")),
              HasSubstr("at least one member"));
  EXPECT_THAT(error_of(variables, terminals(R"({"{rot}": {"kind": "k", "members": {"m": "power"}}})")),
              HasSubstr("the group 'rot' is unknown"));
}

TEST_F(Fmi3DescriptionTest, WritesBothVersionsOrOneAlone) {
  const auto both = read(kPosition, R"("fmi": [3, 2], )");
  generate(both, folder_.path() / "both");
  EXPECT_THAT(text_of(folder_.path() / "both/modelDescription.xml"), HasSubstr(R"(fmiVersion="2.0")"));
  const auto three = text_of(folder_.path() / "both/fmi3/modelDescription.xml");
  EXPECT_THAT(three, HasSubstr(R"(fmiVersion="3.0")"));
  const auto token = write_fmi3_xml(both, to_model_description(both)).token;
  EXPECT_THAT(three, HasSubstr("instantiationToken=\"" + token + '"'));
  EXPECT_THAT(text_of(folder_.path() / "both/variable_table.cpp"),
              HasSubstr(".instantiation_token = \"" + token + '"'));
  generate(read(kPosition, R"("fmi": 3, )"), folder_.path() / "one");
  EXPECT_THAT(text_of(folder_.path() / "one/modelDescription.xml"), HasSubstr(R"(fmiVersion="3.0")"));
  EXPECT_EQ(text_of(folder_.path() / "one/terminalsAndIcons.xml"), "");
  EXPECT_THAT(error_of(kPosition, R"("fmi": 1, )"), HasSubstr("/fmi: "));
  EXPECT_THAT(error_of(kPosition, R"("fmi": [], )"), HasSubstr("it needs 2, 3 or both"));
}

}  // namespace
}  // namespace mebots::modeldesc
