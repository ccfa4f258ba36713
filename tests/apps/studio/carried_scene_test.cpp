// Videos carry their scene where the formats allow what programs pass over: read here as the formats say.
#include "apps/studio/session/carried_scene.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/support/child_process.h"

namespace weir::studio {
namespace {

using std::string_literals::operator""s;

class CarriedSceneTest : public testing::Test {
 protected:
  /// What comes behind the video, of whose file `kept` bytes stay as they are.
  std::string added(const std::string& name, const std::string& video, std::size_t kept) {
    folder.write(name, video);
    carryScene(folder / name, scene);
    const std::string text = test::readFile(folder / name);
    EXPECT_EQ(text.substr(0, kept), video.substr(0, kept));
    return text.substr(kept);
  }
  static std::uint64_t number(const std::string& bytes, std::size_t from, std::size_t count) {
    std::uint64_t v = 0;
    for (std::size_t i = from; i < from + count; ++i) v = v << 8 | static_cast<unsigned char>(bytes[i]);
    return v;
  }

  const std::string scene = "{\"title\": \"" + std::string(600, 'x') + "\"}";
  const std::string content = "weir-scene-json1" + scene;
  test::TemporaryFolder folder;
};

TEST_F(CarriedSceneTest, OfMp4AndMovIsABox) {
  for (const char* name : {"a.mp4", "a.mov"}) {
    const std::string box = added(name, "video", 5);
    EXPECT_EQ(number(box, 0, 4), box.size());
    EXPECT_EQ(box.substr(4), "uuid" + content);
  }
}

TEST_F(CarriedSceneTest, OfMkvAndWebmIsAnElementVoid) {
  for (const char* name : {"a.mkv", "a.webm"}) {
    const std::string element = added(name, "video", 5);
    EXPECT_EQ(element.substr(0, 2), "\xec\x01"s);
    EXPECT_EQ(number(element, 2, 7), content.size());
    EXPECT_EQ(element.substr(9), content);
  }
}

TEST_F(CarriedSceneTest, OfGifIsACommentBeforeTheTrailer) {
  const std::string comment = added("a.gif", "video;", 5);
  EXPECT_EQ(comment.substr(0, 2), "!\xfe"s);
  std::string text;
  std::size_t at = 2;
  while (const std::size_t size = number(comment, at, 1)) {
    text += comment.substr(at + 1, size);
    at += 1 + size;
  }
  EXPECT_EQ(text, content);
  EXPECT_EQ(comment.substr(at), "\0;"s);
}

}  // namespace
}  // namespace weir::studio
