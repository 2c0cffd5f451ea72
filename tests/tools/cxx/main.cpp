// SPDX-License-Identifier: Apache-2.0
// Firmware in C++ with a constructor before main(), a virtual call and a template. Then loads from an invalid address.
#include <stdint.h>

#include "runtime/console.h"

namespace {

class Sensor {
 public:
  virtual ~Sensor() = default;
  virtual int32_t read() const = 0;
};

class Gauge final : public Sensor {
 public:
  explicit Gauge(const volatile int32_t* place) : place_(place) { ++made; }
  __attribute__((noinline)) int32_t read() const override { return *place_; }

  static inline int made = 0;

 private:
  const volatile int32_t* place_;
};

template <typename... Values>
constexpr auto sum(Values... values) {
  return (values + ...);
}

volatile int32_t level = 40;
const Gauge level_gauge(&level);
const Gauge broken_gauge(reinterpret_cast<const volatile int32_t*>(0x40000000));

__attribute__((noinline)) int32_t look(const Sensor& sensor) {
  return sum(sensor.read(), int32_t{2});
}

}  // namespace

int main() {
  print("%d gauges, level %d\n", static_cast<int32_t>(Gauge::made), look(level_gauge));
  const auto broken = look(broken_gauge);
  print("not reached: %d\n", broken);
  return 0;
}
