// Versions of what changes in place, for whoever keeps something that was made from it. On the host alone.
#pragma once

#include <cstdint>
#include <memory>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// The contents of something at one moment. May outlive it.
class Version {
 public:
  /// Of nothing.
  Version() = default;

  /// Whether these contents are still the present ones.
  bool isPresent() const { return present_ != nullptr && *present_ == number_; }
  friend bool operator==(const Version&, const Version&) = default;

 private:
  friend class VersionCounter;
  Version(std::shared_ptr<const std::uint64_t> present, std::uint64_t number)
      : present_(std::move(present)), number_(number) {}

  std::shared_ptr<const std::uint64_t> present_;
  std::uint64_t number_ = 0;
};

/// Stands beside what changes.
class VersionCounter {
 public:
  VersionCounter() = default;
  /// No contents of what is no more are present.
  ~VersionCounter() { advance(); }
  VersionCounter(const VersionCounter&) = delete;
  VersionCounter& operator=(const VersionCounter&) = delete;

  void advance() { ++*number_; }
  Version version() const { return {number_, *number_}; }

 private:
  std::shared_ptr<std::uint64_t> number_ = std::make_shared<std::uint64_t>(0);
};

}  // namespace weir
