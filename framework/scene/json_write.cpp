#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "framework/base/text.h"
#include "framework/scene/layout.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

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

void writeLine(std::string& out, const Value& v) {
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
      writeLine(out, v.asArray()[i]);
    }
    out += ']';
  } else {
    const auto& members = v.asObject();
    out += members.empty() ? "{" : "{ ";
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (i > 0) out += ", ";
      writeString(out, members[i].first);
      out += ": ";
      writeLine(out, members[i].second);
    }
    out += members.empty() ? "}" : " }";
  }
}

}  // namespace

std::string writeJson(const Value& value) {
  return inLayout(writeJsonLine(value));
}

std::string writeJsonLine(const Value& value) {
  std::string out;
  writeLine(out, value);
  return out + "\n";
}

}  // namespace weir
