// SPDX-License-Identifier: Apache-2.0
#include "support/flight_rig.hpp"

#include <gtest/gtest.h>
#include <cstdlib>
#include <new>

namespace {
std::size_t allocations = 0;  // NOLINT: counted by the operators below
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace mebots::world {
namespace {

TEST(WorldHeap, StepsInFlightAndOnTheGroundAllocateNothing) {
  test::FlightRig rig(test::shipped_scene("gate_easy"));
  rig.run(0.1);  // contact with the ground fills the list of touches
  std::size_t before = allocations;
  rig.run(0.5);
  EXPECT_EQ(allocations, before) << "on the ground";
  rig.take_off_and_fly();
  rig.inputs.setpoint_velocity_x_m_per_s = 0.3;
  rig.run(1.0);
  before = allocations;
  rig.run(2.0);
  EXPECT_EQ(allocations, before) << "in flight";
}

TEST(WorldHeap, PicturesAllocateNothingAfterTheFirst) {
  test::FlightRig rig(test::shipped_scene("gate_easy"));
  rig.inputs.camera_trigger = 1;
  rig.step();
  const std::size_t before = allocations;
  for (int i = 2; i < 20; ++i) {
    rig.inputs.camera_trigger = i;
    rig.step();
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace mebots::world
