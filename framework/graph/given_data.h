// Data that a node was given by a program, such as arrays of Python, in place of a file.
//
// It stands in no scene file. A checkpoint keeps its digest, so that it does not go on with other data.
#pragma once

#include <cstdint>
#include <optional>

namespace weir {

class GivenData {
 public:
  /// Of all the data; nothing if the node has none and goes by its parameters.
  virtual std::optional<std::uint32_t> givenDigest() const = 0;

 protected:
  ~GivenData() = default;
};

}  // namespace weir
