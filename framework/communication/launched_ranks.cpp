#include "framework/communication/launched_ranks.h"

#include <cstdlib>

namespace weir {

bool isOneOfALaunch() {
  const auto number = [](const char* variable) {
    const char* text = std::getenv(variable);
    return text != nullptr ? std::atoi(text) : 0;
  };
  const bool hasPmix = std::getenv("PMIX_RANK") != nullptr;
  return number("OMPI_COMM_WORLD_SIZE") > 1 || number("PMI_SIZE") > 1 ||
         (hasPmix && number("SLURM_STEP_NUM_TASKS") > 1);
}

}  // namespace weir
