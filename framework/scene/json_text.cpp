#include "framework/scene/json_text.h"

#include <fmt/format.h>

#include <array>
#include <cctype>

#include "framework/base/text.h"

namespace weir {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool isJsonSpace(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool isWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '+' || c == '.';
}

/// The length of the token that the text starts with, which is valid.
std::size_t tokenLength(std::string_view text) {
  if (text.empty()) return 0;
  std::size_t length = 1;
  if (text[0] == '"') {
    while (length < text.size() && text[length] != '"') length += text[length] == '\\' ? 2 : 1;
    return std::min(length + 1, text.size());
  }
  if (!isWordCharacter(text[0])) return 1;
  while (length < text.size() && isWordCharacter(text[length])) ++length;
  return length;
}

bool isJsonNumber(std::string_view t) {
  const auto digits = [&] {
    const std::size_t count = std::min(t.find_first_not_of("0123456789"), t.size());
    t.remove_prefix(count);
    return count;
  };
  if (t.starts_with('-')) t.remove_prefix(1);
  const bool leadingZero = t.starts_with('0');
  const std::size_t whole = digits();
  if (whole == 0 || (leadingZero && whole > 1)) return false;
  if (t.starts_with('.')) {
    t.remove_prefix(1);
    if (digits() == 0) return false;
  }
  if (t.starts_with('e') || t.starts_with('E')) {
    t.remove_prefix(1);
    if (t.starts_with('+') || t.starts_with('-')) t.remove_prefix(1);
    if (digits() == 0) return false;
  }
  return t.empty();
}

}  // namespace

bool isJsonWord(std::string_view word) {
  return word == "true" || word == "false" || word == "null" || isJsonNumber(word);
}

JsonTokens::JsonTokens(std::string_view text) : text_(text) {
  if (text.starts_with(kByteOrderMark)) place_.offset = kByteOrderMark.size();
}

void JsonTokens::advance(std::size_t bytes) {
  const std::size_t end = place_.offset + bytes;
  for (; place_.offset < end && place_.offset < text_.size(); ++place_.offset) {
    const auto byte = static_cast<unsigned char>(text_[place_.offset]);
    if (byte == '\n')
      ++place_.line, place_.column = 1;
    else if ((byte & 0xC0) != 0x80)  // the tail bytes of a character do not count
      ++place_.column;
  }
}

TextPlace JsonTokens::skipSpace() {
  while (place_.offset < text_.size() && isJsonSpace(text_[place_.offset])) advance(1);
  return place_;
}

TextPlace JsonTokens::next() {
  for (skipSpace(); rest().starts_with(',') || rest().starts_with(':'); skipSpace()) skipOne();
  const TextPlace start = place_;
  advance(tokenLength(rest()));
  return start;
}

namespace {

/// What is wrong with a string, which begins with its quote; empty if nothing is.
struct StringMistake {
  std::size_t offset = 0;
  std::string message, allowed, hint;
};

StringMistake findStringMistake(std::string_view text) {
  constexpr std::string_view kEscapes = "\"\\/bfnrtu";
  for (std::size_t i = 1; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte == '"') return {};
    if (byte == '\n' || byte == '\r')
      return {0, "the string " + printable(text.substr(0, i), 40) + " does not end on its line",
              "a closing '\"'", "a line break in a string is written \\n"};
    if (byte < 0x20)
      return {i,
              fmt::format("found the control character U+{:04X} in a string", byte),
              fmt::format("\\u{:04x}", byte),
              {}};
    const std::size_t length = utf8Length(text, i);
    if (length == 0)
      return {i, fmt::format("found the byte 0x{:02X}, which is not UTF-8", byte), "text in UTF-8",
              "save the file as UTF-8"};
    if (byte != '\\') {
      i += length;
      continue;
    }
    if (i + 1 < text.size() && kEscapes.find(text[i + 1]) == std::string_view::npos)
      return {i, "found the escape '" + printable(text.substr(i, 2)) + "' in a string",
              R"(\" \\ \/ \b \f \n \r \t or \uXXXX)", R"(write \\ for a backslash)"};
    if (i + 1 < text.size() && text[i + 1] == 'u') {
      const std::string_view digits = text.substr(i + 2, 4);
      if (digits.size() < 4 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string_view::npos)
        return {i,
                "found '" + printable(text.substr(i, 6)) + "' in a string",
                "\\u and four digits 0-9, a-f",
                {}};
    }
    i += 2;
  }
  return {0, "the file ends inside a string", "a closing '\"'", {}};
}

constexpr std::string_view kExpected[] = {
    "one JSON object: { … }",
    "nothing after the end of the scene",
    "a value or ']'",
    "',' or ']'",
    "a name in double quotes or '}'",
    "',' or '}'",
    "':' and a value",
};

/// A hint for a word that JSON does not know.
std::string_view hintForWord(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kLiterals{
      {{"true", "write true"}, {"false", "write false"}, {"null", "write null"}}};
  std::string lower;
  for (const char c : word) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& [literal, hint] : kLiterals)
    if (lower == literal) return hint;
  if (lower == "none") return "write null";
  if (lower.find("nan") != std::string::npos || lower.find("inf") != std::string::npos)
    return "JSON has no NaN and no infinity";
  return "text is written in double quotes";
}

Error describeWord(std::string_view word, bool valueExpected, const std::string& expected) {
  const char first = word[0] == '-' || word[0] == '+' ? (word.size() > 1 ? word[1] : ' ') : word[0];
  const bool numeric = std::isdigit(static_cast<unsigned char>(first)) != 0 || first == '.';
  const std::string found = "found " + inQuotes(word);
  if (numeric && valueExpected && isJsonNumber(word))
    return sceneError("the number " + printable(word) + " is too large", "numbers up to 1.7e308");
  if (numeric && valueExpected)
    return sceneError(found + ", which is not a number", "a number such as 12, -0.5 or 1e-3",
                      "a number has no leading '+' or zeros, and digits on both sides of its point");
  return sceneError(found, expected, std::string(hintForWord(word)));
}

/// What is wrong with the first character or word of `rest`.
Error describeToken(std::string_view rest, JsonState state, bool afterComma, bool valueExpected,
                    const std::string& expected) {
  const char c = rest[0];
  if (c == '/' || c == '#')
    return sceneError("found " + inQuotes(rest.substr(0, 2)), expected,
                      "comments are not part of JSON; scenes take // and /* */");
  if (c == '\'') return sceneError("found a single quote", expected, "strings are written in double quotes");
  if (afterComma && (c == ']' || c == '}'))
    return sceneError("found ',' before '" + std::string(1, c) + "'", expected, "remove the last comma");
  if (c == '"' && (state == JsonState::kNextElement || state == JsonState::kNextKey))
    return sceneError("found a string", expected, "a comma may be missing before it");
  if (isWordCharacter(c)) {
    const std::size_t length = tokenLength(rest);
    return describeWord(rest.substr(0, length), valueExpected, expected);
  }
  const std::size_t length = utf8Length(rest, 0);
  if (length == 0)
    return sceneError(
        fmt::format("found the byte 0x{:02X}, which is not UTF-8", static_cast<unsigned char>(c)), expected,
        "the file may be binary, or not in UTF-8");
  return sceneError("found " + inQuotes(rest.substr(0, length)), expected);
}

}  // namespace

Error describeJsonMistake(JsonTokens tokens, JsonState state, const TextPlace& opened,
                          const std::string& fileName) {
  const bool emptyFile = state == JsonState::kDocument;
  std::string expected(kExpected[static_cast<int>(state)]);
  bool afterComma = false;
  bool valueExpected = state == JsonState::kDocument || state == JsonState::kFirstElement;
  TextPlace at = tokens.skipSpace();
  if (state == JsonState::kMember && tokens.rest().starts_with(':')) {
    tokens.skipOne();
    valueExpected = true;
    expected = "a value";
  } else if ((state == JsonState::kNextElement || state == JsonState::kNextKey) &&
             tokens.rest().starts_with(',')) {
    tokens.skipOne();
    afterComma = true;
    valueExpected = state == JsonState::kNextElement;
    expected = valueExpected ? "a value" : "a name in double quotes";
    state = valueExpected ? JsonState::kFirstElement : JsonState::kFirstKey;
  }
  at = tokens.skipSpace();
  const std::string_view rest = tokens.rest();
  const auto here = [&](Error error) {
    error.at({.file = fileName, .line = at.line, .column = at.column});
    return error;
  };

  if (rest.empty() && emptyFile) return here(sceneError("the file is empty", expected));
  if (rest.empty())
    return here(sceneError(
        fmt::format("the file ends inside what opens at line {}, column {}", opened.line, opened.column),
        expected, "the file may be cut off"));
  const bool stringExpected = valueExpected || state == JsonState::kFirstKey;
  if (rest[0] == '"' && stringExpected) {
    if (const StringMistake mistake = findStringMistake(rest); !mistake.message.empty()) {
      for (std::size_t i = 0; i < mistake.offset; ++i) tokens.skipOne();
      at = tokens.place();
      return here(sceneError(mistake.message, mistake.allowed, mistake.hint));
    }
    return here(sceneError("found a string with a broken \\u escape: half of a surrogate pair",
                           "\\uD800-\\uDBFF followed by \\uDC00-\\uDFFF",
                           "write the character itself, in UTF-8"));
  }
  return here(describeToken(rest, state, afterComma, valueExpected, expected));
}

}  // namespace weir
