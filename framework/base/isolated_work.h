// Reading other people's files with other people's libraries, which crash, hang or take all memory on some
// damaged ones: in a copy of this process with limits. What goes wrong there is an Error here.
#pragma once

#include <functional>
#include <string>

#include "framework/base/api.h"
#include "framework/base/forked_work.h"

namespace WEIR_API weir {

/// Runs `work` in a copy of this process, whose only thread is the one that runs it.
class IsolatedWork {
 public:
  /// `library` is who reads the file, for messages: "the HDF5 library". Throws an io Error if the copy cannot
  /// be made.
  IsolatedWork(const std::function<std::string()>& work, const ForkedLimits& limits, std::string library);

  /// Waits and returns the bytes that `work` returned. Throws the Error that it threw; an io Error without a
  /// place if the copy crashed, threw anything else, or asked for more than it may have. To be called once.
  std::string finish();
  /// Whether finish() found that the copy had used up its time or memory.
  bool metLimit() const { return metLimit_; }

 private:
  ForkedLimits limits_;
  std::string library_;
  bool metLimit_ = false;
  ForkedWork copy_;
};

}  // namespace weir
