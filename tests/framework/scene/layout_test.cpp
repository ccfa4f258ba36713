// The layout of scene files: nothing is lost, and a text that has it stays as it is.
#include "framework/scene/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "framework/scene/scene_file.h"
#include "framework/scene/text_tree.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"
#include "tests/support/scene_mutator.h"

namespace weir {
namespace {

using test::errorOf;

std::string formatted(std::string_view text) {
  std::string once = formattedScene(text, "s.json");
  EXPECT_EQ(formattedScene(once, "s.json"), once) << "it is not the layout yet";
  return once;
}

TEST(Layout, CommentsStayWithWhatTheyStandBy) {
  EXPECT_EQ(formatted(R"(// A scene.
/* with two
   comments */

{ "weir": 1, // the version
  "let": {  // variables
    "a": 1, /* one */ "b": 2, // two

    // third
    "c" /* odd */ : /* more */ "=a+b",
    // at the end
  }, "empty": [ /* nothing */ ], "none": {}, "opened": { // x
  },
  "list": [1, /* q */ 2 /* r */, 3, ],
  "lines": [ 1 // one
    , 2 // two
    , 3 ],

  /* before */ "object": { "x": [[0, 1], [2,3]], "y": "a // no comment" },


  "n": 1.50e-3 // end of n
} // end

// tail

/* last */)"),
            R"(// A scene.
/* with two
   comments */

{
  "weir": 1,  // the version
  "let": {  // variables
    "a": 1,
    /* one */ "b": 2,  // two

    // third
    /* odd */ /* more */ "c": "=a+b"
    // at the end
  },
  "empty": [
    /* nothing */
  ],
  "none": {},
  "opened": {
    // x
  },
  "list": [1, /* q */ 2 /* r */, 3],
  "lines": [
    1,  // one
    2,  // two
    3
  ],

  /* before */ "object": { "x": [[0, 1], [2, 3]], "y": "a // no comment" },

  "n": 1.50e-3  // end of n
}  // end

// tail

/* last */
)");
}

TEST(Layout, NumbersAndTextsStayAsTheyAreWritten) {
  const std::string text = "{\n  \"a\": [1.0, 1e3, -0.0, 0.10, \"\\u00e9\\/\", \"é\"]\n}\n";
  EXPECT_EQ(formatted(text), text);
}

TEST(Layout, LongListsHaveAnElementALineAndNumbersFillLines) {
  const std::string word(45, 'a');
  EXPECT_EQ(formatted("{\"a\": [\"" + word + "\", \"" + word + "\"]}"),
            "{\n  \"a\": [\n    \"" + word + "\",\n    \"" + word + "\"\n  ]\n}\n");
  std::string numbers, lines;
  for (int i = 0; i < 30; ++i) {
    numbers += (i > 0 ? "," : "") + std::string("[0,\n0.25]");
    lines += (i == 0 ? "\n    " : i % 8 == 0 ? ",\n    " : ", ") + std::string("[0, 0.25]");
  }
  EXPECT_EQ(formatted("{\"a\": [" + numbers + "]}"), "{\n  \"a\": [" + lines + "\n  ]\n}\n");
}

TEST(Layout, EndsOfLinesAndMarksOfOtherSystemsGo) {
  EXPECT_EQ(formatted("\xEF\xBB\xBF{\r\n\t\"a\": 1, // one \t\r\n /* two\r\n lines */ \"b\": 2\r\n}\r\n"),
            "{\n  \"a\": 1,  // one\n  /* two\n lines */ \"b\": 2\n}\n");
}

TEST(Layout, WhatIsNoSceneIsAnError) {
  EXPECT_CONTAINS(errorOf([] { formattedScene("{\"a\": 1,\n \"b\" 2}", "s.json"); }).what(), "s.json:2:6");
  EXPECT_CONTAINS(errorOf([] { formattedScene("{\"a\": 1} /*", "s.json"); }).what(), "does not end");
}

/// The comments of a tree in the order of the text.
void collect(const TextItem& item, std::vector<std::string>& all) {
  for (const auto* comments : {&item.before, &item.opening})
    for (const TextComment& c : *comments) all.emplace_back(c.text);
  for (const TextItem& each : item.items) collect(each, all);
  for (const auto* comments : {&item.last, &item.after})
    for (const TextComment& c : *comments) all.emplace_back(c.text);
}

std::vector<std::string> commentsOf(std::string_view text) {
  std::vector<std::string> all;
  collect(readTextTree(text), all);
  std::sort(all.begin(), all.end());
  return all;
}

/// The text with comments, line breaks and trailing commas where there may be some.
std::string ruffled(const std::string& text, std::uint64_t seed, int& comments) {
  test::Random random(seed);
  std::string out;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && (i == 0 || text[i - 1] != '\\')) inString = !inString;
    const bool closes = !inString && (c == '}' || c == ']');
    const bool mayBeEmpty = out.find_last_not_of(" \n") != std::string::npos &&
                            std::string("[{,").find(out[out.find_last_not_of(" \n")]) != std::string::npos;
    if (closes && !mayBeEmpty && comments == 0 && random.chance(0.2)) out += ",";
    out += c;
    if (inString || std::string("{}[],:").find(c) == std::string::npos || !random.chance(0.3)) continue;
    const std::string number = std::to_string(comments);
    const std::string kinds[] = {" /* b" + number + " */ ",
                                 " // l" + number + "\n",
                                 "\n\n// o" + number + "\n\n",
                                 "\n/* m\n" + number + " */",
                                 "\n",
                                 "\n\n\n"};
    const std::string& kind = random.pick(kinds);
    if (kind.find('/') != std::string::npos) ++comments;
    out += kind;
  }
  return out;
}

TEST(Layout, NothingIsLostWhereverCommentsStand) {
  const std::string file = test::resourcesFolder() + "/scenes/stirrer.json";
  const Value meaning = parseScene(readTextFile(file, 1 << 20), file);
  const std::string text = writeJson(meaning);  // without its comments
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    int comments = 0;
    const std::string messy = ruffled(text, seed, comments);
    ASSERT_TRUE(parseScene(messy, "s.json") == meaning) << messy;
    const std::string once = formatted(messy);
    ASSERT_TRUE(parseScene(once, "s.json") == meaning) << once;
    ASSERT_EQ(commentsOf(once), commentsOf(messy)) << messy;
    ASSERT_EQ(commentsOf(once).size(), static_cast<std::size_t>(comments));
  }
}

TEST(Layout, TheScenesOfTheProjectKeepTheirMeaning) {
  int scenes = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(test::resourcesFolder() + "/scenes")) {
    if (entry.path().extension() != ".json") continue;
    const std::string file = entry.path().string(), text = readTextFile(file, 1 << 20);
    const Value meaning = parseScene(text, file);
    EXPECT_TRUE(parseScene(formatted(text), file) == meaning) << file;
    EXPECT_EQ(formatted(writeJson(meaning)), writeJson(meaning)) << file;
    ++scenes;
  }
  EXPECT_GT(scenes, 30);
}

}  // namespace
}  // namespace weir
