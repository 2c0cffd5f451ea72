// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/units.hpp"

#include <gmock/gmock.h>

#include <numbers>
#include <set>

namespace mebots::modeldesc {
namespace {

const Unit& unit(const char* name) {
  const KnownUnit* known = find_known_unit(name);
  if (known == nullptr) throw std::runtime_error(name);
  return known->unit;
}

TEST(Units, HaveTheDimensionsOfTheirDefinitions) {
  EXPECT_EQ(base_unit_text(unit("V")), "kg.m2/(s3.A)");
  EXPECT_EQ(base_unit_text(unit("W")), "kg.m2/s3");
  EXPECT_EQ(base_unit_text(unit("F")), "s4.A2/(kg.m2)");
  EXPECT_EQ(base_unit_text(unit("Hz")), "1/s");
  EXPECT_EQ(base_unit_text(unit("1")), "1");
  EXPECT_EQ(base_unit_text(unit("kg/m3")), "kg/m3");
}

TEST(Units, ProductsOfDimensionsAgreeWithPhysics) {
  const auto product = [](const char* a, const char* b) {
    auto sum = unit(a).exponents;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += unit(b).exponents[i];
    return sum;
  };
  EXPECT_EQ(product("V", "A"), unit("W").exponents);
  EXPECT_EQ(product("W", "s"), unit("J").exponents);
  EXPECT_EQ(product("A", "s"), unit("C").exponents);
  EXPECT_EQ(product("Ohm", "A"), unit("V").exponents);
  EXPECT_EQ(product("F", "V"), unit("C").exponents);
  EXPECT_EQ(product("N", "m"), unit("N.m").exponents);
  EXPECT_EQ(product("m/s", "s"), unit("m").exponents);
  EXPECT_EQ(product("rad/s", "s"), unit("rad").exponents);
  EXPECT_EQ(product("Pa", "m2"), unit("N").exponents);
  EXPECT_EQ(product("H", "A"), product("V", "s"));
  EXPECT_EQ(product("T", "m2"), product("V", "s"));
}

TEST(Units, ConvertToTheirSiBase) {
  EXPECT_DOUBLE_EQ(unit("mAh").factor, 3.6);
  EXPECT_DOUBLE_EQ(unit("Wh").factor, 3600);
  EXPECT_DOUBLE_EQ(unit("km/h").factor * 36, 10);
  EXPECT_DOUBLE_EQ(unit("rpm").factor * 60, 2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(unit("deg").factor * 180, std::numbers::pi);
  EXPECT_DOUBLE_EQ(unit("degC").offset, 273.15);
  EXPECT_DOUBLE_EQ(unit("%").factor, 0.01);
}

TEST(Units, AreTheSameWhenANumberMeansTheSame) {
  EXPECT_TRUE(same_unit(unit("Hz"), unit("1/s")));
  EXPECT_FALSE(same_unit(unit("Hz"), unit("rad/s")));
  EXPECT_TRUE(same_dimension(unit("m/s"), unit("km/h")));
  EXPECT_FALSE(same_unit(unit("m/s"), unit("km/h")));
  EXPECT_FALSE(same_unit(unit("K"), unit("degC")));
  EXPECT_FALSE(same_dimension(unit("V"), unit("A")));
  Unit foreign;
  foreign.name = "furlong";
  foreign.has_base = false;
  EXPECT_TRUE(same_unit(foreign, foreign));
  EXPECT_FALSE(same_dimension(foreign, unit("m")));
}

TEST(Units, HaveUniqueNamesAndSuffixes) {
  std::set<std::string> names;
  std::set<std::string> suffixes;
  for (const KnownUnit& known : known_units()) {
    EXPECT_TRUE(names.insert(known.unit.name).second) << known.unit.name;
    EXPECT_TRUE(suffixes.insert(known.suffix).second) << known.suffix;
  }
}

}  // namespace
}  // namespace mebots::modeldesc
