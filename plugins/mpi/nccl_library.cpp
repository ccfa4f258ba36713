#include "plugins/mpi/nccl_library.h"

#include <dlfcn.h>

#include <cstdlib>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

namespace {

std::string libraryName() {
  const char* const variable = std::getenv("WEIR_NCCL");
  const std::string given = variable == nullptr ? "" : variable;
  if (given == "off") throw simulationError("WEIR_NCCL is off");
  return given.empty() ? "libnccl.so.2" : given;
}

template <class Function>
void find(void* library, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(library, name));
  if (function == nullptr) throw simulationError(std::string("NCCL has no ") + name);
}

NcclLibrary tableOf(void* library) {
  NcclLibrary nccl{};
  find(library, "ncclGetVersion", nccl.ncclGetVersion);
  find(library, "ncclGetErrorString", nccl.ncclGetErrorString);
  find(library, "ncclGetUniqueId", nccl.ncclGetUniqueId);
  find(library, "ncclCommInitRank", nccl.ncclCommInitRank);
  find(library, "ncclCommDestroy", nccl.ncclCommDestroy);
  find(library, "ncclCommAbort", nccl.ncclCommAbort);
  find(library, "ncclGroupStart", nccl.ncclGroupStart);
  find(library, "ncclGroupEnd", nccl.ncclGroupEnd);
  find(library, "ncclSend", nccl.ncclSend);
  find(library, "ncclRecv", nccl.ncclRecv);
  return nccl;
}

}  // namespace

std::shared_ptr<const NcclLibrary> NcclLibrary::open() {
  const std::string name = libraryName();
  // NVLink's multicast is of no use for sending and receiving, and fails on some machines.
  ::setenv("NCCL_NVLS_ENABLE", "0", 0);
  void* const library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const why = dlerror();
    throw simulationError("NCCL cannot be opened: " + printable(why != nullptr ? why : name, 200));
  }
  return std::make_shared<const NcclLibrary>(tableOf(library));
}

std::string NcclLibrary::version() const {
  int number = 0;  // such as 22809; 2.8 and older had three digits behind the first
  if (ncclGetVersion(&number) != kNcclSuccess) return "of unknown version";
  const int thousand = number < 10000 ? 1000 : 10000;
  return std::to_string(number / thousand) + "." + std::to_string(number % thousand / 100) + "." +
         std::to_string(number % 100);
}

}  // namespace weir
