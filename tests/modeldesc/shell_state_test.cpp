// SPDX-License-Identifier: Apache-2.0
#include "lag_fmu.hpp"

#include "mebots/fmu/binary_ref.hpp"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>

namespace mebots::test {
namespace {

using testing::HasSubstr;

/// Steps the FMU with changing inputs. Equal calls give the same bits.
void drive(Lag& lag, int from, int to) {
  for (int i = from; i < to; ++i) {
    ASSERT_EQ(lag.set("left.u", i % 7 - 3), fmi2OK);
    ASSERT_EQ(lag.set("right.u", 0.1 * i), fmi2OK);
    ASSERT_EQ(lag.step(0.1 * i, 0.1), fmi2OK) << lag.last_message();
  }
}

void prepare(Lag& lag) {
  ASSERT_EQ(lag.set("left.time_constant", 0.7), fmi2OK);
  ASSERT_EQ(lag.set("right.initial", 0.3), fmi2OK);
  ASSERT_EQ(lag.set_string("note", "kept"), fmi2OK);
}

void expect_same_bits(Lag& a, Lag& b) {
  for (const char* name : {"left.y", "right.y", "left.u", "gain", "left.time_constant"})
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a.real(name)), std::bit_cast<std::uint64_t>(b.real(name))) << name;
  EXPECT_EQ(a.integer("steps"), b.integer("steps"));
  EXPECT_EQ(a.string("label"), b.string("label"));
  EXPECT_EQ(a.string("history.text"), b.string("history.text"));
}

/// Compares an uninterrupted run with a run that continues in another instance. `transfer` transfers the state.
void expect_same_bits_after(const std::function<void(Lag& from, Lag& to)>& transfer) {
  Lag straight;
  prepare(straight);
  straight.start();
  drive(straight, 0, 40);

  Lag first;
  prepare(first);
  first.start();
  drive(first, 0, 20);
  Lag second("second");
  transfer(first, second);
  drive(second, 20, 40);
  expect_same_bits(straight, second);
}

TEST(ShellState, SavedAndRestoredInANewInstanceContinuesWithTheSameBits) {
  expect_same_bits_after([](Lag& from, Lag& to) {
    fmi2FMUstate state = from.save();
    ASSERT_EQ(library().set_fmu_state(to.component(), state), fmi2OK) << to.last_message();
    ASSERT_EQ(library().free_fmu_state(from.component(), &state), fmi2OK);
    EXPECT_EQ(state, nullptr);
  });
}

TEST(ShellState, SerializedAndReadBackContinuesWithTheSameBits) {
  expect_same_bits_after([](Lag& from, Lag& to) {
    const std::vector<char> bytes = from.serialized();
    fmi2FMUstate state = nullptr;
    ASSERT_EQ(library().deserialize_fmu_state(to.component(), bytes.data(), bytes.size(), &state), fmi2OK)
        << to.last_message();
    ASSERT_EQ(library().set_fmu_state(to.component(), state), fmi2OK) << to.last_message();
    ASSERT_EQ(library().free_fmu_state(to.component(), &state), fmi2OK);
  });
}

TEST(ShellState, GoesBackInTimeInTheSameInstance) {
  Lag straight;
  straight.start();
  drive(straight, 0, 20);
  Lag lag;
  lag.start();
  drive(lag, 0, 10);
  fmi2FMUstate state = lag.save();
  drive(lag, 10, 15);
  ASSERT_EQ(library().set_fmu_state(lag.component(), state), fmi2OK);
  drive(lag, 10, 20);
  expect_same_bits(straight, lag);
  // A second call with the same handle overwrites the stored state.
  ASSERT_EQ(library().get_fmu_state(lag.component(), &state), fmi2OK);
  ASSERT_EQ(library().free_fmu_state(lag.component(), &state), fmi2OK);
}

TEST(ShellState, LeadsOutOfStateError) {
  Lag straight;
  straight.start();
  drive(straight, 0, 20);
  Lag lag;
  lag.start();
  drive(lag, 0, 10);
  fmi2FMUstate state = lag.save();
  ASSERT_EQ(lag.set_integer("trouble", 1), fmi2OK);
  ASSERT_EQ(lag.step(1, 0.1), fmi2Error);
  ASSERT_EQ(library().set_fmu_state(lag.component(), state), fmi2OK);
  drive(lag, 10, 20);
  expect_same_bits(straight, lag);
  ASSERT_EQ(library().free_fmu_state(lag.component(), &state), fmi2OK);
}

TEST(ShellState, CanBeSavedAndRestoredInEveryPhase) {
  Lag instantiated;
  fmi2FMUstate state = instantiated.save();
  Lag lag;
  lag.start();
  drive(lag, 0, 3);
  ASSERT_EQ(library().set_fmu_state(lag.component(), state), fmi2OK);
  EXPECT_EQ(lag.step(0, 0.1), fmi2Error);  // the restored instance is not initialised
  lag.start();
  EXPECT_EQ(lag.integer("steps"), 0);
  ASSERT_EQ(library().free_fmu_state(lag.component(), &state), fmi2OK);
}

TEST(ShellState, DoesNotCarryPointers) {
  Lag lag;
  lag.start();
  const std::array<std::uint8_t, 2> message = {5, 6};
  const fmu::BinaryRef sent = fmu::BinaryRef::to(message);
  ASSERT_EQ(lag.set_integer("message.base.lo", sent.base_lo), fmi2OK);
  ASSERT_EQ(lag.set_integer("message.base.hi", sent.base_hi), fmi2OK);
  ASSERT_EQ(lag.set_integer("message.size", sent.size), fmi2OK);
  drive(lag, 0, 2);
  EXPECT_EQ(lag.integer("message.sum"), 11);
  fmi2FMUstate state = lag.save();
  ASSERT_EQ(library().set_fmu_state(lag.component(), state), fmi2OK);
  EXPECT_EQ(lag.integer("message.base.lo"), 0);
  EXPECT_EQ(lag.integer("message.size"), 0);
  EXPECT_EQ(lag.integer("message.sum"), 11);  // the sum is a value, so it is part of the state

  Lag other;
  ASSERT_EQ(library().set_fmu_state(other.component(), state), fmi2OK);
  const fmu::BinaryRef history{other.integer("history.base.lo"), other.integer("history.base.hi"),
                               other.integer("history.size")};
  EXPECT_THAT(history.bytes(), testing::ElementsAre(1, 2));
  EXPECT_NE(other.integer("history.base.lo"), lag.integer("history.base.lo"));
  ASSERT_EQ(library().free_fmu_state(lag.component(), &state), fmi2OK);
}

TEST(ShellState, DamagedOrForeignBytesAreRefused) {
  Lag lag;
  lag.start();
  drive(lag, 0, 5);
  const std::vector<char> good = lag.serialized();
  fmi2FMUstate state = nullptr;
  const auto refused = [&](const std::vector<char>& bytes) {
    EXPECT_EQ(library().deserialize_fmu_state(lag.component(), bytes.data(), bytes.size(), &state), fmi2Error);
    EXPECT_EQ(state, nullptr);
    return lag.last_message();
  };
  EXPECT_THAT(refused({}), HasSubstr("these 0 bytes are not a state of a MEbots FMU"));
  EXPECT_THAT(refused(std::vector<char>(100, 'x')), HasSubstr("not a state of a MEbots FMU"));
  for (std::size_t size = 8; size < good.size(); size += 5)
    refused(std::vector<char>(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::vector<char> bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    refused(bad);
  }
  std::vector<char> longer = good;
  longer.push_back('x');
  refused(longer);
  // The instance continues, because refused states do not change it.
  drive(lag, 5, 6);
}

/// Returns the bytes with another hash of the layout and a correct checksum, as a build with other variables would
/// write them. The header has magic number, format, two texts with their lengths, layout and checksum.
std::vector<char> of_another_build(std::vector<char> bytes) {
  const auto number_at = [&](std::size_t at) {
    std::uint64_t number = 0;
    std::memcpy(&number, &bytes[at], sizeof number);
    return number;
  };
  std::size_t at = sizeof(std::uint64_t) + sizeof(std::uint32_t);
  for (int text = 0; text < 2; ++text) at += sizeof(std::uint64_t) + number_at(at);
  const std::uint64_t layout = number_at(at) + 1;
  std::uint64_t checksum = 0xCBF2'9CE4'8422'2325 ^ layout;
  for (std::size_t i = at + 3 * sizeof(std::uint64_t); i < bytes.size(); ++i)
    checksum = (checksum ^ static_cast<std::uint8_t>(bytes[i])) * 0x0000'0100'0000'01B3;
  std::memcpy(&bytes[at], &layout, sizeof layout);
  std::memcpy(&bytes[at + sizeof layout], &checksum, sizeof checksum);
  return bytes;
}

TEST(ShellState, IsRefusedIfAnotherBuildHasAnotherLayout) {
  Lag lag;
  lag.start();
  drive(lag, 0, 5);
  const auto bytes = of_another_build(lag.serialized());
  fmi2FMUstate state = nullptr;
  ASSERT_EQ(library().deserialize_fmu_state(lag.component(), bytes.data(), bytes.size(), &state), fmi2OK)
      << lag.last_message();
  Lag fresh;
  for (Lag* const instance : {&fresh, &lag}) {
    EXPECT_EQ(library().set_fmu_state(instance->component(), state), fmi2Error);
    EXPECT_THAT(instance->last_message(),
                HasSubstr("saved by another build of lag, whose variables have another layout"));
  }
  ASSERT_EQ(library().free_fmu_state(lag.component(), &state), fmi2OK);
  drive(lag, 5, 6);  // the failed call has changed nothing
  Lag straight;
  straight.start();
  drive(straight, 0, 6);
  expect_same_bits(straight, lag);
}

TEST(ShellState, NullPointersAndTooSmallArraysAreRefused) {
  Lag lag;
  lag.start();
  EXPECT_EQ(library().get_fmu_state(lag.component(), nullptr), fmi2Error);
  EXPECT_EQ(library().set_fmu_state(lag.component(), nullptr), fmi2Error);
  fmi2FMUstate state = lag.save();
  std::array<char, 4> small{};
  EXPECT_EQ(library().serialize_fmu_state(lag.component(), state, small.data(), small.size()), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("the array has 4"));
  EXPECT_EQ(library().serialized_fmu_state_size(lag.component(), state, nullptr), fmi2Error);
  EXPECT_EQ(library().free_fmu_state(lag.component(), &state), fmi2OK);
  EXPECT_EQ(library().free_fmu_state(lag.component(), &state), fmi2OK);  // the state is null after the first call
}

}  // namespace
}  // namespace mebots::test
