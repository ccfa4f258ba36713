#include "plugins/vtkhdf/isolated.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include "framework/base/error.h"
#include "framework/base/forked_work.h"
#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/packed.h"

namespace weir::hdf5 {

namespace {

/// The first byte of what the child says; without one of these it has said nothing.
enum Outcome : char { kDone = 'd', kError = 'e', kOther = 'o' };

std::string outcomeOf(const std::function<std::string()>& work) {
  try {
    return char{kDone} + work();
  } catch (const Error& error) {
    Packer packer;
    for (const std::string& text : {error.message(), error.allowed(), error.hint(), error.location().file})
      packer.addText(text);
    return char{kError} + packer.take();
  } catch (const std::exception& error) {
    return char{kOther} + std::string(error.what());
  }
}

[[noreturn]] void rethrow(std::string_view packed) {
  Unpacker unpacker(packed);
  std::string message(unpacker.text()), allowed(unpacker.text()), hint(unpacker.text());
  throw ioError(std::move(message), std::move(allowed), std::move(hint))
      .at({.file = std::string(unpacker.text())});
}

}  // namespace

std::string runIsolated(const std::function<std::string()>& work, int cpuSeconds) {
  std::optional<ForkedWork> copy;
  {
    const Session session;  // so that no other thread is within HDF5 while the copy is made
    const auto inCopy = [&] {
      Session::renewLock();
      return outcomeOf(work);
    };
    copy.emplace(inCopy, ForkedLimits{.cpuSeconds = cpuSeconds});
  }
  const ForkedEnd end = copy->wait();
  if (end.outOfTime) throw ioError("the file is damaged: the HDF5 library does not come to an end with it");
  if (!end.done || end.bytes.empty())
    throw ioError("the file is damaged: the HDF5 library crashes when it reads it");
  const std::string& outcome = end.bytes;
  switch (outcome[0]) {
    case kDone:
      return outcome.substr(1);
    case kError:
      rethrow(std::string_view(outcome).substr(1));
    default:
      throw ioError("the file cannot be read: " + outcome.substr(1));
  }
}

int cpuSecondsFor(const std::filesystem::path& file) {
  constexpr double kLeast = 20, kMost = 1e6, kBytesPerSecond = 1e6;
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  return static_cast<int>(error ? kLeast : std::min(kLeast + double(size) / kBytesPerSecond, kMost));
}

}  // namespace weir::hdf5
