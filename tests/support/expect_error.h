// Runs something that must throw a weir::Error, and hands the error to the test.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "framework/base/error.h"

namespace weir::test {

/// The error that f throws; a failure of the test, and an empty error, if it throws none.
template <class F>
Error errorOf(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "nothing was thrown";
  return sceneError("nothing was thrown");
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace weir::test

// A macro, so that a failure shows the text and the line of the test.
#define EXPECT_CONTAINS(text, part) EXPECT_PRED2(::weir::test::contains, std::string(text), std::string(part))
