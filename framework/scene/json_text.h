// Walks the tokens of a JSON text, so that every value can be given the line and column where it starts.
//
// The grammar is checked by the JSON library; this only follows it from token to token, and finds the words
// for what is wrong where the library stops.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "framework/base/error.h"

namespace weir {

/// A position in a text. Columns count characters, not bytes.
struct TextPlace {
  std::size_t offset = 0;
  int line = 1;
  int column = 1;
};

class JsonTokens {
 public:
  explicit JsonTokens(std::string_view text);

  /// The start of the next token that is no ',' or ':'; moves behind it. The token must be valid.
  TextPlace next();
  /// The first character that is not white space.
  TextPlace skipSpace();
  void skipOne() { advance(1); }
  const TextPlace& place() const { return place_; }
  std::string_view rest() const { return text_.substr(place_.offset); }
  std::string_view since(const TextPlace& start) const {
    return text_.substr(start.offset, place_.offset - start.offset);
  }

 private:
  void advance(std::size_t bytes);

  std::string_view text_;
  TextPlace place_;
};

/// Whether a word is a number, true, false or null as JSON writes them.
bool isJsonWord(std::string_view word);

/// What may come next at a place of a JSON text.
enum class JsonState {
  kDocument,      ///< the one value of the file
  kEnd,           ///< nothing more
  kFirstElement,  ///< after '[': a value or ']'
  kNextElement,   ///< after a value in an array: ',' or ']'
  kFirstKey,      ///< after '{': a name or '}'
  kNextKey,       ///< after a value in an object: ',' or '}'
  kMember,        ///< after a name: ':' and a value
};

/// What is wrong behind `tokens`, given what may come there. `opened` is where the innermost array or object
/// starts, for a file that ends too early.
Error describeJsonMistake(JsonTokens tokens, JsonState state, const TextPlace& opened,
                          const std::string& fileName);

}  // namespace weir
