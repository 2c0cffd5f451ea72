// SPDX-License-Identifier: Apache-2.0
// Tests that SSPs of other tools run, and that written SSPs are equivalent to the config.
#include "io/ssp/ssp.hpp"
#include "io/config/load_system.hpp"
#include "resolve/resolve.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>

namespace mebots::master {
namespace {

using test::ProgramResult;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kHead = R"(<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
  xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" version="1.0" name="test">
<ssd:System name="root">)";
constexpr const char* kTail = R"(</ssd:System>
<ssd:DefaultExperiment startTime="0" stopTime="0.4"/>
<ssd:Annotations><ssc:Annotation type="org.mebots.config">{"step": 0.1}</ssc:Annotation></ssd:Annotations>
</ssd:SystemStructureDescription>)";

class Ssp : public testing::Test {
 protected:
  /// Packs an SSP with the SSD `system`, the test FMUs and further files.
  std::filesystem::path ssp(const std::string& system, const std::map<std::string, std::string>& files = {},
                            const std::string& tail = kTail) {
    test::write_file(folder.path() / "SystemStructure.ssd", kHead + system + tail);
    std::vector<modeldesc::PackedFile> packed{{"SystemStructure.ssd", folder.path() / "SystemStructure.ssd"},
                                              {"resources/coupling.fmu", COUPLING_FMU},
                                              {"resources/my probe.fmu", PROBE_FMU},
                                              {"resources/bank.fmu", BANK_FMU}};
    for (const auto& [name, text] : files) {
      const auto file = folder.path() / std::filesystem::path(name).filename();
      test::write_file(file, text);
      packed.push_back({name, file});
    }
    auto archive = folder.path() / "test.ssp";
    std::filesystem::remove(archive);
    modeldesc::pack(archive, packed);
    return archive;
  }

  LoadedSystem load(const std::string& system, const std::map<std::string, std::string>& files = {}) {
    return load_system(ssp(system, files));
  }
  std::string error_of(const std::string& system, const std::string& tail = kTail) {
    return test::input_error([&] { load_system(ssp(system, {}, tail)); });
  }
  ProgramResult run(std::vector<std::string> arguments) const { return test::run_program(arguments, folder.path()); }

  modeldesc::TemporaryFolder folder{"mebots test"};
};

const std::string kTwo = R"(<ssd:Elements>
  <ssd:Component name="a" type="application/x-fmu-sharedlibrary" source="resources/coupling.fmu">{}</ssd:Component>
  <ssd:Component name="b" source="resources/my%20probe.fmu"/></ssd:Elements>)";

std::string two(const std::string& inside_a = "") {
  return fmt::format(fmt::runtime(kTwo), inside_a);
}

TEST_F(Ssp, ComponentsConnectionsAndTimesAreRead) {
  const auto system = load(two() + R"(<ssd:Connections>
    <ssd:Connection startElement="a" startConnector="celsius" endElement="b" endConnector="real_in" suppressUnitConversion="true">
      <ssc:LinearTransformation factor="2" offset="-1"/></ssd:Connection></ssd:Connections>)")
                          .system;
  EXPECT_EQ(system.instance_names(), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(system.instances[1].fmu_path.filename(), "my probe.fmu");
  EXPECT_EQ(system.step, (ExactTime{1, 10}));
  EXPECT_EQ(system.stop_time_ns, 400'000'000);
  ASSERT_EQ(system.connections.size(), 1u);
  EXPECT_EQ(system.connections[0].factor, 2);
  EXPECT_EQ(system.connections[0].offset, -1);
  EXPECT_FALSE(system.connections[0].convert_units);
}

TEST_F(Ssp, NestedSystemsAreFlattenedAndTheirConnectorsPassedThrough) {
  const auto loaded = load(R"(<ssd:Elements>
    <ssd:System name="left"><ssd:Connectors><ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>
      <ssd:Elements><ssd:System name="deep"><ssd:Connectors><ssd:Connector name="z" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>
        <ssd:Elements><ssd:Component name="source" source="resources/coupling.fmu"/></ssd:Elements>
        <ssd:Connections><ssd:Connection startElement="source" startConnector="bare_out" endConnector="z"><ssc:LinearTransformation factor="3"/></ssd:Connection></ssd:Connections>
      </ssd:System></ssd:Elements>
      <ssd:Connections><ssd:Connection startElement="deep" startConnector="z" endConnector="y"><ssc:LinearTransformation offset="1"/></ssd:Connection></ssd:Connections>
    </ssd:System>
    <ssd:Component name="sink" source="resources/coupling.fmu"/></ssd:Elements>
    <ssd:Connections><ssd:Connection startElement="left" startConnector="y" endElement="sink" endConnector="bare_in"><ssc:LinearTransformation factor="10"/></ssd:Connection></ssd:Connections>)");
  const auto& system = loaded.system;
  EXPECT_EQ(system.instance_names(), (std::vector<std::string>{"left.deep.source", "sink"}));
  ASSERT_EQ(system.connections.size(), 1u);
  EXPECT_EQ(system.connections[0].from, (VariableName{"left.deep.source", "bare_out"}));
  EXPECT_EQ(system.connections[0].factor, 30);  // 10 (3 x + 1)
  EXPECT_EQ(system.connections[0].offset, 10);
}

TEST_F(Ssp, ParametersComeInlineAndFromFilesAndOuterOnesWin) {
  const std::string inline_values = R"(<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
      <ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
        <ssv:Parameter name="celsius"><ssv:Real value="1.5"/></ssv:Parameter><ssv:Parameter name="count"><ssv:Integer value="7"/></ssv:Parameter>
        <ssv:Parameter name="flag"><ssv:Boolean value="true"/></ssv:Parameter><ssv:Parameter name="level"><ssv:Enumeration value="high"/></ssv:Parameter>
        <ssv:Parameter name="behaviour"><ssv:String value="a &lt; b"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>
      </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>)";
  const auto loaded = load(
      R"(<ssd:ParameterBindings><ssd:ParameterBinding source="resources/outer.ssv" prefix="a."/></ssd:ParameterBindings>)" +
          two(inline_values),
      {{"resources/outer.ssv",
        R"(<ParameterSet xmlns="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" name="o">
               <Parameters><Parameter name="celsius"><Real value="2.5"/></Parameter></Parameters></ParameterSet>)"}});
  const auto& parameters = loaded.config["instances"]["a"]["parameters"];
  EXPECT_EQ(parameters["celsius"], 2.5);
  EXPECT_EQ(parameters["count"], 7);
  EXPECT_EQ(parameters["flag"], true);
  EXPECT_EQ(parameters["level"], "high");
  EXPECT_EQ(parameters["behaviour"], "a < b");
}

TEST_F(Ssp, AMappingRenamesAndTransforms) {
  const auto loaded = load(
      two(R"(<ssd:ParameterBindings><ssd:ParameterBinding source="resources/values.ssv">
        <ssd:ParameterMapping source="resources/names.ssm"/></ssd:ParameterBinding></ssd:ParameterBindings>)"),
      {{"resources/values.ssv",
        R"(<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" name="o">
          <ssv:Parameters><ssv:Parameter name="warmth"><ssv:Real value="20"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>)"},
       {"resources/names.ssm",
        R"(<ssm:ParameterMapping xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
            xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0">
          <ssm:MappingEntry source="warmth" target="celsius"><ssc:LinearTransformation factor="0.5" offset="1"/></ssm:MappingEntry>
          <ssm:MappingEntry source="warmth" target="speed_kmh"/></ssm:ParameterMapping>)"}});
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["celsius"], 11.0);
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["speed_kmh"], 20.0);
}

TEST_F(Ssp, AValueOfTheSystemsConnectorGoesToWhatHangsOnIt) {
  const auto loaded = load(
      R"(<ssd:Connectors><ssd:Connector name="u" kind="input"><ssc:Real/></ssd:Connector></ssd:Connectors>
      <ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues><ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
        <ssv:Parameter name="u"><ssv:Real value="4"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>)" +
      two() +
      R"(<ssd:Connections><ssd:Connection startConnector="u" endElement="a" endConnector="bare_in"/></ssd:Connections>)");
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["bare_in"], 4.0);
  EXPECT_TRUE(loaded.system.connections.empty());
}

TEST_F(Ssp, OMSimulatorsStepIsUnderstood) {
  const auto loaded = load_system(
      ssp(two() + R"(<ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations xmlns:oms="x">
        <oms:SimulationInformation><oms:FixedStepMaster description="oms-ma" stepSize="1e-2"/></oms:SimulationInformation></oms:Annotations></ssc:Annotation></ssd:Annotations>)",
          {}, R"(</ssd:System><ssd:DefaultExperiment stopTime="1"/></ssd:SystemStructureDescription>)"));
  EXPECT_EQ(loaded.system.step, (ExactTime{1, 100}));
}

TEST_F(Ssp, TheStepOfTheOpenSimulationPlatformIsUnderstood) {
  const auto loaded = load_system(ssp(two(), {}, R"(</ssd:System><ssd:DefaultExperiment stopTime="1"><ssd:Annotations>
    <ssc:Annotation type="com.opensimulationplatform"><osp:Algorithm xmlns:osp="x"><osp:FixedStepAlgorithm baseStepSize="2e-2"/></osp:Algorithm></ssc:Annotation>
    </ssd:Annotations></ssd:DefaultExperiment></ssd:SystemStructureDescription>)"));
  EXPECT_EQ(loaded.system.step, (ExactTime{1, 50}));
}

TEST_F(Ssp, ReportsUnsupportedElementsWithFileAndLine) {
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a"/></ssd:Elements>)"),
              AllOf(HasSubstr("test.ssp: SystemStructure.ssd, line 5"), HasSubstr("\"a\" has no source")));
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a" source="../x.fmu"/></ssd:Elements>)"),
              HasSubstr("is not inside the SSP"));
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a" source="file:///etc/passwd"/></ssd:Elements>)"),
              HasSubstr("is absolute"));
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a" source="resources/none.fmu"/></ssd:Elements>)"),
              HasSubstr("contains no file \"resources/none.fmu\""));
  EXPECT_THAT(
      error_of(
          two() +
          R"(<ssd:Connections><ssd:Connection startElement="c" startConnector="y" endElement="a" endConnector="u"/></ssd:Connections>)"),
      HasSubstr("no element \"c\""));
  EXPECT_THAT(error_of(two(), R"(</ssd:System></ssd:SystemStructureDescription>)"), HasSubstr("set it with --step"));
  EXPECT_THAT(error_of("<broken"), HasSubstr("not well-formed"));
  EXPECT_THAT(
      error_of(
          two(),
          R"(</ssd:System><ssd:DefaultExperiment startTime="5" stopTime="4"/><ssd:Annotations><ssc:Annotation type="org.mebots.config">{"step": 0.1}</ssc:Annotation></ssd:Annotations></ssd:SystemStructureDescription>)"),
      HasSubstr("must be greater than the start time 5 s"));
}

TEST_F(Ssp, AnUnpackedOneRunsByItsFolderAndByItsFile) {
  modeldesc::unpack(
      ssp(two() +
          R"(<ssd:Connections><ssd:Connection startElement="a" startConnector="count" endElement="b" endConnector="integer_in"/></ssd:Connections>)"),
      folder.path() / "open one");
  const auto by_folder = load_system(folder.path() / "open one");
  const auto by_file = load_system(folder.path() / "open one" / "SystemStructure.ssd");
  EXPECT_EQ(by_folder.system.name, "open one");
  EXPECT_EQ(by_file.system.name, "open one");
  EXPECT_EQ(by_folder.config, by_file.config);
  EXPECT_EQ(by_folder.system.source, by_file.system.source);
  EXPECT_EQ(by_file.system.connections.size(), 1U);
  EXPECT_EQ(run({"run", "open one"}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "results" / "open one" / "results.csv"));
  std::filesystem::create_directory(folder.path() / "none");
  EXPECT_THAT(test::input_error([&] { load_system(folder.path() / "none"); }), HasSubstr("SystemStructure.ssd"));
}

// Rules of the standard. Numbers are sections of SSP 2.0, which are the same in SSP 1.0 unless stated otherwise.

std::string part(const std::string& name, const std::string& connector = "", const std::string& more = "") {
  return fmt::format(R"(<ssd:Component name="{}" source="resources/coupling.fmu">{}{}</ssd:Component>)", name,
                     connector.empty() ? "" : "<ssd:Connectors>" + connector + "</ssd:Connectors>", more);
}

std::string connector(const std::string& name, const std::string& kind, const std::string& unit = "") {
  return fmt::format(R"(<ssd:Connector name="{}" kind="{}"><ssc:Real{}/></ssd:Connector>)", name, kind,
                     unit.empty() ? "" : fmt::format(" unit=\"{}\"", unit));
}

/// Returns an inline binding with these <ssv:Parameter> elements, followed by `more`.
std::string binding(const std::string& parameters, const std::string& more = "", const std::string& attributes = "") {
  return fmt::format(
      R"(<ssd:ParameterBindings><ssd:ParameterBinding {}><ssd:ParameterValues><ssv:ParameterSet version="1.0" name="p">
      <ssv:Parameters>{}</ssv:Parameters><ssv:Units><ssc:Unit name="km/h"><ssc:BaseUnit m="1" s="-1" factor="0.2777777777777778"/></ssc:Unit>
      <ssc:Unit name="C"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit></ssv:Units></ssv:ParameterSet></ssd:ParameterValues>{}</ssd:ParameterBinding></ssd:ParameterBindings>)",
      attributes, parameters, more);
}

std::string real(const std::string& name, const std::string& value, const std::string& unit = "") {
  return fmt::format(R"(<ssv:Parameter name="{}"><ssv:Real value="{}"{}/></ssv:Parameter>)", name, value,
                     unit.empty() ? "" : fmt::format(" unit=\"{}\"", unit));
}

std::string mapping(const std::string& entries) {
  return R"(<ssd:ParameterMapping><ssm:ParameterMapping version="1.0">)" + entries +
         "</ssm:ParameterMapping></ssd:ParameterMapping>";
}

constexpr const char* kUnitsTail = R"(</ssd:System><ssd:Units>
<ssc:Unit name="m/s"><ssc:BaseUnit m="1" s="-1"/></ssc:Unit><ssc:Unit name="cm/s"><ssc:BaseUnit m="1" s="-1" factor="0.01"/></ssc:Unit>
<ssc:Unit name="kg"><ssc:BaseUnit kg="1"/></ssc:Unit></ssd:Units><ssd:DefaultExperiment startTime="0" stopTime="0.4"/>
<ssd:Annotations><ssc:Annotation type="org.mebots.config">{"step": 0.1}</ssc:Annotation></ssd:Annotations></ssd:SystemStructureDescription>)";

TEST_F(Ssp, TheOrderOfAConnectionsEndsIsNotItsDirection) {  // 5.4.2
  const auto nested = [&](bool turned) {
    const auto connection = [&](const std::string& from, const std::string& from_name, const std::string& to,
                                const std::string& to_name) {
      const auto end = [](const char* side, const std::string& element, const std::string& name) {
        return (element.empty() ? "" : fmt::format("{}Element=\"{}\" ", side, element)) +
               fmt::format("{}Connector=\"{}\" ", side, name);
      };
      const auto* first = turned ? "end" : "start";
      const auto* second = turned ? "start" : "end";
      return "<ssd:Connection " + end(first, from, from_name) + end(second, to, to_name) + "/>";
    };
    return load("<ssd:Connectors>" + connector("u", "input") + connector("y", "output") + "</ssd:Connectors>" +
                binding(real("u", "4")) + "<ssd:Elements>" + part("a") + R"(<ssd:System name="in"><ssd:Connectors>)" +
                connector("x", "input") + connector("z", "output") + "</ssd:Connectors><ssd:Elements>" + part("b") +
                "</ssd:Elements><ssd:Connections>" + connection("", "x", "b", "bare_in") +
                connection("b", "bare_out", "", "z") + "</ssd:Connections></ssd:System>" + part("c") +
                "</ssd:Elements><ssd:Connections>" + connection("", "u", "a", "bare_in") +
                connection("a", "bare_out", "in", "x") + connection("in", "z", "c", "bare_in") +
                connection("c", "bare_out", "", "y") + "</ssd:Connections>")
        .config;
  };
  const auto straight = nested(false);
  const auto turned = nested(true);
  EXPECT_EQ(straight["connections"], turned["connections"]);
  EXPECT_EQ(straight["instances"]["a"]["parameters"], turned["instances"]["a"]["parameters"]);
  EXPECT_EQ(straight["instances"]["a"]["parameters"]["bare_in"], 4.0);
  ASSERT_EQ(straight["connections"].size(), 2U);
  EXPECT_EQ(straight["connections"][0]["from"], "a.bare_out");
  EXPECT_EQ(straight["connections"][0]["to"], "in.b.bare_in");
  EXPECT_EQ(straight["connections"][1]["from"], "in.b.bare_out");
  EXPECT_EQ(straight["connections"][1]["to"], "c.bare_in");
}

TEST_F(Ssp, TwoOutputsOrTwoInputsCannotBeConnected) {  // 5.4.2.1
  const auto error = [&](const std::string& one, const std::string& other) {
    return error_of(two() + fmt::format(R"(<ssd:Connections><ssd:Connection startElement="a" startConnector="{}"
      endElement="b" endConnector="{}"/></ssd:Connections>)",
                                        one, other));
  };
  EXPECT_THAT(error("bare_out", "real_out"),
              AllOf(HasSubstr("line 7"), HasSubstr("\"a.bare_out\" (output)"), HasSubstr("both give a value")));
  EXPECT_THAT(error("bare_in", "real_in"), HasSubstr("both take a value"));
  // Inside a system, its own outputs are targets. A connection of two targets has no source.
  EXPECT_THAT(
      error_of(
          "<ssd:Connectors>" + connector("y", "output") + "</ssd:Connectors>" + two() +
          R"(<ssd:Connections><ssd:Connection startConnector="y" endElement="a" endConnector="bare_in"/></ssd:Connections>)"),
      HasSubstr("both take a value"));
}

TEST_F(Ssp, UnitsAreConvertedAtEachConnectorOnTheWay) {  // 4.5.1.1, 4.5.2.1
  // 36 km/h is 10 m/s at the connector of the system. The transformation adds 1 m/s. The result is 1100 cm/s at a
  // variable without a unit.
  const auto system =
      "<ssd:Elements>" + part("a", "", binding(real("speed_kmh", "36"))) + R"(<ssd:System name="in"><ssd:Connectors>)" +
      connector("x", "input", "m/s") + "</ssd:Connectors><ssd:Elements>" +
      part("b", connector("bare_in", "input", "cm/s")) +
      R"(</ssd:Elements><ssd:Connections><ssd:Connection startConnector="x" endElement="b" endConnector="bare_in"{}/>
      </ssd:Connections></ssd:System></ssd:Elements><ssd:Connections><ssd:Connection startElement="a" startConnector="speed_kmh" endElement="in" endConnector="x">
      <ssc:LinearTransformation offset="1"/></ssd:Connection></ssd:Connections>)";
  const auto arrives = [&](const std::string& attribute, const std::string& tail) {
    const auto archive = ssp(fmt::format(fmt::runtime(system), attribute), {}, tail);
    const auto connection = load_system(archive).system.connections.at(0);
    EXPECT_FALSE(connection.convert_units);
    return connection.factor * 36 + connection.offset;
  };
  EXPECT_NEAR(arrives("", kUnitsTail), 1100, 1e-9);
  EXPECT_NEAR(arrives(R"( suppressUnitConversion="true")", kUnitsTail), 11, 1e-12);
  EXPECT_THAT(
      test::input_error([&] {
        load_system(ssp(
            "<ssd:Elements>" + part("a") + part("b", connector("bare_in", "input", "kg")) +
                R"(</ssd:Elements><ssd:Connections><ssd:Connection startElement="a" startConnector="speed_kmh" endElement="b" endConnector="bare_in"/></ssd:Connections>)",
            {}, kUnitsTail));
      }),
      AllOf(HasSubstr("SystemStructure.ssd, line 5"), HasSubstr("differ in dimension"), HasSubstr("[kg]")));
}

TEST_F(Ssp, ValuesAreConvertedFromTheUnitOfTheirFile) {  // 6.2.1, 7.1.1
  const auto given = [&](const std::string& parameters, const std::string& more = "") {
    return load("<ssd:Elements>" + part("a", "", binding(parameters, more)) + "</ssd:Elements>")
        .config["instances"]["a"]["parameters"];
  };
  EXPECT_NEAR(given(real("speed_in", "36", "km/h"))["speed_in"].get<double>(), 10, 1e-12);
  EXPECT_NEAR(given(real("kelvin_in", "20", "C"))["kelvin_in"].get<double>(), 293.15, 1e-12);
  EXPECT_EQ(given(real("bare_in", "36", "km/h"))["bare_in"], 36.0);   // the variable has no unit
  EXPECT_EQ(given(real("furlong", "2", "furlong"))["furlong"], 2.0);  // the units are undefined but equal
  // A linear transformation follows the conversion of units. With suppressUnitConversion, it replaces the conversion.
  const auto entry = [](const std::string& attribute) {
    return mapping(R"(<ssm:MappingEntry source="v" target="speed_in")" + attribute +
                   R"(><ssc:LinearTransformation factor="2" offset="1"/></ssm:MappingEntry>)");
  };
  EXPECT_NEAR(given(real("v", "36", "km/h"), entry(""))["speed_in"].get<double>(), 21, 1e-12);
  EXPECT_EQ(given(real("v", "36", "km/h"), entry(R"( suppressUnitConversion="true")"))["speed_in"], 73.0);
  const auto mistaken = [&](const std::string& parameters) {
    return error_of("<ssd:Elements>" + part("a", "", binding(parameters)) + "</ssd:Elements>");
  };
  EXPECT_THAT(mistaken(real("speed_in", "1", "C")), AllOf(HasSubstr("line 6"), HasSubstr("differ in dimension")));
  // Units that no file defines. A usual name is converted; another name is not. Both cases add a notice.
  EXPECT_DOUBLE_EQ(given(real("speed_in", "36", "[km/h]"))["speed_in"].get<double>(), 10);
  EXPECT_EQ(given(real("speed_in", "36", "bananas"))["speed_in"], 36.0);
  EXPECT_THAT(
      load("<ssd:Elements>" + part("a", "", binding(real("speed_in", "36", "bananas"))) + "</ssd:Elements>")
          .system.notices,
      testing::Contains(AllOf(HasSubstr("[bananas]"), HasSubstr("so the numbers are not converted (1): a.speed_in"))));
}

TEST_F(Ssp, OnlyMappedParametersAreAppliedAndOnlyByTheirNewNames) {  // 7.1
  const auto loaded = load(binding(real("k", "7") + real("celsius", "99") + real("speed_kmh", "3"),
                                   mapping(R"(<ssm:MappingEntry source="to.k" target="a.celsius"/>
                                  <ssm:MappingEntry source="to.k" target="a.bare_in"/>)"),
                                   R"(prefix="to.")") +
                           "<ssd:Elements>" + part("a") + "</ssd:Elements>");
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"],
            (nlohmann::ordered_json{{"bare_in", 7.0}, {"celsius", 7.0}}));
}

TEST_F(Ssp, MapsChangeTheValuesThatTheyName) {  // 4.5.2.2 to 4.5.2.4
  const auto entry = [](const std::string& source, const std::string& target, const std::string& kind,
                        const std::string& from, const std::string& to) {
    return fmt::format(
        R"(<ssm:MappingEntry source="{}" target="{}"><ssc:{}MappingTransformation><ssc:MapEntry source="{}" target="{}"/></ssc:{}MappingTransformation></ssm:MappingEntry>)",
        source, target, kind, from, to, kind);
  };
  const auto loaded = load(
      "<ssd:Elements>" +
      part(
          "a", "",
          binding(
              R"(<ssv:Parameter name="on"><ssv:Boolean value="1"/></ssv:Parameter><ssv:Parameter name="n"><ssv:Integer value="3"/></ssv:Parameter>
                  <ssv:Parameter name="word"><ssv:Enumeration value="warm"/></ssv:Parameter>)",
              mapping(entry("on", "flag", "Boolean", "true", "false") + entry("n", "count", "Integer", "3", "-8") +
                      entry("n", "steps", "Integer", "4", "5") +
                      entry("word", "level", "Enumeration", "warm", "high")))) +
      "</ssd:Elements>");
  const auto& parameters = loaded.config["instances"]["a"]["parameters"];
  EXPECT_EQ(parameters["flag"], false);
  EXPECT_EQ(parameters["count"], -8);
  EXPECT_EQ(parameters["steps"], 3);  // not in the map: unchanged
  EXPECT_EQ(parameters["level"], "high");
}

TEST_F(Ssp, ConnectionsMapDiscreteValuesInARun) {
  // The outer connection maps 2 to 4, and the connection inside the system maps 4 to 5. A map may contain a value that
  // never occurs (4.5.2.3).
  const std::string system =
      "<ssd:Elements>" +
      part(
          "a", "",
          binding(
              R"(<ssv:Parameter name="count"><ssv:Integer value="2"/></ssv:Parameter><ssv:Parameter name="flag"><ssv:Boolean value="true"/></ssv:Parameter><ssv:Parameter name="level"><ssv:Enumeration value="low"/></ssv:Parameter>)")) +
      R"(<ssd:System name="in"><ssd:Connectors><ssd:Connector name="x" kind="input"><ssc:Integer/></ssd:Connector></ssd:Connectors><ssd:Elements>)" +
      part("b") + R"(<ssd:Component name="p" source="resources/my%20probe.fmu"/></ssd:Elements><ssd:Connections>
      <ssd:Connection startConnector="x" endElement="p" endConnector="integer_in"><ssc:IntegerMappingTransformation>
        <ssc:MapEntry source="4" target="5"/><ssc:MapEntry source="99999" target="6"/></ssc:IntegerMappingTransformation></ssd:Connection>
      </ssd:Connections></ssd:System><ssd:Component name="q" source="resources/my%20probe.fmu"/></ssd:Elements><ssd:Connections>
      <ssd:Connection startElement="a" startConnector="count" endElement="in" endConnector="x"><ssc:IntegerMappingTransformation>
        <ssc:MapEntry source="2" target="4"/></ssc:IntegerMappingTransformation></ssd:Connection>
      <ssd:Connection startElement="a" startConnector="flag" endElement="q" endConnector="boolean_in"><ssc:BooleanMappingTransformation>
        <ssc:MapEntry source="true" target="false"/></ssc:BooleanMappingTransformation></ssd:Connection>
      <ssd:Connection startElement="a" startConnector="level" endElement="q" endConnector="mode_in"><ssc:EnumerationMappingTransformation>
        <ssc:MapEntry source="low" target="both"/><ssc:MapEntry source="unheard" target="both"/></ssc:EnumerationMappingTransformation></ssd:Connection></ssd:Connections>)";
  ssp(system);
  auto result = run({"run", "test.ssp", "--out", "r"});
  ASSERT_EQ(result.code, 0) << result.err;
  // Conversion to a config and back does not change the results.
  EXPECT_EQ(run({"convert", "test.ssp", "copy.json"}).code, 0);
  EXPECT_EQ(run({"convert", "copy.json", "copy.ssp"}).code, 0);
  EXPECT_EQ(run({"run", "copy.ssp", "--out", "c"}).code, 0);
  const auto csv = test::read_file(folder.path() / "r/results.csv");
  EXPECT_EQ(csv, test::read_file(folder.path() / "c/results.csv"));
  const auto value = [&](const std::string& name) {
    std::istringstream lines(csv);
    std::string head;
    std::string first;
    std::getline(lines, head);
    std::getline(lines, first);
    std::istringstream names(head);
    std::istringstream values(first);
    for (std::string column, field; std::getline(names, column, ',') && std::getline(values, field, ',');) {
      if (column.substr(0, column.find(" [")) == name) return field;
    }
    return std::string("no such column");
  };
  EXPECT_EQ(value("in.p.integer_out"), "6");  // the probe adds 1
  EXPECT_EQ(value("q.boolean_out"), "0");
  EXPECT_EQ(value("q.mode_out"), "7");  // `both`
}

TEST_F(Ssp, OmitsValuesWithoutAReceiverWithANotice) {  // 5.3.3, 6.2
  const auto loaded = load(
      binding(real("a.celsius", "5") + real("a.nothing", "1") + real("elsewhere.k", "1") + real("a.bare_out", "1") +
              R"(<ssv:Parameter name="a.unknown"><ssv:Binary value="00"/></ssv:Parameter>)") +
      two() +
      R"(<ssd:Connections><ssd:Connection startElement="a" startConnector="celsius" endElement="b" endConnector="real_in" suppressUnitConversion="true"/></ssd:Connections>)");
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"], (nlohmann::ordered_json{{"celsius", 5.0}}));
  EXPECT_THAT(loaded.system.notices, testing::Contains(AllOf(HasSubstr("no such variable (3)"), HasSubstr("a.nothing"),
                                                             HasSubstr("elsewhere.k"), HasSubstr("a.unknown"))));
  EXPECT_THAT(loaded.system.notices, testing::Contains(AllOf(HasSubstr("cannot be set"), HasSubstr("a.bare_out"))));
}

TEST_F(Ssp, AValueOfAConnectedInputIsLeftOutWithANotice) {
  const auto loaded = load(
      two(binding(real("bare_in", "5"))) +
      R"(<ssd:Connections><ssd:Connection startElement="b" startConnector="real_out" endElement="a" endConnector="bare_in"/></ssd:Connections>)");
  EXPECT_FALSE(loaded.config["instances"]["a"].contains("parameters"));
  EXPECT_THAT(loaded.system.notices,
              testing::Contains(AllOf(HasSubstr("gets its value from b.real_out"), HasSubstr("a.bare_in"))));
}

TEST_F(Ssp, LaterBindingsWinOverEarlierOnesAndListsAreReadInTheirOrder) {  // 5.3.3
  const auto loaded =
      load("<ssd:Elements>" +
           part("a", "", binding(real("celsius", "1") + real("speed_kmh", "1")) + binding(real("celsius", "2"))) +
           "</ssd:Elements>");
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["celsius"], 2.0);
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["speed_kmh"], 1.0);
}

TEST_F(Ssp, AnUnpackedOneMayUseFilesOutsideItsFolderAndAnArchiveMayNot) {
  const auto inside = folder.path() / "system";
  std::filesystem::create_directories(inside);
  std::filesystem::copy_file(COUPLING_FMU, folder.path() / "beside.fmu");
  test::write_file(
      folder.path() / "beside.ssv",
      R"(<ParameterSet version="1.0" name="p"><Parameters><Parameter name="celsius"><Real value="8"/></Parameter></Parameters></ParameterSet>)");
  const auto ssd = [](const std::string& slash) {
    return kHead +
           fmt::format(
               R"(<ssd:Elements><ssd:Component name="a" source="..{}beside.fmu"><ssd:ParameterBindings><ssd:ParameterBinding source="../beside.ssv"/></ssd:ParameterBindings></ssd:Component></ssd:Elements>)",
               slash) +
           kTail;
  };
  test::write_file(inside / "SystemStructure.ssd", ssd("/"));
  EXPECT_EQ(load_system(inside).config["instances"]["a"]["parameters"]["celsius"], 8.0);
  EXPECT_EQ(run({"run", "system"}).code, 0);
  test::write_file(inside / "SystemStructure.ssd", ssd("\\"));
  const auto loaded = load_system(inside);
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["celsius"], 8.0);
  EXPECT_THAT(loaded.system.notices, testing::Contains(HasSubstr("backslashes of the source")));
}

TEST_F(Ssp, ValuesMayLieInsideAnFmu) {  // sourceBase="component", 5.3.3
  modeldesc::unpack(COUPLING_FMU, folder.path() / "fmu");
  std::filesystem::create_directories(folder.path() / "fmu/resources");
  test::write_file(
      folder.path() / "fmu/resources/set.ssv",
      R"(<ParameterSet version="1.0" name="p"><Parameters><Parameter name="celsius"><Real value="6"/></Parameter></Parameters></ParameterSet>)");
  std::vector<modeldesc::PackedFile> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path() / "fmu")) {
    if (entry.is_regular_file()) {
      files.push_back({entry.path().lexically_relative(folder.path() / "fmu").string(), entry.path()});
    }
  }
  std::filesystem::create_directories(folder.path() / "s");
  modeldesc::pack(folder.path() / "s/own.fmu", files);
  const auto with = [&](const std::string& source) {
    test::write_file(
        folder.path() / "s/SystemStructure.ssd",
        kHead +
            fmt::format(
                R"(<ssd:Elements><ssd:Component name="a" source="own.fmu"><ssd:ParameterBindings><ssd:ParameterBinding source="{}" sourceBase="component"/></ssd:ParameterBindings></ssd:Component></ssd:Elements>)",
                source) +
            kTail);
    return folder.path() / "s";
  };
  EXPECT_EQ(load_system(with("resources/set.ssv")).config["instances"]["a"]["parameters"]["celsius"], 6.0);
  EXPECT_THAT(test::input_error([&] { load_system(with("resources/none.ssv")); }),
              HasSubstr("own.fmu contains no file \"resources/none.ssv\""));
}

TEST_F(Ssp, AComponentMayBeAnotherSsd) {  // 5.5
  const std::string inner = std::string(kHead) + "<ssd:Connectors>" + connector("x", "input") + "</ssd:Connectors>" +
                            binding(real("b.celsius", "1")) + "<ssd:Elements>" +
                            R"(<ssd:Component name="b" source="coupling.fmu"/></ssd:Elements>
    <ssd:Connections><ssd:Connection startConnector="x" endElement="b" endConnector="bare_in"/></ssd:Connections></ssd:System></ssd:SystemStructureDescription>)";
  const std::string outer =
      "<ssd:Elements>" + part("a") +
      R"(<ssd:Component name="sub" type="application/x-ssp-definition" source="resources/inner.ssd">)" +
      binding(real("b.celsius", "2")) +
      R"(</ssd:Component></ssd:Elements><ssd:Connections><ssd:Connection startElement="a" startConnector="bare_out" endElement="sub" endConnector="x"/></ssd:Connections>)";
  const auto loaded = load(outer, {{"resources/inner.ssd", inner}});
  EXPECT_EQ(loaded.system.instance_names(), (std::vector<std::string>{"a", "sub.b"}));
  EXPECT_EQ(loaded.config["instances"]["sub.b"]["parameters"]["celsius"], 2.0);
  EXPECT_EQ(loaded.system.connections.at(0).to.text(), "sub.b.bare_in");
  EXPECT_THAT(
      test::input_error([&] {
        load(
            outer,
            {{"resources/inner.ssd",
              kHead +
                  std::string(
                      R"(<ssd:Elements><ssd:Component name="i" type="application/x-ssp-definition" source="inner.ssd"/></ssd:Elements></ssd:System></ssd:SystemStructureDescription>)")}});
      }),
      HasSubstr("refers to itself"));
}

TEST_F(Ssp, WritesParameterValuesToFilesWithUnits) {
  test::write_file(folder.path() / "first.json", test::with_probe(R"({"step": 0.1, "stop_time": 1, "connections": [],
    "instances": {"a b": {"fmu": "COUPLING", "parameters": {"speed_in": 2.5, "level": "high"}}, "a_b": {"fmu": "COUPLING", "parameters": {"celsius": 1}}}})"));
  ASSERT_EQ(run({"convert", "first.json", "second.ssp"}).code, 0);
  modeldesc::unpack(folder.path() / "second.ssp", folder.path() / "open");
  EXPECT_THAT(test::read_file(folder.path() / "open/SystemStructure.ssd"),
              AllOf(HasSubstr(R"(<ssd:ParameterBinding source="resources/a_b.ssv" />)"),
                    HasSubstr(R"(<ssd:ParameterBinding source="resources/a_b_2.ssv" />)"),
                    testing::Not(HasSubstr("ParameterValues"))));
  EXPECT_THAT(test::read_file(folder.path() / "open/resources/a_b.ssv"),
              AllOf(HasSubstr(R"(<ssv:Real value="2.5" unit="m/s" />)"), HasSubstr(R"(<ssc:BaseUnit m="1" s="-1" />)"),
                    HasSubstr(R"(<ssv:Enumeration value="high" name="Level" />)")));
  const auto loaded = load_system(folder.path() / "open");
  EXPECT_EQ(loaded.config["instances"]["a b"]["parameters"]["speed_in"], 2.5);
  EXPECT_EQ(loaded.config["instances"]["a_b"]["parameters"]["celsius"], 1.0);
}

class Osp : public Ssp {
 protected:
  /// Writes a system of two coupling FMUs with `connections` to its own folder.
  std::filesystem::path osp(const std::string& connections, const std::string& more = "<EndTime>0.4</EndTime>") {
    const auto system = folder.path() / "truck";
    std::filesystem::create_directories(system);
    std::filesystem::copy_file(COUPLING_FMU, system / "my coupling.fmu",
                               std::filesystem::copy_options::overwrite_existing);
    test::write_file(system / "coupling_OspModelDescription.xml", R"(<OspModelDescription><VariableGroups>
      <Generic name="out"><Force name="f"><Variable ref="mass_x"/></Force><Variable ref="level"/></Generic>
      <Generic name="in"><Variable ref="mass_u"/><Variable ref="level_in"/></Generic></VariableGroups></OspModelDescription>)");
    test::write_file(system / "OspSystemStructure.xml", fmt::format(R"(<?xml version="1.0" encoding="utf-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <StartTime>0.2</StartTime>{}<BaseStepSize>0.1</BaseStepSize><Algorithm>ecco</Algorithm>
  <Simulators>
    <Simulator name="a" source="my%20coupling.fmu"><InitialValues>
      <InitialValue variable="mass_x"><Real value="1"/></InitialValue><InitialValue variable="count"><Integer value="7"/></InitialValue>
      <InitialValue variable="flag"><Boolean value="1"/></InitialValue><InitialValue variable="behaviour"><String value=""/></InitialValue>
    </InitialValues></Simulator>
    <Simulator name="b" source="my coupling.fmu" stepSize="0.2"/>
  </Simulators>
  <Connections>{}</Connections></OspSystemStructure>)",
                                                                    more, connections));
    return system;
  }
  std::string refused(const std::string& connections) {
    return test::input_error([&] { load_system(osp(connections)); });
  }
};

TEST_F(Osp, SimulatorsInitialValuesStepsAndConnectionsBecomeASystem) {
  const auto system = osp(R"(
    <VariableConnection><Variable simulator="b" name="mass_u"/><Variable simulator="a" name="mass_x"/></VariableConnection>
    <VariableGroupConnection><VariableGroup simulator="a" name="in"/><VariableGroup simulator="b" name="out"/></VariableGroupConnection>)");
  const auto loaded = load_system(system);
  EXPECT_EQ(loaded.system.start_time_ns, 200'000'000);
  EXPECT_EQ(loaded.system.step_of(loaded.system.instances.at(1)), (ExactTime{1, 5}));
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["mass_x"], 1.0);
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["count"], 7);
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["flag"], true);
  ASSERT_EQ(loaded.system.connections.size(), 3U);
  EXPECT_EQ(loaded.system.connections[0].from.text(), "a.mass_x");
  EXPECT_EQ(loaded.system.connections[0].to.text(), "b.mass_u");
  EXPECT_EQ(loaded.system.connections[1].from.text(), "b.mass_x");
  EXPECT_EQ(loaded.system.connections[2].to.text(), "a.level_in");
  EXPECT_THAT(loaded.system.notices, testing::Contains(HasSubstr("\"ecco\" is ignored")));
  EXPECT_EQ(run({"run", "truck"}).code, 0);
  EXPECT_EQ(run({"info", "truck/OspSystemStructure.xml"}).code, 0);
  EXPECT_EQ(run({"convert", "truck", "truck.json"}).code, 0);
  EXPECT_EQ(run({"run", "truck.json"}).code, 0);
}

TEST_F(Osp, ReportsUnsupportedElementsWithTheirLine) {
  EXPECT_THAT(
      refused(
          R"(<VariableConnection><Variable simulator="a" name="mass_x"/><Variable simulator="b" name="mass_x"/></VariableConnection>)"),
      AllOf(HasSubstr("OspSystemStructure.xml, line 11"), HasSubstr("must be an output, and the other one an input")));
  EXPECT_THAT(
      refused(
          R"(<VariableConnection><Variable simulator="c" name="mass_x"/><Variable simulator="b" name="mass_u"/></VariableConnection>)"),
      HasSubstr("no simulator \"c\""));
  EXPECT_THAT(
      refused(
          R"(<VariableGroupConnection><VariableGroup simulator="a" name="on"/><VariableGroup simulator="b" name="in"/></VariableGroupConnection>)"),
      HasSubstr("has no group \"on\""));
  EXPECT_THAT(refused("<OtherConnection/>"), HasSubstr("OtherConnection is not a connection"));
  EXPECT_THAT(test::input_error([&] { load_system(osp("", "")); }), HasSubstr("set it with --stop-time"));
}

/// Tests OSP functions that compute inputs of `b` from outputs of `a`.
TEST_F(Osp, FunctionsAreComputedAtTheCommunicationPoints) {
  const auto variable = [](const std::string& simulator, const std::string& name) {
    return fmt::format(R"(<Variable simulator="{}" name="{}"/>)", simulator, name);
  };
  const auto signal = [](const std::string& function, const std::string& name) {
    return fmt::format(R"(<Signal function="{}" name="{}"/>)", function, name);
  };
  const auto joined = [](const std::string& one, const std::string& other) {
    return "<SignalConnection>" + one + other + "</SignalConnection>";
  };
  const std::string functions =
      R"(<Functions><LinearTransformation name="line" factor="2" offset="-1"/><Sum name="sum" inputCount="3"/>
    <VectorSum name="vector" inputCount="2" dimension="2"/></Functions>)";
  const std::string good =
      joined(variable("a", "mass_x"), signal("line", "in")) + joined(signal("line", "out"), variable("b", "mass_u")) +
      joined(signal("sum", "in[0]"), variable("a", "mass_x")) + joined(signal("sum", "in[1]"), variable("a", "count")) +
      joined(signal("sum", "in[2]"), variable("a", "now")) + joined(variable("b", "bare_in"), signal("sum", "out")) +
      joined(variable("b", "ramp_in"), signal("sum", "out")) +
      R"(<SignalGroupConnection><SignalGroup function="vector" name="in[0]"/><VariableGroup simulator="a" name="pair"/></SignalGroupConnection>
         <SignalGroupConnection><SignalGroup function="vector" name="in[1]"/><VariableGroup simulator="a" name="turned"/></SignalGroupConnection>
         <SignalGroupConnection><SignalGroup function="vector" name="out"/><VariableGroup simulator="b" name="takes"/></SignalGroupConnection>)";
  const auto more = "<EndTime>0.4</EndTime>";
  const auto with = [&](const std::string& connections) {
    auto system = osp(connections, more);
    auto text = test::read_file(system / "OspSystemStructure.xml");
    text.replace(text.find("<Connections>"), 0, functions);
    test::write_file(system / "OspSystemStructure.xml", text);
    test::write_file(system / "coupling_OspModelDescription.xml", R"(<OspModelDescription><VariableGroups>
      <Generic name="pair"><Variable ref="mass_x"/><Variable ref="now"/></Generic><Generic name="turned"><Variable ref="now"/><Variable ref="mass_x"/></Generic>
      <Generic name="takes"><Variable ref="speed_in"/><Variable ref="angle_in"/></Generic><Generic name="one"><Variable ref="now"/></Generic></VariableGroups></OspModelDescription>)");
    return system;
  };
  const auto loaded = load_system(with(good));
  FmuLibrary library;
  const auto resolved = resolve(loaded.system, library);
  EXPECT_EQ(resolved.connections.size(), 11U);  // 1 + 2 x 3 + 2 x 2
  EXPECT_EQ(loaded.system.connections.at(0).to.text(), "b.mass_u");
  EXPECT_EQ(loaded.system.connections.at(0).factor, 2);
  EXPECT_EQ(loaded.system.connections.at(0).offset, -1);
  ASSERT_EQ(run({"run", "truck", "--out", "r"}).code, 0);
  // In each row, the output of `b` must equal the function of the outputs of `a` in the same row.
  std::istringstream lines(test::read_file(folder.path() / "r/results.csv"));
  std::string line;
  std::getline(lines, line);
  std::vector<std::string> names;
  for (std::istringstream head(line); std::getline(head, line, ',');) names.push_back(line);
  int rows = 0;
  while (std::getline(lines, line)) {
    std::map<std::string, double> row;
    std::istringstream fields(line);
    for (const auto& name : names) {
      std::getline(fields, line, ',');
      row[name.substr(0, name.find(" ["))] = std::stod(line);
    }
    if (row["time"] > 0.2) continue;  // `b` takes steps twice as long as `a`: later rows contain older inputs
    EXPECT_EQ(row["b.bare_out"], row["a.mass_x"] + row["a.count"] + row["a.now"]);
    EXPECT_EQ(row["b.speed_out"], row["a.mass_x"] + row["a.now"]);
    EXPECT_EQ(row["b.angle_out"], row["a.now"] + row["a.mass_x"]);
    ++rows;
  }
  EXPECT_EQ(rows, 1);
  EXPECT_EQ(run({"convert", "truck", "truck.json"}).code, 0);
  EXPECT_EQ(run({"convert", "truck.json", "truck.ssp"}).code, 0);
  EXPECT_EQ(run({"run", "truck.ssp", "--out", "s"}).code, 0);
  EXPECT_EQ(test::read_file(folder.path() / "r/results.csv"), test::read_file(folder.path() / "s/results.csv"));

  const auto mistaken = [&](const std::string& connections) {
    return test::input_error([&] { load_system(with(connections)); });
  };
  EXPECT_THAT(mistaken(joined(variable("a", "mass_x"), signal("line", "in[0]"))), HasSubstr("no signal \"in[0]\""));
  EXPECT_THAT(mistaken(joined(variable("a", "mass_x"), signal("lime", "in"))), HasSubstr("no function \"lime\""));
  EXPECT_THAT(mistaken(joined(variable("a", "mass_x"), signal("sum", "in[3]"))), HasSubstr("no signal \"in[3]\""));
  EXPECT_THAT(mistaken(good + joined(variable("a", "now"), signal("line", "in"))),
              HasSubstr("already gets its value from \"a.mass_x\""));
  EXPECT_THAT(mistaken(joined(variable("a", "mass_x"), signal("line", "in"))),
              HasSubstr("its input in[0] is not connected"));
  EXPECT_THAT(
      mistaken(
          R"(<SignalGroupConnection><SignalGroup function="vector" name="in[0]"/><VariableGroup simulator="a" name="one"/></SignalGroupConnection>)"),
      HasSubstr("1 variables and the function 2 elements"));
}

TEST_F(Osp, AProxyAStepThatIsNoMultipleAndValuesOfConnectedInputsAreReported) {
  const auto system = osp(
      R"(<VariableConnection><Variable simulator="b" name="mass_u"/><Variable simulator="a" name="mass_x"/></VariableConnection>)");
  auto text = test::read_file(system / "OspSystemStructure.xml");
  const std::string old = R"(source="my coupling.fmu" stepSize="0.2"/>)";
  text.replace(text.find(old), old.size(),
               R"(source="proxyfmu://localhost?file=my%20coupling.fmu" stepSize="0.25"><InitialValues>
      <InitialValue variable="mass_u"><Real value="9"/></InitialValue></InitialValues></Simulator>)");
  test::write_file(system / "OspSystemStructure.xml", text);
  const auto loaded = load_system(system);
  EXPECT_EQ(loaded.config["instances"]["b"]["process"], "own");
  EXPECT_EQ(loaded.system.instances.at(1).steps, 2);
  EXPECT_THAT(loaded.system.notices, testing::Contains(HasSubstr("the proxy at localhost is not used")));
  EXPECT_THAT(loaded.system.notices, testing::Contains(HasSubstr("not a multiple of the base step")));
  EXPECT_THAT(loaded.system.notices,
              testing::Contains(AllOf(HasSubstr("\"b.mass_u\" is ignored"), HasSubstr("line 10"))));
  EXPECT_EQ(run({"run", "truck"}).code, 0);
}

TEST_F(Ssp, AnExperimentMayStartLater) {
  const auto loaded = load_system(ssp(
      two(), {},
      R"(</ssd:System><ssd:DefaultExperiment startTime="5" stopTime="9"/><ssd:Annotations><ssc:Annotation type="org.mebots.config">{"step": 0.1}</ssc:Annotation></ssd:Annotations></ssd:SystemStructureDescription>)"));
  EXPECT_EQ(loaded.system.start_time_ns, 5'000'000'000);
  EXPECT_EQ(loaded.system.stop_time_ns, 9'000'000'000);
}

TEST_F(Ssp, AnEmptyElementNameMeansTheSystemItself) {
  const auto loaded = load(
      R"(<ssd:Connectors><ssd:Connector name="u" kind="input"/></ssd:Connectors>)"
      R"(<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues><ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
        <ssv:Parameter name="u"><ssv:Real value="4"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>)" +
      two() +
      R"(<ssd:Connections><ssd:Connection startElement="" startConnector="u" endElement="a" endConnector="bare_in"/></ssd:Connections>)");
  EXPECT_EQ(loaded.config["instances"]["a"]["parameters"]["bare_in"], 4.0);
}

/// Returns a system with a connector that has a value and is connected to a variable.
std::string with_value(const std::string& value, const std::string& transformation) {
  return fmt::format(
      R"(<ssd:Connectors><ssd:Connector name="u" kind="input"/></ssd:Connectors>
      <ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues><ssv:ParameterSet><ssv:Parameters>
        <ssv:Parameter name="u">{}</ssv:Parameter></ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>{}
      <ssd:Connections><ssd:Connection startConnector="u" endElement="a" endConnector="bare_in">{}</ssd:Connection></ssd:Connections>)",
      value, two(), transformation);
}

TEST_F(Ssp, ValuesThatNoFmuCanTakeAreRefused) {
  const std::string twice = R"(<ssc:LinearTransformation factor="2"/>)";
  EXPECT_THAT(error_of(with_value(R"(<ssv:String value="much"/>)", twice)),
              AllOf(HasSubstr("\"u\" is \"much\""), HasSubstr("only numbers")));
  EXPECT_THAT(error_of(with_value(R"(<ssv:Real value="1e308"/>)", R"(<ssc:LinearTransformation factor="1e9"/>)")),
              HasSubstr("range of numbers"));
  EXPECT_THAT(error_of(with_value(R"(<ssv:Real value="INF"/>)", "")), HasSubstr("not a finite number"));
  EXPECT_THAT(error_of(with_value(R"(<ssv:Integer value="3e9"/>)", "")),
              HasSubstr("whole number from -2147483648 to 2147483647"));
  EXPECT_THAT(error_of(with_value(R"(<ssv:Enumeration value="1.5"/>)", "")),
              HasSubstr("\"1.5\" is not a whole number"));
  EXPECT_THAT(error_of(with_value(R"(<ssv:Integer value="7"/>)", R"(<ssc:IntegerMappingTransformation>
      <ssc:MapEntry source="7" target="99999999999999999999"/></ssc:IntegerMappingTransformation>)")),
              HasSubstr("\"99999999999999999999\" is not a whole number that fits into 64 bits"));
  EXPECT_THAT(error_of(with_value(R"(<ssv:String value="&#xD800;"/>)", "")), HasSubstr("not a character of XML"));
}

TEST_F(Ssp, ReportsAnUnmatchedInputWithItsPlaceInTheSsd) {
  FmuLibrary library;
  const auto loaded = load(two() + R"(
    <ssd:Connections><ssd:Connection startElement="a" startConnector="bare_oot" endElement="b" endConnector="real_in"/></ssd:Connections>)");
  EXPECT_THAT(test::input_error([&] { resolve(loaded.system, library); }),
              AllOf(HasSubstr("SystemStructure.ssd, line 8"), HasSubstr("'bare_out'")));
}

TEST_F(Ssp, ThereAndBackGivesTheSameResults) {
  test::write_file(folder.path() / "first.json", test::with_probe(R"({"text": "round trip", "step": 0.1, "stop_time": 1,
    "algorithm": {"type": "gauss-seidel", "order": ["b", "a", "c"]},
    "instances": {"a": {"fmu": "PROBE", "text": "the first", "parameters": {"gain": 0.1, "string_in": "ä < \"b\"", "mode_in": "both", "boolean_in": true, "integer_in": -3}},
      "b": {"fmu": "PROBE", "step": 0.2}, "c": {"fmu": "COUPLING", "on_discard": "divide", "parameters": {"level": "high", "celsius": 21.1}}},
    "connections": [{"from": "a.real_out", "to": "b.real_in", "factor": 0.3, "offset": -0.7, "text": "scaled"}, {"from": "a.buffer", "to": "b.taken"},
      {"from": "c.celsius", "to": "a.real_in", "convert_units": false}, {"from": "a.string_out", "to": "b.string_in"}, {"from": "a.mode_out", "to": "b.mode_in"}],
    "stop_when": [{"variable": "b.steps", "equals": 4}], "summary": {"x": "b.integral"}, "record": ["*"], "log": {"a": []}})"));
  EXPECT_EQ(run({"run", "first.json", "--out", "one"}).code, 0);
  auto result = run({"convert", "first.json", "second.ssp"});
  EXPECT_EQ(result.code, 0) << result.err;
  result = run({"run", "second.ssp", "--out", "two"});
  EXPECT_EQ(result.code, 0) << result.err;
  result = run({"convert", "second.ssp", "third.json"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(run({"run", "third.json", "--out", "three"}).code, 0);
  const auto first = test::read_file(folder.path() / "one/results.csv");
  EXPECT_GT(first.size(), 500u);
  EXPECT_EQ(first, test::read_file(folder.path() / "two/results.csv"));
  EXPECT_EQ(first, test::read_file(folder.path() / "three/results.csv"));
  // Writing twice results in equal bytes.
  EXPECT_EQ(run({"convert", "third.json", "fourth.ssp"}).code, 0);
  EXPECT_EQ(run({"convert", "fourth.ssp", "fifth.json"}).code, 0);
  const auto json = [&](const std::string& name) {
    auto config = nlohmann::json::parse(test::read_file(folder.path() / name));
    for (auto& instance : config["instances"]) instance.erase("fmu");
    return config;
  };
  EXPECT_EQ(json("third.json"), json("fifth.json"));
}

/// Tests that a system of FMI 3.0 has the same results as an SSP and after conversion back to a config.
class Ssp3 : public Ssp {
 protected:
  /// `instances`, `connections` and `record` are sections of the config.
  void expect_same(const std::string& instances, const std::string& connections, const std::string& record) const {
    test::write_file(folder.path() / "first.json",
                     fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{{}}}, "connections": [{}],
                       "record": {{"variables": {}}}}})",
                                 instances, connections, record));
    const auto results = [&](const std::string& file, const std::string& out) {
      const auto result = run({"run", file, "--out", out});
      EXPECT_EQ(result.code, 0) << file << ": " << result.err;
      return test::read_file(folder.path() / out / "results.csv");
    };
    const auto convert = [&](const std::string& from, const std::string& to) {
      const auto result = run({"convert", from, to});
      EXPECT_EQ(result.code, 0) << result.err;
      EXPECT_THAT(result.out, testing::Not(HasSubstr("ignored")));
    };
    const auto first = results("first.json", "one");
    convert("first.json", "second.ssp");
    EXPECT_EQ(results("second.ssp", "two"), first);
    convert("second.ssp", "third.json");
    EXPECT_EQ(results("third.json", "three"), first);
  }
  std::string entry(const std::string& name) const {
    std::filesystem::remove_all(folder.path() / "open");
    modeldesc::unpack(folder.path() / "second.ssp", folder.path() / "open");
    return test::read_file(folder.path() / "open" / name);
  }
};

TEST_F(Ssp3, WholeNumbersOf64BitsKeepTheirValues) {
  expect_same(fmt::format(R"("a": {{"fmu": "{0}", "parameters": {{"huge": 18446744073709551614,
      "long": -9223372036854775807, "single": 0.1, "byte": 255, "wide": 1e300}}}}, "b": {{"fmu": "{0}"}})",
                          WIDTHS_FMU),
              R"({"from": "a.huge_out", "to": "b.huge"}, {"from": "a.byte_out", "to": "b.long"})", R"(["*"])");
  EXPECT_THAT(test::read_file(folder.path() / "two/results.csv"), HasSubstr("18446744073709551614"));
  const auto values = entry("resources/a.ssv");
  EXPECT_THAT(values, AllOf(HasSubstr("version=\"2.0\""), HasSubstr("<ssv:UInt64 value=\"18446744073709551614\" />"),
                            HasSubstr("<ssv:Int64 value=\"-9223372036854775807\" />"),
                            HasSubstr("<ssv:Float32 value=\"0.1\" />"), HasSubstr("<ssv:UInt8 value=\"255\" />")));
  EXPECT_THAT(entry("SystemStructure.ssd"), AllOf(HasSubstr("version=\"2.0\""), HasSubstr("<ssc:UInt64 />")));
}

TEST_F(Ssp3, ArraysBinariesAndSizesKeepTheirValues) {
  expect_same(
      fmt::format(R"("a": {{"fmu": "{0}", "parameters": {{"lines": 3, "line.initial[1]": 1, "line.initial[2]": 7,
      "line.initial[3]": -2.5, "line.u[1]": 2, "line.u[2]": 0, "line.u[3]": -2, "line.label[1]": "x y",
      "line.label[2]": "", "line.label[3]": "ä<", "line.mode[1]": "hold", "line.mode[2]": "integrate",
      "line.mode[3]": 1, "line.message[1]": "0aff00", "line.message[2]": "", "line.message[3]": "01"}}}},
    "b": {{"fmu": "{0}", "parameters": {{"lines": 3}}}}, "c": {{"fmu": "{0}"}})",
                  BANK_FMU),
      R"({"from": "a.line.y", "to": "b.line.u", "convert_units": false},
         {"from": "a.line.y[3]", "to": "c.line.u[2]", "factor": 2, "convert_units": false},
         {"from": "a.line.echo[1]", "to": "c.line.message[1]"})",
      R"(["*", "a.labels", "c.line.echo[1]"])");
  const auto values = entry("resources/a.ssv");
  EXPECT_THAT(values, AllOf(HasSubstr("<ssv:UInt64 value=\"3\" />"), HasSubstr("value=\"1 7 -2.5\""),
                            HasSubstr("<ssc:Dimension size=\"3\" />"), HasSubstr("<ssv:Value value=\"0aff00\" />")));
  EXPECT_THAT(entry("SystemStructure.ssd"),
              AllOf(HasSubstr("startConnector=\"line.y\" endElement"), HasSubstr("startIndices=\"3\""),
                    HasSubstr("endIndices=\"2\""), HasSubstr("mime-type=\"application/octet-stream\"")));
}

TEST_F(Ssp3, TicksOfClocksPassOn) {
  expect_same(fmt::format(R"("a": {{"fmu": "{0}"}}, "b": {{"fmu": "{0}"}}, "c": {{"fmu": "{0}"}})", METRONOME_FMU),
              R"({"from": "a.tock", "to": "b.tap"}, {"from": "a.tock_time", "to": "b.heard"},
                 {"from": "a.beat", "to": "c.tap"})",
              R"(["*"])");
  EXPECT_THAT(test::read_file(folder.path() / "two/results.csv"), HasSubstr(",3,"));
  EXPECT_THAT(entry("SystemStructure.ssd"), HasSubstr("<ssc:Clock intervalVariability=\"triggered\" />"));
}

TEST_F(Ssp3, BinariesPassBetweenVersionsAndNarrowConnectionsStay) {
  expect_same(fmt::format(R"("a": {{"fmu": "{0}"}}, "b": {{"fmu": "{1}"}}, "c": {{"fmu": "{2}"}},
                             "d": {{"fmu": "{2}", "parameters": {{"wide": 0.1}}}})",
                          PROBE_FMU, BANK_FMU, WIDTHS_FMU),
              R"({"from": "a.buffer", "to": "b.line.message[1]"},
                 {"from": "d.wide_out", "to": "c.single", "narrow": true})",
              R"(["*", "b.line.echo[1]"])");
  EXPECT_THAT(entry("SystemStructure.ssd"), HasSubstr("startConnector=\"buffer\""));
}

/// Tests connections of elements of a nested system's array connectors (startIndices and endIndices of SSP 2.0).
class SspIndices : public Ssp {
 protected:
  /// Returns an SSD with the component `b` and the system `sub` of the components `a` and `c`.
  static std::string system(const std::string& inside, const std::string& outside, const std::string& values = "") {
    const auto connector = [](const char* name, const char* kind) {
      return fmt::format(
          R"(<ssd:Connector name="{}" kind="{}"><ssc:Float64/><ssc:Dimension size="2"/></ssd:Connector>)", name, kind);
    };
    const auto component = [](const char* name) {
      return fmt::format(R"(<ssd:Component name="{}" source="resources/bank.fmu"/>)", name);
    };
    return fmt::format(R"(<ssd:Elements>{}<ssd:System name="sub"><ssd:Connectors>{}{}</ssd:Connectors>{}
      <ssd:Elements>{}{}</ssd:Elements><ssd:Connections>{}</ssd:Connections></ssd:System></ssd:Elements>
      <ssd:Connections>{}</ssd:Connections>)",
                       component("b"), connector("u", "input"), connector("y", "output"), values, component("a"),
                       component("c"), inside, outside);
  }
  /// Returns a connection. Its ends are texts such as "a line.y 2"; "-" is the system itself.
  static std::string connection(const std::string& from, const std::string& to, const std::string& inner = "") {
    std::string text = "<ssd:Connection";
    for (const auto& [side, end] : {std::pair("start", from), std::pair("end", to)}) {
      std::istringstream words(end);
      std::string element, connector, indices;
      words >> element >> connector >> indices;
      if (element != "-") text += fmt::format(" {}Element=\"{}\"", side, element);
      text += fmt::format(" {}Connector=\"{}\"", side, connector);
      if (!indices.empty()) text += fmt::format(" {}Indices=\"{}\"", side, indices);
    }
    return text + " suppressUnitConversion=\"true\">" + inner + "</ssd:Connection>";
  }
  static std::vector<std::string> connections(const SystemDescription& system) {
    std::vector<std::string> texts;
    for (const auto& one : system.connections) {
      texts.push_back(fmt::format("{}.{} -> {}.{} {}", one.from.instance, one.from.variable, one.to.instance,
                                  one.to.variable, one.factor));
    }
    return texts;
  }
};

TEST_F(SspIndices, ElementsOutsideAndTheWholeArrayInside) {
  const auto loaded = load(
      system(connection("- u", "a line.u") + connection("a line.y", "- y", R"(<ssc:LinearTransformation factor="2"/>)"),
             connection("sub y 2", "b line.u 1", R"(<ssc:LinearTransformation factor="3"/>)") +
                 connection("b line.y 1", "sub u 2")));
  EXPECT_THAT(connections(loaded.system),
              testing::UnorderedElementsAre("sub.a.line.y[2] -> b.line.u[1] 6", "b.line.y[1] -> sub.a.line.u[2] 1"));
  FmuLibrary library;
  EXPECT_NO_THROW(resolve(loaded.system, library));
}

TEST_F(SspIndices, TheWholeArrayOutsideAndElementsInside) {
  const auto loaded = load(system(connection("- u 2", "a line.u 1") + connection("- u 1", "c line.u 2") +
                                      connection("a line.y 2", "- y 1") + connection("c line.y 1", "- y 2"),
                                  connection("sub y", "b line.u") + connection("b line.y", "sub u")));
  EXPECT_THAT(connections(loaded.system),
              testing::UnorderedElementsAre("sub.a.line.y[2] -> b.line.u[1] 1", "sub.c.line.y[1] -> b.line.u[2] 1",
                                            "b.line.y[2] -> sub.a.line.u[1] 1", "b.line.y[1] -> sub.c.line.u[2] 1"));
}

TEST_F(SspIndices, ElementsOnBothSides) {
  const auto loaded = load(system(connection("a line.y 1", "- y 2"),
                                  connection("sub y 2", "b line.u 1") + connection("sub y 1", "b line.u 2")));
  EXPECT_THAT(connections(loaded.system), testing::ElementsAre("sub.a.line.y[1] -> b.line.u[1] 1"));
  EXPECT_THAT(loaded.system.notices, testing::Contains(HasSubstr("\"sub.y[1]\", which has no source")));
}

TEST_F(SspIndices, ValuesOfAnArrayConnectorAreThoseOfItsElements) {
  const auto values = [](const std::string& name) {
    return fmt::format(R"(<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
      <ssv:ParameterSet version="2.0" name="p"><ssv:Parameters><ssv:Parameter name="{}"><ssv:Float64 value="3 4"/>
      <ssc:Dimension size="2"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>
      </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>)",
                       name);
  };
  const auto scaled = connection("- u", "a line.u", R"(<ssc:LinearTransformation factor="2"/>)");
  auto loaded = load(system(scaled, "", values("u")));
  EXPECT_EQ(loaded.config["instances"]["sub.a"]["parameters"],
            nlohmann::ordered_json::parse(R"({"line.u[1]": 6, "line.u[2]": 8})"));
  loaded = load(system(connection("- u 2", "c line.u 1"), "", values("u")));
  EXPECT_EQ(loaded.config["instances"]["sub.c"]["parameters"], nlohmann::ordered_json::parse(R"({"line.u[1]": 4})"));
  loaded = load(system(connection("- u", "a line.u"), connection("b line.y 1", "sub u 2"), values("u")));
  EXPECT_EQ(loaded.config["instances"]["sub.a"]["parameters"], nlohmann::ordered_json::parse(R"({"line.u[1]": 3})"));
  EXPECT_THAT(connections(loaded.system), testing::ElementsAre("b.line.y[1] -> sub.a.line.u[2] 1"));
  // If the connector of `sub` gets its value from a connection outside `sub`, the values in the file have no effect on
  // it.
  loaded = load(system(scaled, connection("b line.y", "sub u"), values("a.line.u")));
  EXPECT_FALSE(loaded.config["instances"]["sub.a"].contains("parameters"));
  EXPECT_THAT(loaded.system.notices, testing::Contains(HasSubstr("gets its value from b.line.y (2): ")));
}

TEST_F(SspIndices, ContradictionsAreRefused) {
  EXPECT_THAT(error_of(system(connection("a line.y", "- y") + connection("c line.y 1", "- y 2"), "")),
              AllOf(HasSubstr("\"sub.y[2]\" has two sources"), HasSubstr("that of the whole array")));
  EXPECT_THAT(error_of(system(connection("a line.y 1", "- y"), connection("sub y 2", "b line.u 1"))),
              HasSubstr("connect elements with elements, or whole arrays"));
  EXPECT_THAT(
      error_of(system(connection("- u", "- y"), connection("sub y", "sub u") + connection("sub y 2", "b line.u 1"))),
      HasSubstr("in a circle"));
}

TEST_F(Ssp3, AnArrayWithAnUnknownElementIsRefusedByName) {
  test::write_file(folder.path() / "first.json", fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{
    "a": {{"fmu": "{}", "parameters": {{"lines": 3, "line.initial[2]": 7}}}}}}, "connections": []}})",
                                                             BANK_FMU));
  const auto result = run({"convert", "first.json", "second.ssp"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("instance 'a'"), HasSubstr("'line.initial[1]'"),
                                HasSubstr("Give a value to each element of 'line.initial'")));
}

}  // namespace
}  // namespace mebots::master
