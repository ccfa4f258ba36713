// NCCL, opened at run time: few need it, and builds do not ask for it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

struct CUstream_st;

namespace weir {

// As in NCCL's documentation, of which this is the part that is used.
// https://docs.nvidia.com/deeplearning/nccl/user-guide/docs/api.html
struct NcclComm;
using NcclCommunicator = NcclComm*;
struct NcclUniqueId {
  char internal[128];
};
using NcclResult = int;
inline constexpr NcclResult kNcclSuccess = 0;
using NcclDataType = int;
inline constexpr NcclDataType kNcclInt8 = 0;

struct NcclLibrary {
  /// By the environment variable WEIR_NCCL, which is a name, a path or "off", or by its usual name. Throws a
  /// simulation Error that says why it cannot be used. Stays open.
  static std::shared_ptr<const NcclLibrary> open();

  /// "2.28.9"
  std::string version() const;

  NcclResult (*ncclGetVersion)(int* version);
  const char* (*ncclGetErrorString)(NcclResult result);
  NcclResult (*ncclGetUniqueId)(NcclUniqueId* id);
  NcclResult (*ncclCommInitRank)(NcclCommunicator* comm, int ranks, NcclUniqueId id, int rank);
  NcclResult (*ncclCommDestroy)(NcclCommunicator comm);
  NcclResult (*ncclCommAbort)(NcclCommunicator comm);
  NcclResult (*ncclGroupStart)();
  NcclResult (*ncclGroupEnd)();
  NcclResult (*ncclSend)(const void* from, std::size_t count, NcclDataType type, int peer,
                         NcclCommunicator comm, CUstream_st* stream);
  NcclResult (*ncclRecv)(void* to, std::size_t count, NcclDataType type, int peer, NcclCommunicator comm,
                         CUstream_st* stream);
};

}  // namespace weir
