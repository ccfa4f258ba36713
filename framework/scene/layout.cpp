#include "framework/scene/layout.h"

#include <algorithm>

#include "framework/base/check.h"
#include "framework/scene/scene_file.h"
#include "framework/scene/text_tree.h"

namespace weir {

namespace {

constexpr std::size_t kLineWidth = 100;
constexpr std::size_t kIndent = 2;

bool isLineComment(const TextComment& comment) {
  return comment.text.starts_with("//");
}

/// Without what an editor for another system has put at the ends of its lines.
std::string textOf(const TextComment& comment) {
  std::string text;
  for (std::size_t i = 0; i < comment.text.size(); ++i)
    if (comment.text.substr(i, 2) != "\r\n") text += comment.text[i];
  return text;
}

/// Whether an item can stand on a line with others.
bool mayShareLine(const TextItem& item) {
  const auto ends = [](const TextComment& c) {
    return c.endsLine || isLineComment(c) || c.text.find('\n') != std::string_view::npos;
  };
  return std::none_of(item.before.begin(), item.before.end(), ends) &&
         std::none_of(item.after.begin(), item.after.end(), ends);
}

bool isPlain(const TextItem& item) {
  return item.before.empty() && item.after.empty() && !item.blankLineBefore;
}

/// A number, true, false or null.
bool isWord(const TextItem& item) {
  return !item.isContainer() && !item.value.starts_with('"') && isPlain(item);
}

/// A list of numbers or of short lists of them, such as a profile, which has as many on a line as fit.
bool isTable(const TextItem& list) {
  const auto isEntry = [](const TextItem& item) {
    constexpr std::size_t kMaxInEntry = 8;
    return isWord(item) ||
           (item.value.starts_with('[') && isPlain(item) && item.opening.empty() && item.last.empty() &&
            item.items.size() <= kMaxInEntry && std::all_of(item.items.begin(), item.items.end(), isWord));
  };
  return list.value.starts_with('[') && list.opening.empty() && list.last.empty() &&
         std::all_of(list.items.begin(), list.items.end(), isEntry);
}

class Layout {
 public:
  std::string document(const TextItem& document) {
    writeBefore(document.items.front(), 0);
    const TextItem& root = document.items.front();
    write(root, 0, 0, !root.isObject());  // a scene always has one member a line
    writeAfter(root);
    out_ += '\n';
    for (const TextComment& comment : document.last)
      out_ += (comment.blankLineBefore ? "\n" : "") + textOf(comment) + "\n";
    return std::move(out_);
  }

 private:
  /// Writes on one line; stops as soon as `out` is longer than `longest`, and says so.
  static bool writeLine(std::string& out, const TextItem& item, std::size_t longest) {
    if (!item.isContainer()) {
      out += item.value;
      return out.size() <= longest;
    }
    if (!item.opening.empty() || !item.last.empty()) return false;
    const bool padded = item.isObject() && !item.items.empty();
    out += item.value.front();
    if (padded) out += ' ';
    for (const TextItem& member : item.items) {
      const bool isFirst = &member == &item.items.front();
      if (!mayShareLine(member) || startsWithBlankLine(member)) return false;
      if (!isFirst) out += ", ";
      for (const TextComment& comment : member.before) out.append(comment.text).append(" ");
      if (!member.name.empty()) out.append(member.name).append(": ");
      if (!writeLine(out, member, longest)) return false;
      for (const TextComment& comment : member.after) out.append(" ").append(comment.text);
    }
    if (padded) out += ' ';
    out += item.value.back();
    return out.size() <= longest;
  }

  /// Writes at the end of a line that holds `column` characters already.
  void write(const TextItem& item, std::size_t indent, std::size_t column, bool mayBeOneLine) {
    const bool isEmpty = item.items.empty() && item.last.empty();
    std::string line;
    const std::size_t room = column < kLineWidth ? kLineWidth - column : 0;
    if (!item.isContainer() || isEmpty) {
      writeLine(out_, item, std::string::npos);
    } else if (mayBeOneLine && writeLine(line, item, room)) {
      out_ += line;
    } else if (isTable(item)) {
      writeTable(item, indent);
    } else {
      writeItems(item, indent);
    }
  }

  void writeTable(const TextItem& table, std::size_t indent) {
    out_ += '[';
    newLine(indent + kIndent, false);
    std::size_t lineStart = out_.size() - indent - kIndent;
    for (const TextItem& item : table.items) {
      const bool isFirst = &item == &table.items.front();
      std::string entry;
      writeLine(entry, item, std::string::npos);
      if (!isFirst && out_.size() - lineStart + 2 + entry.size() + 1 > kLineWidth) {
        out_ += ',';
        newLine(indent + kIndent, false);
        lineStart = out_.size() - indent - kIndent;
      } else if (!isFirst) {
        out_ += ", ";
      }
      out_ += entry;
    }
    newLine(indent, false);
    out_ += ']';
  }

  void writeItems(const TextItem& parent, std::size_t indent) {
    out_ += parent.value.front();
    for (const TextComment& comment : parent.opening) out_ += "  " + textOf(comment);
    for (const TextItem& item : parent.items) {
      newLine(indent + kIndent, startsWithBlankLine(item));
      const std::size_t lineStart = writeBefore(item, indent + kIndent);
      if (!item.name.empty()) out_.append(item.name).append(": ");
      // One more than it holds: a comma may follow.
      write(item, indent + kIndent, out_.size() - lineStart + 2, true);
      if (&item != &parent.items.back()) out_ += ',';
      writeAfter(item);
    }
    for (const TextComment& comment : parent.last) {
      const bool isFirst = parent.items.empty() && &comment == &parent.last.front();
      newLine(indent + kIndent, comment.blankLineBefore && !isFirst);
      out_ += textOf(comment);
    }
    newLine(indent, false);
    out_ += parent.value.back();
  }

  static bool startsWithBlankLine(const TextItem& item) {
    return item.before.empty() ? item.blankLineBefore : item.before.front().blankLineBefore;
  }

  void newLine(std::size_t indent, bool afterBlankLine) {
    out_.append(afterBlankLine ? "\n\n" : "\n").append(indent, ' ');
  }

  /// Writes the comments in front of an item; where the line of the item starts.
  std::size_t writeBefore(const TextItem& item, std::size_t indent) {
    std::size_t lineStart = out_.size() - indent;
    for (std::size_t i = 0; i < item.before.size(); ++i) {
      const TextComment& comment = item.before[i];
      const bool isLast = i + 1 == item.before.size();
      out_ += textOf(comment);
      if (comment.endsLine) {
        newLine(indent, isLast ? item.blankLineBefore : item.before[i + 1].blankLineBefore);
        lineStart = out_.size() - indent;
      } else {
        out_ += ' ';
      }
    }
    return lineStart;
  }

  void writeAfter(const TextItem& item) {
    for (const TextComment& comment : item.after) out_ += "  " + textOf(comment);
  }

  std::string out_;
};

}  // namespace

std::string inLayout(std::string_view text) {
  return Layout().document(readTextTree(text));
}

std::string formattedScene(std::string_view text, const std::string& fileName) {
  const Value meaning = parseScene(text, fileName);
  std::string formatted = inLayout(text);
  WEIR_CHECK(parseScene(formatted, fileName) == meaning);
  return formatted;
}

}  // namespace weir
