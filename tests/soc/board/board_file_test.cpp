// SPDX-License-Identifier: Apache-2.0
#include "board/board_file.hpp"
#include "soc/system_bus.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>
#include <cstdint>
#include <filesystem>
#include <fstream>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;

/// Returns the error of read_board(); empty if it accepts the board.
std::string complaint(std::string_view memories, std::string_view devices, std::string_view more = "") {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("mebots-board-{}.json", getpid());
  std::ofstream(path) << fmt::format(R"({{"name": "b", {} "memories": [{}], "devices": [{}]}})", more, memories,
                                     devices);
  std::string text;
  try {
    read_board(path);
  } catch (const Error& error) {
    text = error.what();
    EXPECT_THAT(text, HasSubstr(path.filename().string())) << "names the file";
  }
  std::filesystem::remove(path);
  return text;
}

constexpr auto kRam = R"({"name": "ram", "base": "0x1000", "size": 4096})";

std::string device(std::string_view more, std::string_view name = "d", std::string_view base = "0x8000") {
  return fmt::format(
      R"({{"name": "{}", "base": "{}", {} "registers": [{{"name": "R", "offset": "0x4", "access": "r"}}]}})", name,
      base, more);
}

TEST(BoardFile, OfTheRepositoryAreGood) {
  for (const auto* name : {"ai_deck", "gap8", "gap8_bare", "pulp_open", "ri5cy", "virt"}) {
    EXPECT_EQ(read_board(fmt::format("{}/configs/boards/{}.json", MEBOTS_SOURCE_DIR, name)).name, name);
  }
}

/// A program for a real GAP8 must not access MEbots' own devices by mistake. Programs also access devices of GAP8 that
/// board gap8 does not model.
TEST(BoardFile, KeepsOurDevicesAtAddressesThatGap8LeavesFree) {
  const auto board = [](std::string_view path) { return read_board(fmt::format("{}/{}", MEBOTS_SOURCE_DIR, path)); };
  const auto gap8 = board("configs/boards/gap8.json");
  for (const auto* path : {"configs/boards/ai_deck.json", "configs/boards/gap8_bare.json", "examples/rover/board.json",
                           "examples/time_of_flight/board.json"}) {
    for (const auto& ours : board(path).devices) {
      if (!ours.is_on_bus()) continue;
      for (std::uint32_t offset = 0; offset < ours.size(); offset += 4) {
        EXPECT_FALSE(UnmodelledRegisters::are_at(ours.base + offset))
            << path << ": " << ours.name << " is among GAP8's peripherals, " << offset << " bytes after its base";
      }
      for (const auto& theirs : gap8.devices) {
        if (!theirs.is_on_bus()) continue;
        auto places = theirs.also_at;
        places.push_back(theirs.base);
        for (const auto place : places) {
          EXPECT_TRUE(ours.base >= place + theirs.size() || place >= ours.base + ours.size())
              << path << ": " << ours.name << " stands on GAP8's " << theirs.name;
        }
      }
    }
  }
}

TEST(BoardFile, RefusesInterruptsThatTheCoreLacks) {
  for (const int line : {3, 7, 11, 16, 31}) {
    EXPECT_EQ(complaint(kRam, device(fmt::format("\"interrupt\": {},", line))), "");
  }
  for (const int line : {0, 4, 12, 15}) {
    EXPECT_THAT(complaint(kRam, device(fmt::format("\"interrupt\": {},", line))),
                HasSubstr("/devices/0/interrupt: the core has no interrupt " + std::to_string(line)));
  }
  EXPECT_THAT(complaint(kRam, device("\"interrupt\": 32,")), HasSubstr("/devices/0/interrupt: 32"));
  EXPECT_THAT(complaint(kRam, device("\"interrupt\": 7.5,")), HasSubstr("whole number"));
}

TEST(BoardFile, NamesBothDevicesThatShareAnInterrupt) {
  const auto left = device("\"interrupt\": 17,", "left", "0x8000");
  EXPECT_THAT(complaint(kRam, left + "," + device("\"interrupt\": 17,", "right", "0x9000")),
              HasSubstr("/devices/1/interrupt: left and right use the same interrupt 17"));
  EXPECT_EQ(complaint(kRam, left + "," + device("\"interrupt\": 18,", "right", "0x9000")), "");
}

TEST(BoardFile, ReadsTheChipsSupplyFromAnInput) {
  const auto gauge = device(
      R"("variables": [{"name": "pack.voltage", "causality": "input", "unit": "V", "start": 7.4, "text": ""}],)");
  EXPECT_EQ(complaint(kRam, gauge, R"("supply": {"voltage": "pack.voltage", "least": 5},)"), "");
  EXPECT_THAT(complaint(kRam, gauge, R"("supply": {"voltage": "pack.volts", "least": 5},)"),
              HasSubstr("/supply/voltage: the Real input 'pack.volts' is unknown. Did you mean 'pack.voltage'?"));
  EXPECT_THAT(complaint(kRam, gauge, R"("supply": {"voltage": "pack.voltage", "least": 0},)"),
              HasSubstr("/supply/least"));
}

TEST(BoardFile, RefusesLibrariesInOtherFolders) {
  EXPECT_EQ(complaint(kRam, "", R"("libraries": ["wheels.so"],)"), "");
  EXPECT_THAT(complaint(kRam, "", R"("libraries": ["../wheels.so"],)"), HasSubstr("/libraries/0"));
}

TEST(BoardFile, NeedsRegistersOfADeviceUnlessItsKindHasThem) {
  EXPECT_EQ(complaint(kRam, R"({"name": "d", "kind": "k", "base": "0x8000", "span": 4096})"), "");
  EXPECT_THAT(complaint(kRam, R"({"name": "d", "base": "0x8000", "span": 4096})"), HasSubstr("'registers' is missing"));
  EXPECT_THAT(complaint(kRam, R"({"name": "d", "kind": "k", "base": "0x8000"})"), HasSubstr("'registers' is missing"));
  EXPECT_THAT(
      complaint(kRam, R"({"name": "d", "kind": "k", "base": "0x8000", "span": 4096},)" + device("", "e", "0x8800")),
      HasSubstr("overlaps d"));
}

TEST(BoardFile, RefusesAddressesOfParts) {
  const auto part = [](std::string_view more) {
    return fmt::format(R"({{"name": "p", "supply_voltage": 1.8, "part": {{}} {}}})", more);
  };
  EXPECT_EQ(complaint(kRam, part("")), "");
  EXPECT_THAT(complaint(kRam, part(R"(, "base": "0x8000")")), HasSubstr("remove the key 'base'"));
  EXPECT_EQ(complaint(kRam, part(R"(, "kind": "part")")), "");
  for (const auto* kind : {"camera", "described", "regulator"}) {
    const auto text = complaint(kRam, part(fmt::format(R"(, "kind": "{}")", kind)));
    EXPECT_THAT(text, HasSubstr("/devices/0/kind"));
    EXPECT_THAT(text, HasSubstr(fmt::format("p has the key 'part', so its kind is \"part\", not \"{}\"", kind)));
  }
  EXPECT_THAT(complaint(kRam, R"({"name": "r", "kind": "part", "regulator": {"loads": ["chip"], "efficiency": 1}})"),
              HasSubstr("its kind is \"regulator\", not \"part\": remove the key 'kind'"));
  EXPECT_THAT(complaint(kRam, part(R"(, "interrupt": 7)")), HasSubstr("remove the key 'interrupt'"));
  EXPECT_THAT(complaint(kRam, R"({"name": "p", "part": {}})"), HasSubstr("'supply_voltage' is missing"));
  EXPECT_THAT(complaint(kRam, R"({"name": "p", "supply_voltage": 1, "part": {"charge_per_byte": 1}})"),
              HasSubstr("'attached_to' is missing"));
  EXPECT_THAT(complaint(kRam, R"({"name": "p", "supply_voltage": 1, "part": {"attached_to": "dd.x"}},)" + device("")),
              HasSubstr("dd"));
  EXPECT_THAT(complaint(kRam, part(R"(, "states": {"on": {"current": 1}})")), HasSubstr("'initial_state' is missing"));
  EXPECT_THAT(complaint(kRam, part(R"(, "variables": [{"name": "q", "causality": "output"}])")),
              HasSubstr("p.power or p.energy"));
}

TEST(BoardFile, RefusesRegulatorsBeforeTheirLoads) {
  const auto regulator = [&](std::string_view name, std::string_view loads, double efficiency = 1) {
    return fmt::format(R"({{"name": "{}", "regulator": {{"loads": [{}], "efficiency": {}}}}})", name, loads,
                       efficiency);
  };
  EXPECT_EQ(complaint(kRam, regulator("r", "\"chip\"") + "," + regulator("s", "\"r\"", 0.5)), "");
  EXPECT_THAT(complaint(kRam, regulator("r", "\"r\"")), HasSubstr("/devices/0/regulator/loads/0"));
  EXPECT_THAT(complaint(kRam, regulator("r", "\"s\"") + "," + regulator("s", "\"chip\"")), HasSubstr("s"));
  EXPECT_THAT(complaint(kRam, regulator("r", "\"chip\"") + "," + regulator("s", "\"chip\"")),
              HasSubstr("chip already has a regulator"));
  EXPECT_THAT(complaint(kRam, regulator("r", "\"chip\"", 1.1)), HasSubstr("efficiency"));
  EXPECT_THAT(complaint(kRam, regulator("r", "\"chip\"", 0)), HasSubstr("efficiency"));
}

TEST(BoardFile, RefusesOverlaps) {
  EXPECT_THAT(complaint(std::string(kRam) + R"(, {"name": "more", "base": "0x1FFC", "size": 16})", ""),
              HasSubstr("/memories/1: more (0x00001ffc to 0x0000200b) overlaps ram"));
  EXPECT_THAT(complaint(kRam, device("", "d", "0x1FFC")), HasSubstr("/devices/0: d ("));
  EXPECT_THAT(complaint(kRam, device("") + "," + device("", "e", "0x8004")), HasSubstr("overlaps d"));
  EXPECT_THAT(complaint(kRam, device("", "d", "0xFFFFFFFC")), HasSubstr("end of the 32-bit address space"));
}

TEST(BoardFile, RefusesUnknownAndRepeatedKeysAndNames) {
  EXPECT_THAT(complaint(kRam, device("\"irq\": 7,")), HasSubstr("/devices/0/irq"));
  EXPECT_THAT(complaint(R"({"name": "ram", "name": "ram", "base": "0x1000", "size": 4096})", ""),
              HasSubstr("/memories/0/name: the key 'name' occurs twice"));
  EXPECT_THAT(complaint(kRam, device("") + "," + device("", "d", "0x9000")), HasSubstr("is already used"));
  EXPECT_THAT(complaint(kRam, device("", "2nd")), HasSubstr("a letter first"));
  EXPECT_THAT(complaint(kRam, "", R"("core": "z80",)"), HasSubstr("/core: no core is named \"z80\""));
  EXPECT_THAT(complaint(kRam, "", R"("cluster_cores": 9,)"), HasSubstr("/cluster_cores: 9"));
}

TEST(BoardFile, NamesTheOptionsOfItsCore) {
  const auto read = [](std::string_view keys) {
    return parse_board(fmt::format(R"({{"name": "b", {} "memories": [{}], "devices": []}})", keys, kRam), "b.json");
  };
  const auto board = read(R"("core": "cv32e40p", "isa": "rv32imacu_zba",)");
  EXPECT_EQ(board.core, "cv32e40p");
  EXPECT_EQ(board.isa, Extensions(Extension::a).with(Extension::user).with(Extension::zba));
  EXPECT_EQ(board.pmp_entries, 16U);
  EXPECT_EQ(read(R"("core": "rv32imfc",)").isa, Extension::f);
  EXPECT_EQ(read(R"("core": "rv32imcu", "pmp_entries": 4,)").pmp_entries, 4U);
  EXPECT_EQ(read("").pmp_entries, 0U);
  EXPECT_THAT(complaint(kRam, "", R"("isa": "rv32imdc",)"), HasSubstr("/isa: the instruction set \"rv32imdc\": 'd'"));
  EXPECT_THAT(complaint(kRam, "", R"("core": "rv32imac", "isa": "rv32imc",)"), HasSubstr("leave isa out"));
  EXPECT_THAT(complaint(kRam, "", R"("pmp_entries": 17,)"), HasSubstr("/pmp_entries: 17"));
  EXPECT_THAT(complaint(kRam, "", R"("isa": "rv32imac", "cluster_cores": 8,)"), HasSubstr("/cluster_cores: a board"));
}

TEST(BoardFile, RefusesInvalidAddresses) {
  EXPECT_THAT(complaint(R"({"name": "ram", "base": "0x1001", "size": 4096})", ""), HasSubstr("multiple of 4"));
  for (const char* base : {"here", "", "0x", "-4", " 4096", "4096 ", "0x100000000", "010000"}) {
    EXPECT_THAT(complaint(fmt::format(R"({{"name": "ram", "base": "{}", "size": 4096}})", base), ""),
                HasSubstr("32-bit address"))
        << base;
  }
  for (const char* base : {"4096", "0", "0X1000"}) {
    EXPECT_EQ(complaint(fmt::format(R"({{"name": "ram", "base": "{}", "size": 4096}})", base), ""), "") << base;
  }
  EXPECT_THAT(complaint(R"({"name": "ram", "base": "0x1000", "size": 4098})", ""), HasSubstr("/memories/0/size"));
}

TEST(BoardFile, RequiresAVoltageForStatesWithCurrents) {
  EXPECT_THAT(complaint(kRam, device(R"("states": {"on": {"current": 1e-3}},)")),
              HasSubstr("the key 'supply_voltage' is missing"));
}

TEST(BoardFile, AllowsLatenciesOnlyForMemoriesOutsideTheCluster) {
  constexpr auto kWay = R"("way": {"fabric_controller": 8, "cluster": 2, "soc": 17})";
  const auto memory = [&](std::string_view more) {
    return fmt::format(R"({{"name": "ram", "base": "0x1000", "size": 4096, {}}})", more);
  };
  EXPECT_EQ(complaint(memory(kWay), ""), "");
  EXPECT_THAT(complaint(memory(fmt::format(R"("place": "cluster", {})", kWay)), ""),
              HasSubstr("the cluster's memory has no 'way'"));
  EXPECT_THAT(complaint(memory(R"("way": {"fabric_controller": 8, "cluster": 2})"), ""), HasSubstr("'soc'"));
  EXPECT_THAT(complaint(memory(R"("way": {"fabric_controller": -1, "cluster": 2, "soc": 1})"), ""),
              HasSubstr("/memories/0/way/fabric_controller"));
}

TEST(BoardFile, AllowsAnArbitrationTreeOnlyForTheClustersMemory) {
  const auto memory = [](std::string_view place) {
    return fmt::format(R"({{"name": "ram", "base": "0x1000", "size": 4096, "place": "{}", "arbitration_tree": true}})",
                       place);
  };
  EXPECT_EQ(complaint(memory("cluster"), ""), "");
  EXPECT_THAT(complaint(memory("fabric_controller"), ""), HasSubstr("only the cluster's own memory can have this key"));
}

TEST(BoardFile, AllowsAQuantumOnlyForTheClustersMemory) {
  const auto memory = [](std::string_view place, int quantum) {
    return fmt::format(R"({{"name": "ram", "base": "0x1000", "size": 4096, "place": "{}", "quantum": {}}})", place,
                       quantum);
  };
  EXPECT_EQ(complaint(memory("cluster", 1), ""), "");
  EXPECT_EQ(complaint(memory("cluster", 1024), ""), "");
  for (const auto quantum : {0, 1025}) {
    EXPECT_THAT(complaint(memory("cluster", quantum), ""),
                HasSubstr(fmt::format("/memories/0/quantum: {} must be a whole number from 1 to 1024", quantum)));
  }
  EXPECT_THAT(complaint(memory("fabric_controller", 64), ""),
              HasSubstr("only the cluster's own memory can have this key"));
}

TEST(BoardFile, AllowsSocCyclesOnlyForTheClustersCache) {
  const auto caches = [](std::string_view place) {
    return fmt::format(R"("instruction_caches": [{{"place": "{}", "size": 4096, "line": 16, "ways": 4,
                          "refill_cycles": 4, "refill_soc_cycles": 21}}],)",
                       place);
  };
  constexpr auto kFar = R"({"name": "ram", "base": "0x1000", "size": 4096,
                            "way": {"fabric_controller": 8, "cluster": 2, "soc": 17}})";
  EXPECT_EQ(complaint(kFar, "", caches("cluster")), "");
  EXPECT_THAT(complaint(kFar, "", caches("fabric_controller")), HasSubstr("add these cycles to refill_cycles"));
  const std::string ways = R"("instruction_caches": [{"place": "fabric_controller", "size": 4096, "line": 16, "ways": 4,
                              "refill_cycles": 4, "invalid_ways_first": true}],)";
  EXPECT_THAT(complaint(kFar, "", ways), HasSubstr("only the cluster's cache can have this key"));
  EXPECT_THAT(complaint(kRam, "", caches("cluster")), HasSubstr("needs a memory with a 'way'"));
}

}  // namespace
}  // namespace mebots::soc::test
