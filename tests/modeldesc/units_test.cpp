// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/units.hpp"

#include "mebots/error.hpp"

#include <gmock/gmock.h>

#include <numbers>
#include <set>

namespace mebots::modeldesc {
namespace {

Unit unit(const char* name) {
  return parse_unit(name);
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

TEST(Units, AreProductsOfPowersOfKnownUnits) {
  EXPECT_EQ(base_unit_text(unit("m3/s")), "m3/s");
  EXPECT_EQ(base_unit_text(unit("rad/(s.V)")), "s2.A.rad/(kg.m2)");
  EXPECT_EQ(base_unit_text(unit("(kg.m)/(s2)")), "kg.m/s2");
  EXPECT_EQ(unit("s-1").exponents, unit("1/s").exponents);
  EXPECT_EQ(unit("m+2").exponents, unit("m2").exponents);
  EXPECT_EQ(unit("1/((m.s)/kg)").exponents, unit("kg/(m.s)").exponents) << "brackets in brackets";
  EXPECT_TRUE(same_unit(unit("W.h"), unit("Wh")));
  EXPECT_TRUE(same_unit(unit("N.m"), unit("J")));
  EXPECT_TRUE(same_unit(unit("l/min"), unit("l/min")));
  EXPECT_DOUBLE_EQ(unit("l/min").factor, 1e-3 / 60);
  EXPECT_DOUBLE_EQ(unit("mm2/ms").factor, 1e-3);
  EXPECT_DOUBLE_EQ(unit("%/degC").factor, 0.01);
  EXPECT_EQ(unit("J/degC").offset, 0) << "in a product a difference";
  EXPECT_EQ(unit("degC2").offset, 0);
  EXPECT_EQ(unit("degC").offset, 273.15);
}

TEST(Units, SuggestsTheNearestUnitForAnUnknownOne) {
  const auto error_of = [](const char* text) -> std::string {
    try {
      parse_unit(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::wrong_unit);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(error_of("kg.ohm"), testing::AllOf(testing::HasSubstr("the unit 'ohm' in \"kg.ohm\" is unknown"),
                                                 testing::HasSubstr("'Ohm'")));
  EXPECT_THAT(error_of("furlong"), testing::HasSubstr("the unit 'furlong' is unknown"));
  for (const char* wrong :
       {"",        "/s", "m/", "m//s", "m/s/s", "m/s.kg", "m.",  ".m", "m s", "(m",
        "m)",      "2",  "m0", "m21",  "m-",    "m^2",    "m*s", "1m", "m/1", "km20.km20.km20.km20.km20.km20",
        "\xc2\xb0"}) {
    EXPECT_THAT(error_of(wrong), testing::Not("accepted")) << wrong;
  }
  EXPECT_THAT(error_of(std::string(200, '(').c_str()), testing::HasSubstr("longer than"));
}

TEST(Units, GiveSuffixesOfCppNames) {
  EXPECT_EQ(unit_suffix("V"), "_v");
  EXPECT_EQ(unit_suffix("1"), "");
  EXPECT_EQ(unit_suffix("m/s2"), "_m_per_s2");
  EXPECT_EQ(unit_suffix("1/s"), "_per_s");
  EXPECT_EQ(unit_suffix("s-1"), "_per_s");
  EXPECT_EQ(unit_suffix("kg.m2"), "_kg_m2");
  EXPECT_EQ(unit_suffix("rad/(s.V)"), "_rad_per_s_v");
  EXPECT_EQ(unit_suffix("N.s2/rad2"), "_n_s2_per_rad2");
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
