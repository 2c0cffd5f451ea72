// SPDX-License-Identifier: Apache-2.0
// Tests that wrong data files are rejected, with a message that names file, key, value and limit.
#include "support.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace mebots::battery {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class DataFile : public testing::Test {
 protected:
  DataFile() {
    std::ifstream stream(kParams / "cells" / "bitcraze_250.json");
    json = nlohmann::json::parse(stream);
  }

  std::string refused() {
    write(json.dump());
    return error_of([&] { load_cell(path); });
  }
  void write(const std::string& text) const { std::ofstream(path) << text; }

  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".json");
  nlohmann::json json;
};

TEST_F(DataFile, UnchangedIsAccepted) {
  write(json.dump());
  EXPECT_EQ(load_cell(path).name, "Bitcraze 250 mAh");
}

TEST_F(DataFile, NegativeMassIsRefused) {
  json["mass"]["value"] = -0.0071;
  EXPECT_THAT(refused(), AllOf(HasSubstr(path.string()), HasSubstr("/mass/value: -0.0071 must be > 0")));
}

TEST_F(DataFile, ZeroCapacityIsRefused) {
  json["capacity"]["value"] = 0;
  EXPECT_THAT(refused(), HasSubstr("/capacity/value: 0 must be > 0"));
}

TEST_F(DataFile, CapacityFactorMultipliesTheCapacity) {
  json["capacity_factor"] = {{"value", 0.8}, {"unit", "1"}, {"source", "aged"}, {"interval", {0.7, 0.9}}};
  write(json.dump());
  EXPECT_DOUBLE_EQ(load_cell(path).capacity_c, 0.8 * 900);
}

TEST_F(DataFile, IntervalAndFittedOnAreAccepted) {
  json["mass"]["interval"] = {0.007, 0.0072};
  json["mass"]["fitted_on"] = "scales";
  json["series_resistance"]["fitted_on"] = "flights";
  write(json.dump());
  EXPECT_EQ(load_cell(path).mass_kg, 0.0071);
}

TEST_F(DataFile, IntervalWithoutItsValueIsRefused) {
  json["mass"]["interval"] = {0.0072, 0.008};
  EXPECT_THAT(refused(), HasSubstr("/mass/interval: the interval from 0.0072 to 0.008 must contain the value, 0.0071"));
}

TEST_F(DataFile, MissingKeyIsRefused) {
  json.erase("cut_off_voltage");
  EXPECT_THAT(refused(), HasSubstr("the key 'cut_off_voltage' is missing"));
}

TEST_F(DataFile, MistypedKeyIsRefused) {
  json["pair3_resistance"] = json["pair2_resistance"];
  EXPECT_THAT(refused(), HasSubstr("/pair3_resistance: the key 'pair3_resistance' is unknown. Did you mean"));
}

TEST_F(DataFile, WrongTypeIsRefused) {
  json["capacity"]["value"] = "250 mAh";
  EXPECT_THAT(refused(), HasSubstr("/capacity/value: a number is expected here, not \"250 mAh\""));
  json["capacity"] = 900;
  EXPECT_THAT(refused(), HasSubstr("/capacity: an object is expected here, not 900"));
}

TEST_F(DataFile, WrongUnitIsRefused) {
  json["capacity"] = {{"value", 250}, {"unit", "mAh"}, {"source", "label"}};
  EXPECT_THAT(refused(), HasSubstr("/capacity/unit: the unit \"mAh\" must be \"C\""));
}

TEST_F(DataFile, MissingSourceIsRefused) {
  json["mass"]["source"] = "";
  EXPECT_THAT(refused(), HasSubstr("/mass/source: the source is empty"));
}

TEST_F(DataFile, TableThatDoesNotRiseIsRefused) {
  json["open_circuit_voltage"] = {{"unit", "V"}, {"state_of_charge", {0, 0.6, 0.5, 1}}, {"value", {3, 3.5, 3.7, 4.2}}};
  EXPECT_THAT(refused(),
              HasSubstr("/open_circuit_voltage/state_of_charge/2: 0.5 must be greater than the value before it, 0.6"));
}

TEST_F(DataFile, OpenCircuitVoltageThatFallsIsRefused) {
  json["open_circuit_voltage"] = {{"unit", "V"}, {"state_of_charge", {0, 0.5, 1}}, {"value", {3, 3.9, 3.8}}};
  EXPECT_THAT(refused(), HasSubstr("/open_circuit_voltage: the curve falls"));
}

TEST_F(DataFile, TableOfUnequalLengthsIsRefused) {
  json["series_resistance"] = {{"unit", "Ohm"}, {"state_of_charge", {0, 1}}, {"value", {0.1, 0.1, 0.1}}};
  EXPECT_THAT(refused(), HasSubstr("/series_resistance/value: there are 3 entries here, but 2 in state_of_charge"));
}

TEST_F(DataFile, NegativeResistanceAnywhereIsRefused) {
  json["series_resistance"] = {{"unit", "Ohm"}, {"exponential", {0, 1}}, {"polynomial", {0.1, -0.2}}};
  EXPECT_THAT(refused(), HasSubstr("/series_resistance: the curve is"));
}

TEST_F(DataFile, CutOffAboveTheFullCellIsRefused) {
  json["cut_off_voltage"]["value"] = 4.5;
  EXPECT_THAT(refused(), HasSubstr("/cut_off_voltage: the cut-off of 4.5 V must be below"));
}

TEST_F(DataFile, TruncatedFileIsRefused) {
  write(json.dump().substr(0, 300));
  EXPECT_THAT(error_of([&] { load_cell(path); }), AllOf(HasSubstr(path.string()), HasSubstr("is not JSON")));
}

TEST_F(DataFile, NumberBeyondAllNumbersIsRefused) {
  write(R"({"cut_off_voltage": 1e999})");
  EXPECT_THAT(error_of([&] { load_cell(path); }),
              AllOf(HasSubstr(path.string()), HasSubstr("too large"), HasSubstr("1e999")));
}

TEST_F(DataFile, TablesGiveACellThatWorks) {
  json["open_circuit_voltage"] = {{"unit", "V"}, {"state_of_charge", {0, 0.5, 1}}, {"value", {3.2, 3.8, 4.2}}};
  write(json.dump());
  const Cell cell = load_cell(path);
  EXPECT_DOUBLE_EQ(cell.circuit_at(0.25).open_circuit_v, 3.5);
  EXPECT_DOUBLE_EQ(cell.circuit_at(0.75).open_circuit_v, 4.0);
  EXPECT_DOUBLE_EQ(cell.circuit_at(1).open_circuit_v, 4.2);
  Bench bench(parameters(path.string(), 0.6), {});
  bench.inputs.load_power_w[load::motors] = 6;
  for (int i = 0; i < 100; ++i) bench.step(kSecond);
  EXPECT_LT(bench.outputs.cell_state_of_charge, 0.5);
  EXPECT_NEAR(bench.outputs.energy_imbalance_j, 0, 1e-9);
}

TEST_F(DataFile, UnknownCellListsTheKnownOnes) {
  EXPECT_THAT(error_of([] { Bench{parameters("bitcraze", 1)}; }),
              AllOf(HasSubstr("cell.name = \"bitcraze\""), HasSubstr("Did you mean 'bitcraze_250'")));
  EXPECT_THAT(error_of([] { Bench{parameters("/nowhere/cell.json", 1)}; }), HasSubstr("there is no such file"));
}

TEST_F(DataFile, ConverterTableAboveUnityIsRefused) {
  write(R"({"core": {"source": "x", "output_voltage": {"value": 1, "unit": "V", "source": "x"},
            "output_current": {"unit": "A", "value": [0.1, 0.2]}, "efficiency": {"unit": "1", "value": [0.9, 1.1]}}})");
  EXPECT_THAT(error_of([&] { load_converter(path, "core", "soc.converter"); }),
              HasSubstr("/core/efficiency/value/1: 1.1 must be > 0 and <= 1"));
}

TEST_F(DataFile, ConverterTableThatCannotBeInvertedIsRefused) {
  write(R"({"core": {"source": "x", "output_voltage": {"value": 1, "unit": "V", "source": "x"},
            "output_current": {"unit": "A", "value": [0.1, 0.2]}, "efficiency": {"unit": "1", "value": [0.1, 0.9]}}})");
  EXPECT_THAT(error_of([&] { load_converter(path, "core", "soc.converter"); }),
              HasSubstr("a larger output would need a smaller input"));
}

}  // namespace
}  // namespace mebots::battery
