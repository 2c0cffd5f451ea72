// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/limits.hpp"
#include "mebots/data/mistakes.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::data {

class Document;
struct Member;

/// A whole number is one that is written as such, 3 or 3.0, and fits into 64 bits.
enum class Kind : std::uint8_t { null, boolean, whole_number, number, text, list, object };

/// One value of a Document together with its place: cheap to copy, valid as long as the document. All that read
/// throw Mistakes, naming file, line, column and JSON pointer, when the value is not what was asked for.
/// Whoever wants to go on reading behind it calls them inside attempt(), as Object does.
class Node {
 public:
  Kind kind() const;
  bool is(Kind wanted) const { return kind() == wanted; }
  /// A whole number without point and exponent.
  bool is_integer_literal() const;
  bool is_number() const { return is(Kind::number) || is(Kind::whole_number); }

  std::string text() const;
  /// A text that is not empty.
  std::string readable_text() const;
  bool flag() const;
  double number(const Limits& limits = {}) const;
  std::int64_t whole_number(std::int64_t least, std::int64_t most) const;
  /// A whole number that is not negative.
  std::uint64_t natural_number() const;

  /// Of a list.
  std::vector<Node> elements() const;
  /// Of an object, in the order of the file. A key that occurs twice is told, and its first value taken.
  std::vector<Member> members() const;
  bool has(std::string_view key) const { return find(key).has_value(); }
  /// Nothing also where this is not an object.
  std::optional<Node> find(std::string_view key) const;
  Node at(std::string_view key) const;

  /// Notes a mistake at this value; reading goes on.
  void complain(ErrorCode code, std::string_view what) const;
  [[noreturn]] void fail(ErrorCode code, std::string_view what) const;
  /// "the state 'onn' is unknown. Did you mean 'on'?"
  void complain_unknown(std::string_view what, std::string_view name, std::span<const std::string> known) const;
  [[noreturn]] void fail_unknown(std::string_view what, std::string_view name,
                                 std::span<const std::string> known) const;
  /// Calls `read`; whatever Error it throws is noted and reading goes on. False when it threw.
  template <typename Read>
  bool attempt(const Read& read) const {
    try {
      read();
      return true;
    } catch (const Mistakes& mistakes) {
      note(mistakes);
    } catch (const Error& error) {
      complain(error.code(), error.what());
    }
    return false;
  }
  /// How many mistakes of the document are noted by now.
  std::size_t noted() const;

  /// The value as it could be written, shortened.
  std::string shown() const;
  /// RFC 6901; empty for the root.
  std::string pointer() const;
  /// "file.json:12:5: /pointer/to/it". A member stands where its key stands.
  std::string place() const;

 private:
  friend class Document;
  Node(Document& document, std::size_t index) : document_(&document), index_(index) {}
  [[noreturn]] void fail_kind(std::string_view wanted) const;
  void note(const Mistakes& mistakes) const;
  Mistake mistake(ErrorCode code, std::string_view what) const;

  Document* document_;
  std::size_t index_;
};

/// One step of a JSON pointer (RFC 6901): "/a~1b" of "a/b".
std::string pointer_step(std::string_view key);

struct Member {
  std::string key;
  Node value;
};

}  // namespace mebots::data
