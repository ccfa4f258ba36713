#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

constexpr std::size_t kLineWidth = 100;
constexpr std::size_t kIndent = 2;

void writeString(std::string& out, std::string_view text) {
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD
  out += '"';
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const std::size_t length = utf8Length(text, i);
    if (length == 0)
      out += kReplacement;
    else if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += text.substr(i, length);
    i += length == 0 ? 1 : length;
  }
  out += '"';
}

void writeDouble(std::string& out, double d) {
  if (!std::isfinite(d)) {
    out += "null";
    return;
  }
  if (d == 0 && std::signbit(d)) {
    out += "-0.0";
    return;
  }
  // Long whole numbers need their exponent, or they would be read as integers that do not fit.
  constexpr double kLongestWhole = 1e15;
  char text[32];
  const auto format =
      std::abs(d) < kLongestWhole ? std::chars_format::general : std::chars_format::scientific;
  const auto end = format == std::chars_format::general ? std::to_chars(text, text + sizeof text, d)
                                                        : std::to_chars(text, text + sizeof text, d, format);
  out.append(text, end.ptr);
}

/// Writes on one line; stops as soon as `out` is longer than `longest`, and says so.
bool writeLine(std::string& out, const Value& v, std::size_t longest) {
  if (v.isNull()) {
    out += "null";
  } else if (v.isBool()) {
    out += v.asBool() ? "true" : "false";
  } else if (v.isInt()) {
    out += std::to_string(v.asInt());
  } else if (v.isNumber()) {
    writeDouble(out, v.asDouble());
  } else if (v.isString()) {
    writeString(out, v.asString());
  } else if (v.isArray()) {
    out += '[';
    for (std::size_t i = 0; i < v.asArray().size(); ++i) {
      if (i > 0) out += ", ";
      if (!writeLine(out, v.asArray()[i], longest)) return false;
    }
    out += ']';
  } else {
    const auto& members = v.asObject();
    out += members.empty() ? "{" : "{ ";
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (i > 0) out += ", ";
      writeString(out, members[i].first);
      out += ": ";
      if (!writeLine(out, members[i].second, longest)) return false;
    }
    out += members.empty() ? "}" : " }";
  }
  return out.size() <= longest;
}

/// Writes at the end of a line that holds `column` characters already.
void write(std::string& out, const Value& v, std::size_t indent, std::size_t column, bool mayBeOneLine) {
  const bool container = v.isArray() || v.isObject();
  const bool empty = container && (v.isArray() ? v.asArray().empty() : v.asObject().empty());
  std::string line;
  const std::size_t room = column < kLineWidth ? kLineWidth - column : 0;
  if (!container || empty || (mayBeOneLine && writeLine(line, v, room))) {
    if (line.empty()) writeLine(line, v, std::string::npos);
    out += line;
    return;
  }
  const std::string newLine = "\n" + std::string(indent + kIndent, ' ');
  out += v.isArray() ? '[' : '{';
  const std::size_t count = v.isArray() ? v.asArray().size() : v.asObject().size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t lineStart = out.size() + (i > 0 ? 2 : 1);
    out += (i > 0 ? "," : "") + newLine;
    if (v.isObject()) {
      writeString(out, v.asObject()[i].first);
      out += ": ";
    }
    const Value& child = v.isArray() ? v.asArray()[i] : v.asObject()[i].second;
    // One more than it holds: a comma may follow.
    write(out, child, indent + kIndent, out.size() - lineStart + 2, true);
  }
  out += "\n" + std::string(indent, ' ') + (v.isArray() ? ']' : '}');
}

}  // namespace

std::string writeJson(const Value& value) {
  std::string out;
  const bool mayBeOneLine = !value.isObject();  // a scene always has one member a line
  write(out, value, 0, 0, mayBeOneLine);
  return out + "\n";
}

std::string writeJsonLine(const Value& value) {
  std::string out;
  writeLine(out, value, std::string::npos);
  return out + "\n";
}

}  // namespace weir
