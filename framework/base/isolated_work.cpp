#include "framework/base/isolated_work.h"

#include <string_view>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/packed.h"

namespace weir {

namespace {

/// The first byte of what the copy says; without one of these it has said nothing.
enum Outcome : char { kReturned = 'd', kError = 'e', kOther = 'o' };

std::string outcomeOf(const std::function<std::string()>& work) {
  try {
    return work() + char{kReturned};
  } catch (const Error& error) {
    Packer packer;
    for (const std::string& text : {error.message(), error.allowed(), error.hint(), error.location().file})
      packer.addText(text);
    return packer.take() + char{kError};
  } catch (const std::exception& error) {
    return std::string(error.what()) + char{kOther};
  }
}

[[noreturn]] void rethrow(std::string_view packed) {
  Unpacker unpacker(packed);
  std::string message(unpacker.text()), allowed(unpacker.text()), hint(unpacker.text());
  throw ioError(std::move(message), std::move(allowed), std::move(hint))
      .at({.file = std::string(unpacker.text())});
}

}  // namespace

IsolatedWork::IsolatedWork(const std::function<std::string()>& work, const ForkedLimits& limits,
                           std::string library)
    : limits_(limits), library_(std::move(library)), copy_([&] { return outcomeOf(work); }, limits) {}

std::string IsolatedWork::finish() {
  ForkedEnd end = copy_.wait();
  metLimit_ = end.outOfTime || end.outOfMemory;
  if (end.outOfTime) throw ioError("the file is damaged: " + library_ + " does not come to an end with it");
  if (end.outOfMemory)
    throw ioError(library_ + " takes more memory for the file than it may have",
                  std::to_string(limits_.memoryBytes >> 20) + " MB");
  if (!end.done || end.bytes.empty())
    throw ioError("the file is damaged: " + library_ + " crashes when it reads it");
  const char outcome = end.bytes.back();
  end.bytes.pop_back();
  if (outcome == kError) rethrow(end.bytes);
  if (outcome == kOther) throw ioError("the file cannot be read: " + end.bytes);
  return std::move(end.bytes);
}

}  // namespace weir
