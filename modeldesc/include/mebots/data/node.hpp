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

/// The kinds of JSON values. A whole_number has no fractional part (3 or 3.0) and fits into 64 bits.
enum class Kind : std::uint8_t { null, boolean, whole_number, number, text, list, object };

/// A value of a Document and its place in the text. A node is cheap to copy, and is valid as long as the document. If
/// the value is of the wrong kind, the functions that read it throw Mistakes with file, line, column and JSON pointer.
/// To continue after a mistake, call them inside attempt(), as Object does.
class Node {
 public:
  Kind kind() const;
  bool is(Kind wanted) const { return kind() == wanted; }
  /// True if the value is a whole number that is written without decimal point and exponent, such as 3.
  bool is_integer_literal() const;
  bool is_number() const { return is(Kind::number) || is(Kind::whole_number); }

  std::string text() const;
  /// Returns a text. Throws Mistakes if the text is empty.
  std::string readable_text() const;
  bool flag() const;
  double number(const Limits& limits = {}) const;
  std::int64_t whole_number(std::int64_t least, std::int64_t most) const;
  /// Returns a whole number. Throws Mistakes if it is negative.
  std::uint64_t natural_number() const;

  std::vector<Node> elements() const;
  /// Returns the members of an object, in the order of the file. If a key occurs twice, the result contains both
  /// members, and find() returns the first of them.
  std::vector<Member> members() const;
  bool has(std::string_view key) const { return find(key).has_value(); }
  /// Returns the member with this key. Returns empty if the member is missing or this value is not an object.
  std::optional<Node> find(std::string_view key) const;
  Node at(std::string_view key) const;

  /// Adds a mistake at the place of this value to the document. Does not throw.
  void complain(ErrorCode code, std::string_view what) const;
  [[noreturn]] void fail(ErrorCode code, std::string_view what) const;
  /// Adds a mistake such as "the state 'onn' is unknown. Did you mean 'on'?" The suggestion comes from `known`.
  void complain_unknown(std::string_view what, std::string_view name, std::span<const std::string> known) const;
  [[noreturn]] void fail_unknown(std::string_view what, std::string_view name,
                                 std::span<const std::string> known) const;
  /// Calls `read`. If `read` throws an Error, adds it to the mistakes and returns false.
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
  std::size_t noted() const;

  /// Returns the value as JSON text. A long text is shortened.
  std::string shown() const;
  /// Returns the value's JSON pointer (RFC 6901); empty for the root.
  std::string pointer() const;
  /// Returns the value's place, such as "file.json:12:5: /pointer/to/value". For a member, this is the place of its
  /// key.
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

/// Escapes a key for a JSON pointer (RFC 6901): returns "/a~1b" for "a/b".
std::string pointer_step(std::string_view key);

struct Member {
  std::string key;
  Node value;
};

}  // namespace mebots::data
