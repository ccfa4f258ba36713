#include "framework/base/check.h"

namespace weir::detail {

void failCheck(const char* expression, const std::string& values, const char* file, int line) {
  std::string text = std::string(file) + ":" + std::to_string(line) + ": expected " + expression;
  if (!values.empty()) text += ", but found " + values;
  throw InternalError(text);
}

}  // namespace weir::detail
