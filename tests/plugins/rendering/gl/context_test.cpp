#include "plugins/rendering/gl/context.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <thread>

#include "framework/base/error.h"
#include "plugins/rendering/gl/providers.h"
#include "tests/plugins/rendering/gl/like_pictures.h"
#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering::gl {
namespace {

/// A bit of everything: particles, matt, metal and glass surfaces, lines, ground, shadows.
Picture drawExample(Renderer& renderer, int width = 320, int height = 240) {
  std::vector<Vec3f> positions;
  std::vector<float> values;
  for (int i = 0; i < 500; ++i) {
    const float a = 0.37f * float(i);
    positions.push_back({0.6f * std::cos(a), 0.05f + 0.002f * float(i), 0.6f * std::sin(a)});
    values.push_back(float(i) / 500);
  }
  const std::vector<Vec3f> points{{-1, 0, -1}, {1, 2, -1}};
  const MeshId mesh =
      renderer.addMesh(quad({-0.5f, 0, 0.9f}, {0.5f, 0, 0.9f}, {0.5f, 1, 0.9f}, {-0.5f, 1, 0.9f}));
  View view;
  view.width = width;
  view.height = height;
  view.camera.target = {0, 0.4f, 0};
  view.particles = {{.positions = positions, .values = values, .radius = 0.05f}};
  view.surfaces = {{.mesh = mesh, .look = SurfaceLook::kGlass},
                   {.mesh = mesh, .look = SurfaceLook::kMetal, .position = {1, 0, 0}},
                   {.mesh = mesh, .look = SurfaceLook::kMatt, .position = {-1, 0, 0}}};
  view.lines = {{.points = points}};
  return renderer.draw(view);
}

std::unique_ptr<Context> contextOrNull(Provider provider) {
  try {
    return makeContext(provider);
  } catch (const Error&) {
    return nullptr;
  }
}

TEST(GlContext, SaysWhatItIs) {
  const auto context = makeContext();
  EXPECT_NE(context->description().find("OpenGL"), std::string::npos) << context->description();
}

TEST(GlContext, TwoRenderersDrawInTurn) {
  Renderer first(makeContext()), second(makeContext());
  const Picture a = drawExample(first);
  const Picture b = drawExample(second, 200, 100);
  EXPECT_EQ(drawExample(first).rgb, a.rgb);
  EXPECT_EQ(drawExample(second, 200, 100).rgb, b.rgb);
}

TEST(GlContext, DrawsFromAnotherThread) {
  Renderer renderer(makeContext());
  const Picture here = drawExample(renderer);
  Picture there;
  std::thread([&] { there = drawExample(renderer); }).join();
  EXPECT_EQ(here.rgb, there.rgb);
}

TEST(GlContext, PicturesDoNotDependOnTheProvider) {
  auto egl = contextOrNull(Provider::kEgl), osMesa = contextOrNull(Provider::kOsMesa);
  if (!egl || !osMesa) GTEST_SKIP() << "only one of EGL and OSMesa is installed";
  // A GPU does not cover the same samples along an edge as Mesa does.
  const bool bothMesa = egl->description().find("llvmpipe") != std::string::npos;
  Renderer first(std::move(egl)), second(std::move(osMesa));
  const Picture wanted = drawExample(second);
  expectLike(wanted, drawExample(first), bothMesa ? 0 : wanted.width * wanted.height / 500);
}

TEST(GlContext, WithoutOneTheErrorSaysWhatWasTried) {
  const auto failing = [](const char* why) {
    return [why]() -> std::unique_ptr<Context> { throw ioError(why); };
  };
  try {
    firstThatWorks({{"first way", failing("no library")}, {"second way", failing("no driver")}});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    for (const char* part : {"first way: no library", "second way: no driver", "libegl1"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(GlContext, MissingLibrariesAndFunctionsAreErrors) {
  try {
    DriverLibrary({"libweir_not_there.so.1", "libweir_not_there.so.2"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_NE(std::string(error.what()).find("libweir_not_there.so.2"), std::string::npos) << error.what();
  }
  const FunctionFinder nothing([](const char*) -> GenericFunction { return nullptr; });
  EXPECT_THROW(nothing("glClear"), Error);
}

TEST(GlContext, EnvironmentChoosesTheProvider) {
  const char* before = std::getenv("WEIR_GL");
  const std::string saved = before ? before : "";
  setenv("WEIR_GL", "vulkan", 1);
  try {
    makeContext();
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  }
  if (contextOrNull(Provider::kOsMesa)) {
    setenv("WEIR_GL", "osmesa", 1);
    EXPECT_NE(makeContext()->description().find("through OSMesa"), std::string::npos);
  }
  before ? setenv("WEIR_GL", saved.c_str(), 1) : unsetenv("WEIR_GL");
}

}  // namespace
}  // namespace weir::rendering::gl
