// The role of kinds of outputs that every rank of a run can write its part of, so that nobody gathers the
// particles of all.
#pragma once

#include <memory>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/run/output_kind.h"

namespace WEIR_API weir {

class OutputByRanks {
 public:
  virtual ~OutputByRanks() = default;
  /// Whether the scene asks for it. All ranks have the same scene.
  virtual bool isAsked(const Scene& scene) const = 0;
  /// As OutputKind::create, on every rank of several. The observer sees the particles that its rank owns; it
  /// may use the ranks, which outlive it, in all that it does but write().
  virtual std::unique_ptr<Observer> create(const OutputPaths& paths, Communicator& ranks) const = 0;
};

}  // namespace weir
