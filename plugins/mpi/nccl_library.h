// NCCL, opened at run time: few need it, and builds do not ask for it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

struct CUstream_st;

namespace weir {

// As in NCCL's documentation, of which this is the part that is used.
// https://docs.nvidia.com/deeplearning/nccl/user-guide/docs/api.html
struct ncclComm;
using ncclComm_t = ncclComm*;
struct ncclUniqueId {
  char internal[128];
};
using ncclResult_t = int;
inline constexpr ncclResult_t kNcclSuccess = 0;
using ncclDataType_t = int;
inline constexpr ncclDataType_t kNcclInt8 = 0;

struct NcclLibrary {
  /// By the environment variable WEIR_NCCL, which is a name, a path or "off", or by its usual name. Throws a
  /// simulation Error that says why it cannot be used. Stays open.
  static std::shared_ptr<const NcclLibrary> open();

  /// Whether the environment variable WEIR_NCCL names a library.
  static bool isNamed();

  /// "2.28.9"
  std::string version() const;

  ncclResult_t (*ncclGetVersion)(int* version);
  const char* (*ncclGetErrorString)(ncclResult_t result);
  ncclResult_t (*ncclGetUniqueId)(ncclUniqueId* id);
  ncclResult_t (*ncclCommInitRank)(ncclComm_t* comm, int ranks, ncclUniqueId id, int rank);
  ncclResult_t (*ncclCommDestroy)(ncclComm_t comm);
  ncclResult_t (*ncclCommAbort)(ncclComm_t comm);
  ncclResult_t (*ncclGroupStart)();
  ncclResult_t (*ncclGroupEnd)();
  ncclResult_t (*ncclSend)(const void* from, std::size_t count, ncclDataType_t type, int peer,
                           ncclComm_t comm, CUstream_st* stream);
  ncclResult_t (*ncclRecv)(void* to, std::size_t count, ncclDataType_t type, int peer, ncclComm_t comm,
                           CUstream_st* stream);
};

}  // namespace weir
