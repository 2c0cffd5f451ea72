// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/bytes.hpp"
#include "mebots/state/visitor.hpp"

#include <span>
#include <vector>

namespace mebots::state {

class Saver : public Visitor {
 public:
  explicit Saver(Writer& writer) : Saver(writer, Purpose::save) {}

 protected:
  Saver(Writer& writer, Purpose purpose) : Visitor(purpose), writer_(writer) {}

  void fixed(std::string_view /*name*/, const Values& values) override { writer_.append(values.data, values.bytes()); }
  void changing(std::string_view /*name*/, List& list) override {
    const Values values = list.values();
    writer_.put(std::uint64_t{values.count});
    writer_.append(values.data, values.bytes());
  }
  std::size_t count(std::string_view /*name*/, std::size_t present) override {
    writer_.put(std::uint64_t{present});
    return present;
  }

 private:
  Writer& writer_;
};

/// Restores the values that a Saver wrote, in the same order. Throws Error (state_damaged) if the bytes end too early.
class Restorer final : public Visitor {
 public:
  explicit Restorer(Reader& reader) : Visitor(Purpose::restore), reader_(reader) {}

 private:
  void fixed(std::string_view /*name*/, const Values& values) override { reader_.copy_to(values.data, values.bytes()); }
  void changing(std::string_view /*name*/, List& list) override {
    list.resize(reader_.count(list.values().size));
    const Values values = list.values();
    reader_.copy_to(values.data, values.bytes());
  }
  std::size_t count(std::string_view /*name*/, std::size_t /*present*/) override { return reader_.count(1); }

  Reader& reader_;
};

/// Appends the object's state to the writer's bytes. `object` is constant, because a Saver does not change it.
template <Visited T>
void save(const T& object, Writer& writer) {
  Saver saver(writer);
  const_cast<T&>(object).visit(saver);
}

template <Visited T>
std::vector<std::byte> save(const T& object) {
  Writer writer;
  save(object, writer);
  return writer.take();
}

/// Restores the object from the bytes that save() wrote. Throws Error (state_damaged) if the bytes end too early or do
/// not fit. The object may then be partly restored.
template <Visited T>
void restore(T& object, Reader& reader) {
  Restorer restorer(reader);
  object.visit(restorer);
}

/// Restores an object from `bytes`. Throws Error if the bytes continue after the object's state.
template <Visited T>
void restore(T& object, std::span<const std::byte> bytes) {
  Reader reader(bytes);
  restore(object, reader);
  if (!reader.at_end())
    throw Error(ErrorCode::state_damaged, "a saved state is longer than the object that it restores");
}

}  // namespace mebots::state
