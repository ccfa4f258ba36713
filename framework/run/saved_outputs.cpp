#include "framework/run/saved_outputs.h"

namespace weir {

void saveOutputs(std::span<Observer* const> observers, const StateWriter& to) {
  for (Observer* observer : observers)
    if (!observer->stateName().empty()) observer->save(to.in(observer->stateName()));
}

}  // namespace weir
