// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"

#include <vector>

namespace mebots::soc::observe {

/// Several observers as one, asked in the order of their coming.
class Observers final : public Observer {
 public:
  void add(Observer& observer) { list_.push_back(&observer); }
  void remove(const Observer& observer) { std::erase(list_, &observer); }
  bool empty() const { return list_.empty(); }

  bool before(const Hart& hart) override {
    for (auto* observer : list_) {
      if (!observer->before(hart)) return false;
    }
    return true;
  }
  void retired(const Hart& hart, const Retired& instruction) override {
    for (auto* observer : list_) observer->retired(hart, instruction);
  }
  QuietCode quiet() const override { return list_.size() == 1 ? list_.front()->quiet() : QuietCode{}; }
  /// Translated code has one who listens at most.
  const FlowMap* flow() const override { return list_.size() == 1 ? list_.front()->flow() : nullptr; }
  void flowed(const Hart& hart, std::span<const Flow> steps) override {
    for (auto* observer : list_) observer->flowed(hart, steps);
  }
  void trapped(const Hart& hart, const Trapped& trap) override {
    for (auto* observer : list_) observer->trapped(hart, trap);
  }
  void slept(const Hart& hart) override {
    for (auto* observer : list_) observer->slept(hart);
  }
  void woke(const Hart& hart) override {
    for (auto* observer : list_) observer->woke(hart);
  }
  void switched(const Hart& hart, bool on) override {
    for (auto* observer : list_) observer->switched(hart, on);
  }

 private:
  std::vector<Observer*> list_;
};

}  // namespace mebots::soc::observe
