// Shaders as the build has put them into the program.
#include "plugins/rendering/gl/shaders.h"

#include <gtest/gtest.h>

#include "framework/base/check.h"

namespace weir::rendering::gl {
namespace {

int countOf(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Shaders, HoldEachFileThatTheyIncludeOnce) {
  const std::string source = shaderSource("lighting.frag", "#define TILES\n");
  EXPECT_TRUE(source.starts_with("#version 330 core\n#define TILES\n"));
  EXPECT_EQ(countOf(source, "#include"), 0);
  // Several of its files include the formulas.
  EXPECT_EQ(countOf(source, "real shoulder("), 1);
  EXPECT_EQ(countOf(source, "const vec2 kShadowTaps[4]"), 1);
  EXPECT_EQ(countOf(source, "void main()"), 1);
}

TEST(Shaders, ThatAreMissingAreNamed) {
  try {
    shaderSource("nothing.frag");
    FAIL();
  } catch (const InternalError& error) {
    EXPECT_NE(std::string(error.what()).find("nothing.frag.glsl"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace weir::rendering::gl
