// A variable of the environment for as long as this lives.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace weir::test {

class VariableFor {
 public:
  VariableFor(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value, 1);
  }
  ~VariableFor() { before_ ? ::setenv(name_.c_str(), before_->c_str(), 1) : ::unsetenv(name_.c_str()); }
  VariableFor(const VariableFor&) = delete;
  VariableFor& operator=(const VariableFor&) = delete;

 private:
  std::string name_;
  std::optional<std::string> before_;
};

}  // namespace weir::test
