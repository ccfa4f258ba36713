// The ways to get a context. Each function throws an io Error that says why it cannot.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plugins/rendering/gl/context.h"

namespace weir::rendering::gl {

std::unique_ptr<Context> makeEglDeviceContext();       ///< on a GPU
std::unique_ptr<Context> makeEglSurfacelessContext();  ///< Mesa without a window system, CPU or GPU
std::unique_ptr<Context> makeOsMesaContext();

/// The versions of OpenGL that are asked for, the best first.
inline constexpr std::array<std::pair<int, int>, 3> kVersions{{{4, 5}, {4, 3}, {3, 3}}};

/// One way to get a context, and what it is called in messages.
struct Way {
  std::string name;
  std::function<std::unique_ptr<Context>()> make;
};

/// The context of the first way that gives one; else the io Error of makeContext.
std::unique_ptr<Context> firstThatWorks(const std::vector<Way>& ways);

/// A library opened at run time. It is never closed: drivers leave thread-local data behind, and crash when
/// their code goes away before the thread does.
class DriverLibrary {
 public:
  /// Opens the first of these files that there is; throws an io Error with the loader's reasons.
  explicit DriverLibrary(const std::vector<std::string>& fileNames);

  /// Throws an io Error if the library has no such function.
  FunctionFinder::Found function(const char* name) const;

 private:
  void* handle_ = nullptr;
  std::string fileName_;
};

}  // namespace weir::rendering::gl
