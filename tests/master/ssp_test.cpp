// SPDX-License-Identifier: Apache-2.0
// SSP 1.0 as a second door: what others write runs here, and what we write says the same as the config.
#include "ssp/ssp.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

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
  /// Packs an SSP: an SSD around `system`, the test FMUs, and more files.
  std::filesystem::path ssp(const std::string& system, const std::map<std::string, std::string>& files = {},
                            const std::string& tail = kTail) {
    test::write_file(folder.path() / "SystemStructure.ssd", kHead + system + tail);
    std::vector<modeldesc::PackedFile> packed{{"SystemStructure.ssd", folder.path() / "SystemStructure.ssd"},
                                              {"resources/coupling.fmu", COUPLING_FMU},
                                              {"resources/my probe.fmu", PROBE_FMU}};
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

TEST_F(Ssp, WhatCannotBeUsedIsSaidWithFileAndLine) {
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a"/></ssd:Elements>)"),
              AllOf(HasSubstr("test.ssp: SystemStructure.ssd, line 5"), HasSubstr("\"a\" has no source")));
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a" source="../x.fmu"/></ssd:Elements>)"),
              HasSubstr("is not inside the SSP"));
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a" source="file:///etc/passwd"/></ssd:Elements>)"),
              HasSubstr("is absolute"));
  EXPECT_THAT(error_of(R"(<ssd:Elements><ssd:Component name="a" source="resources/none.fmu"/></ssd:Elements>)"),
              HasSubstr("holds no file \"resources/none.fmu\""));
  EXPECT_THAT(
      error_of(
          two() +
          R"(<ssd:Connections><ssd:Connection startElement="c" startConnector="y" endElement="a" endConnector="u"/></ssd:Connections>)"),
      HasSubstr("no element \"c\""));
  EXPECT_THAT(error_of(two(), R"(</ssd:System></ssd:SystemStructureDescription>)"), HasSubstr("give it with --step"));
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

class Osp : public Ssp {
 protected:
  /// A system of two coupling FMUs around `connections`, in a folder of its own.
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
  EXPECT_THAT(loaded.system.notices, testing::Contains(HasSubstr("\"ecco\" is left out")));
  EXPECT_EQ(run({"run", "truck"}).code, 0);
  EXPECT_EQ(run({"info", "truck/OspSystemStructure.xml"}).code, 0);
  EXPECT_EQ(run({"convert", "truck", "truck.json"}).code, 0);
  EXPECT_EQ(run({"run", "truck.json"}).code, 0);
}

TEST_F(Osp, WhatCannotBeUsedIsSaidWithItsLine) {
  EXPECT_THAT(
      refused(
          R"(<VariableConnection><Variable simulator="a" name="mass_x"/><Variable simulator="b" name="mass_x"/></VariableConnection>)"),
      AllOf(HasSubstr("OspSystemStructure.xml, line 11"), HasSubstr("one must be an output and the other an input")));
  EXPECT_THAT(
      refused(
          R"(<VariableConnection><Variable simulator="c" name="mass_x"/><Variable simulator="b" name="mass_u"/></VariableConnection>)"),
      HasSubstr("no simulator \"c\""));
  EXPECT_THAT(
      refused(
          R"(<VariableGroupConnection><VariableGroup simulator="a" name="on"/><VariableGroup simulator="b" name="in"/></VariableGroupConnection>)"),
      HasSubstr("has no group \"on\""));
  EXPECT_THAT(refused("<SignalConnection/>"), HasSubstr("SignalConnection cannot be used"));
  EXPECT_THAT(test::input_error([&] { load_system(osp("", "")); }), HasSubstr("give it with --stop-time"));
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

/// A value of a connector of the root system, with what hangs on it.
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
  EXPECT_THAT(error_of(with_value(R"(<ssv:Integer value="3e9"/>)", "")), HasSubstr("whole number of 32 bits"));
  EXPECT_THAT(error_of(with_value(R"(<ssv:Enumeration value="1.5"/>)", "")), HasSubstr("whole number of 32 bits"));
  EXPECT_THAT(error_of(with_value(R"(<ssv:String value="&#xD800;"/>)", "")), HasSubstr("not a character of XML"));
}

TEST_F(Ssp, AnInputThatFitsNothingIsAnsweredWithThePlaceInTheSsd) {
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
  // Written twice, the same bytes.
  EXPECT_EQ(run({"convert", "third.json", "fourth.ssp"}).code, 0);
  EXPECT_EQ(run({"convert", "fourth.ssp", "fifth.json"}).code, 0);
  const auto json = [&](const std::string& name) {
    auto config = nlohmann::json::parse(test::read_file(folder.path() / name));
    for (auto& instance : config["instances"]) instance.erase("fmu");
    return config;
  };
  EXPECT_EQ(json("third.json"), json("fifth.json"));
}

}  // namespace
}  // namespace mebots::master
