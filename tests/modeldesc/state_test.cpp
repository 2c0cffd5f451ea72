// SPDX-License-Identifier: Apache-2.0
#include "mebots/state/difference.hpp"
#include "mebots/state/layout.hpp"
#include "mebots/state/save.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mebots::state {
namespace {

enum class Phase : std::uint8_t { ground, flight };

struct Cell {
  double charge_c = 1.5;
  std::array<double, 2> branch_v{0.25, -0.5};
  double sum_v = -0.25;  // derived: sum of the branches

  void visit(Visitor& v) {
    v("charge_c", charge_c);
    v("branch_v", branch_v);
    if (v.restores()) sum_v = branch_v[0] + branch_v[1];
  }
};

struct Pack {
  std::vector<Cell> cells = std::vector<Cell>(3);  // list with a fixed number of elements
  std::vector<Cell> spares;                        // list with a variable number of elements
  std::optional<std::int32_t> fault;
  std::optional<Cell> boost;
  std::variant<double, std::int32_t, std::string> setting = 0.5;
  std::vector<std::uint16_t> log{7, 8};
  std::string label = "pack";
  std::vector<std::string> names{"a", "bc"};
  Phase phase = Phase::ground;
  bool on = true;

  void visit(Visitor& v) {
    v("cells", std::span(cells));
    v("spares", spares);
    v("fault", fault);
    v("boost", boost);
    v("setting", setting);
    v("log", log);
    v("label", label);
    v("names", names);
    v("phase", phase);
    v("on", on);
  }
};

Pack changed() {
  Pack pack;
  pack.cells[2].branch_v = {1, 2};
  pack.spares.resize(2);
  pack.spares[1].charge_c = std::nan("");
  pack.fault = -3;
  pack.boost.emplace().charge_c = 9;
  pack.setting = "full";
  pack.log = {1, 2, 3};
  pack.label = "";
  pack.names = {"x"};
  pack.phase = Phase::flight;
  pack.on = false;
  return pack;
}

TEST(State, RestoredObjectEqualsTheSavedOne) {
  const Pack saved = changed();
  Pack restored;
  restore(restored, save(saved));
  EXPECT_EQ(first_difference(saved, restored), std::nullopt);
  EXPECT_EQ(restored.cells[2].sum_v, 3);  // restoring computes derived values again
  EXPECT_EQ(restored.names, saved.names);
  EXPECT_EQ(restored.setting, saved.setting);

  restore(restored, save(Pack()));
  EXPECT_EQ(first_difference(Pack(), restored), std::nullopt);
  EXPECT_FALSE(restored.boost);
}

TEST(State, EqualObjectsAreEqualBytesWhateverLiesBetweenTheirMembers) {
  alignas(Pack) std::array<std::byte, sizeof(Pack)> zeros{};
  alignas(Pack) std::array<std::byte, sizeof(Pack)> ones;
  ones.fill(std::byte{0xFF});
  auto* const one = new (zeros.data()) Pack;
  auto* const other = new (ones.data()) Pack;
  EXPECT_EQ(save(*one), save(*other));
  one->~Pack();
  other->~Pack();
}

TEST(State, DamagedBytesAreRefusedWhereverTheyAreCut) {
  const auto bytes = save(changed());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Pack pack;
    try {
      restore(pack, std::span(bytes).first(size));
      FAIL() << size << " bytes were taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::state_damaged);
    }
  }
  auto longer = bytes;
  longer.emplace_back();
  Pack pack;
  EXPECT_THROW(restore(pack, longer), Error);
}

TEST(StateDifference, NamesTheFirstVariableThatDiffersAndBothValues) {
  const Pack pack;
  Pack other;
  other.on = false;
  EXPECT_EQ(first_difference(pack, other)->path, "on");
  EXPECT_EQ(first_difference(pack, other)->text(), "on is true in one and false in the other");
  other.phase = Phase::flight;
  EXPECT_EQ(first_difference(pack, other)->path, "phase");
  other.names[1] = "bd";
  EXPECT_EQ(first_difference(pack, other)->path, "names[1][1]");
  other.label += "s";
  EXPECT_EQ(first_difference(pack, other)->path, "label.size");
  other.log[1] = 9;
  EXPECT_EQ(first_difference(pack, other)->text(), "log[1] is 8 in one and 9 in the other");
  other.setting = 2.5;
  EXPECT_EQ(first_difference(pack, other)->text(), "setting is 0.5 in one and 2.5 in the other");
  other.setting = 2;
  EXPECT_EQ(first_difference(pack, other)->path, "setting.kind");
  other.fault = 1;
  EXPECT_EQ(first_difference(pack, other)->path, "fault.size");
  other.spares.resize(1);
  EXPECT_EQ(first_difference(pack, other)->path, "spares.size");
  other.cells[2].branch_v[0] = 0.125;
  EXPECT_EQ(first_difference(pack, other)->text(), "cells[2].branch_v[0] is 0.25 in one and 0.125 in the other");
}

TEST(StateDifference, ComparesBitsNotNumbers) {
  Cell zero;
  Cell minus;
  zero.charge_c = 0.0;
  minus.charge_c = -0.0;
  EXPECT_EQ(first_difference(zero, minus)->text(), "charge_c is 0 in one and -0 in the other");
  zero.charge_c = minus.charge_c = std::nan("");
  EXPECT_EQ(first_difference(zero, minus), std::nullopt);
}

TEST(StateDifference, ComparesTwoSavedStatesThroughAnObjectOfTheirKind) {
  Pack pack;
  const auto before = save(pack);
  pack.cells[1].charge_c = 2;
  const auto after = save(pack);
  Pack reader;
  EXPECT_EQ(first_difference(reader, before, before), std::nullopt);
  EXPECT_EQ(first_difference(reader, before, after)->path, "cells[1].charge_c");
}

TEST(StateLayout, IsTheSameWhateverTheValuesAre) {
  EXPECT_EQ(layout_of(Pack()), layout_of(changed()));
}

struct Renamed : Cell {
  void visit(Visitor& v) {
    v("charge_as", charge_c);
    v("branch_v", branch_v);
  }
};
struct Reordered : Cell {
  void visit(Visitor& v) {
    v("branch_v", branch_v);
    v("charge_c", charge_c);
  }
};
struct Retyped : Cell {
  std::int64_t charge_nc = 0;  // has as many bytes as the original type
  void visit(Visitor& v) {
    v("charge_c", charge_nc);
    v("branch_v", branch_v);
  }
};
struct Nested {
  Cell cell;
  void visit(Visitor& v) { v("cell", cell); }
};
struct Listed {
  std::vector<Cell> cell;
  void visit(Visitor& v) { v("cell", cell); }
};

TEST(StateLayout, DiffersForOtherNamesOrdersTypesAndNumbers) {
  Pack two_cells;
  two_cells.cells.resize(2);
  const std::vector<std::uint64_t> layouts{layout_of(Cell()),    layout_of(Renamed()), layout_of(Reordered()),
                                           layout_of(Retyped()), layout_of(Nested()),  layout_of(Listed()),
                                           layout_of(Pack()),    layout_of(two_cells)};
  for (std::size_t i = 0; i < layouts.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(layouts[i], layouts[j]) << i << " and " << j;
}

}  // namespace
}  // namespace mebots::state
