// What a plugin has to say in `weir info`, such as which renderers work on this machine.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"

namespace WEIR_API weir {

struct InfoEntry {
  std::string name;  ///< "OSMesa"
  std::string text;  ///< "OpenGL 4.5, llvmpipe", or why it does not work
};

/// A service: registry.addService<InfoSource>("rendering", …).
class InfoSource {
 public:
  static constexpr std::string_view kInterface = "InfoSource";
  virtual ~InfoSource() = default;
  /// May take a moment, as it tries things out. Does not throw for what does not work, but says so.
  virtual std::vector<InfoEntry> info() const = 0;
};

}  // namespace weir
