// A layer under a program (LD_PRELOAD) that makes one of its calls of the C library fail, or writes down what
// it does to files. The environment says what:
//
//  - WEIR_FAULT_PROGRAM: the program that is meant, "weir"; others, such as those that it starts, are left
//  alone
//  - WEIR_FAULT_FOLDER: calls of files count below this folder only
//  - WEIR_FAULT_CALL: open, write, fsync, rename, close, malloc, malloc-hdf5 for allocations by HDF5, or
//  malloc-load for those of static objects of libraries that plugins load
//  - WEIR_FAULT_AT: which of these calls fails, from 1 on
//  - WEIR_FAULT_AS: ENOSPC, EIO, EINTR, EMFILE, ENOMEM, or short: half of a write, the rest fails with ENOSPC
//  - WEIR_FAULT_COUNTS: a file for the numbers of calls, added at the end
//  - WEIR_FAULT_PLACES: a file for where each of these calls comes from: a number of 8 bytes for each call
//  from the first on, the same number for the same functions that called one another
//  - WEIR_FAULT_RECORD: a file for what is done to files, for power_cut.py
//  - WEIR_FAULT_FROM: a file for the functions that the failing call came from
//
// Calls are counted from the start of main() on, over the process and its forked copies together. The library
// takes no memory itself and opens its own files by system calls.
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
}

namespace {

enum Kind { kOpen, kWrite, kFsync, kRename, kClose, kMalloc, kMallocByHdf5, kMallocAtLoad, kKinds };
constexpr const char* kNames[kKinds] = {"open",  "write",  "fsync",       "rename",
                                        "close", "malloc", "malloc-hdf5", "malloc-load"};
constexpr long kMostPlaces = 1L << 20;

/// Shared by the process and its forked copies.
struct Shared {
  std::atomic<long> calls[kKinds];
  std::atomic<long> failed;
  uint64_t places[kMostPlaces];  // where calls of the kind that is asked for came from
};

Shared* shared = nullptr;  // null while nothing is counted
char folder[PATH_MAX] = "";
Kind failing = kKinds;
long failingAt = 0;
int failure = 0;
bool isShort = false;
bool notesPlaces = false;
int record = -1;
pid_t first = 0;
__attribute__((tls_model("initial-exec"))) thread_local bool inside = false;
__attribute__((tls_model("initial-exec"))) thread_local int loading = 0;  // calls of dlopen() under way

template <class F>
F next(F, const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}
#define NEXT(f) static const auto real = next(&f, #f)

int errorOf(const char* name) {
  struct {
    const char* name;
    int value;
  } const all[] = {{"ENOSPC", ENOSPC}, {"EIO", EIO},       {"EINTR", EINTR},
                   {"EMFILE", EMFILE}, {"ENOMEM", ENOMEM}, {"short", ENOSPC}};
  for (const auto& entry : all)
    if (strcmp(entry.name, name) == 0) return entry.value;
  return EIO;
}

/// Of the functions that called one another, by FNV-1a over the places where they go on.
uint64_t placeOfCall() {
  constexpr int kDepth = 24;
  void* callers[kDepth];
  inside = true;  // it may allocate
  const int depth = backtrace(callers, kDepth);
  inside = false;
  uint64_t place = 14695981039346656037ULL;
  for (int k = 0; k < depth; ++k)
    place = (place ^ reinterpret_cast<uintptr_t>(callers[k])) * 1099511628211ULL;
  return place;
}

void writeCallers() {
  const char* file = getenv("WEIR_FAULT_FROM");
  if (file == nullptr) return;
  constexpr int kDepth = 64;
  void* callers[kDepth];
  inside = true;
  const int depth = backtrace(callers, kDepth);
  const int fd = static_cast<int>(syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_TRUNC, 0666));
  backtrace_symbols_fd(callers, depth, fd);
  syscall(SYS_close, fd);
  inside = false;
}

/// Whether it is the call that fails; errno is set then.
bool fails(Kind kind) {
  if (shared == nullptr || inside) return false;
  const long call = ++shared->calls[kind];
  if (notesPlaces && kind == failing && call <= kMostPlaces) shared->places[call - 1] = placeOfCall();
  if (kind != failing || failingAt == 0) return false;
  // What is full stays full: after a short write the next ones fail, too.
  const bool now = call == failingAt || (isShort && kind == kWrite && call > failingAt);
  if (!now) return false;
  ++shared->failed;
  if (call == failingAt) writeCallers();
  errno = failure;
  return true;
}

bool isBelow(const char* path) {
  return folder[0] != 0 && strncmp(path, folder, strlen(folder)) == 0;
}

/// Where the code of HDF5 stands, once a plugin has loaded it.
struct {
  std::atomic<uintptr_t> begin, end;
} hdf5;

int noteHdf5(dl_phdr_info* library, size_t, void*) {
  if (strstr(library->dlpi_name, "libhdf5") == nullptr) return 0;
  for (int k = 0; k < library->dlpi_phnum; ++k) {
    const auto& part = library->dlpi_phdr[k];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
    hdf5.begin = library->dlpi_addr + part.p_vaddr;
    hdf5.end = hdf5.begin + part.p_memsz;
  }
  return 1;
}

bool isInHdf5(const void* address) {
  const auto at = reinterpret_cast<uintptr_t>(address);
  return at >= hdf5.begin && at < hdf5.end;
}

/// Whether HDF5 is among the callers, as where it calls strdup() or vasprintf().
bool isBelowHdf5() {
  if (hdf5.end == 0) return false;
  constexpr int kDepth = 64;
  void* callers[kDepth];
  inside = true;  // it may allocate
  const int depth = backtrace(callers, kDepth);
  inside = false;
  for (int k = 0; k < depth; ++k)
    if (isInHdf5(callers[k])) return true;
  return false;
}

/// Whether the loader of libraries itself asks, and not the static objects that it has made.
bool isInLoader(const void* caller) {
  Dl_info library = {};
  return dladdr(caller, &library) != 0 &&
         reinterpret_cast<uintptr_t>(library.dli_fbase) == static_cast<uintptr_t>(getauxval(AT_BASE));
}

/// HDF5 crashes or exits where some of its own allocations fail, and static objects of other libraries may
/// crash, which says nothing of whoever uses them.
bool allocationFails(const void* caller) {
  if (loading > 0 && shared != nullptr && !inside && !isInLoader(caller)) return fails(kMallocAtLoad);
  if (isInHdf5(caller)) return fails(kMallocByHdf5);
  return fails(kMalloc) && !isBelowHdf5();
}

/// The path of an open file; false for what is not a file below the folder.
bool pathOf(int fd, char* path) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = syscall(SYS_readlink, link, path, PATH_MAX - 1);
  if (length <= 0) return false;
  path[length] = 0;
  return isBelow(path);
}

/// Whether a call of this kind can fail for this reason: a disk is full only for what makes a file larger.
bool wantsRoom(int fd, off_t end) {
  if (failure != ENOSPC) return true;
  struct stat status = {};
  return fstat(fd, &status) != 0 || !S_ISREG(status.st_mode) || end > status.st_size;
}

bool isMeant(int fd) {
  if (shared == nullptr || inside || fd < 0) return false;
  const int before = errno;
  char path[PATH_MAX];
  const bool meant = pathOf(fd, path);
  errno = before;
  return meant;
}

/// Paths are taken as they are written: the scenarios name all outputs by absolute paths.
bool isMeant(const char* path) {
  return shared != nullptr && !inside && path != nullptr && isBelow(path);
}

void put(const void* bytes, size_t size) {
  const char* at = static_cast<const char*>(bytes);
  while (size > 0) {
    const long written = syscall(SYS_write, record, at, size);
    if (written <= 0) _exit(99);
    at += written;
    size -= static_cast<size_t>(written);
  }
}

/// One entry: a line of text, and the bytes that were written. One system call for each line keeps the
/// entries of several threads apart; only checkpoints are recorded, which one thread writes.
template <class... Values>
void note(const char* format, Values... values) {
  if (record < 0) return;
  const int before = errno;
  char line[2 * PATH_MAX + 100];
  const int length = snprintf(line, sizeof line, format, values...);
  put(line, static_cast<size_t>(length));
  errno = before;
}

unsigned long inodeOf(int fd) {
  struct stat status = {};
  return fstat(fd, &status) == 0 ? status.st_ino : 0;
}

void noteWrite(int fd, off_t at, const void* bytes, ssize_t written) {
  if (record < 0 || written <= 0) return;
  const off_t from = at >= 0 ? at : lseek(fd, 0, SEEK_CUR) - written;
  note("write %lu %ld %zd\n", inodeOf(fd), static_cast<long>(from), written);
  put(bytes, static_cast<size_t>(written));
}

int noteOpen(const char* path, int flags, int fd) {
  if (record >= 0 && fd >= 0 && (flags & (O_CREAT | O_TRUNC)) != 0) {
    note("create %lu %s\n", inodeOf(fd), path);
    if ((flags & O_TRUNC) != 0) note("truncate %lu 0\n", inodeOf(fd));
  }
  return fd;
}

void writePlaces() {
  const char* file = getenv("WEIR_FAULT_PLACES");
  if (file == nullptr || failing == kKinds) return;
  const int fd = static_cast<int>(syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_TRUNC, 0666));
  const long count = shared->calls[failing];
  const char* at = reinterpret_cast<const char*>(shared->places);
  size_t size = sizeof(uint64_t) * static_cast<size_t>(count < kMostPlaces ? count : kMostPlaces);
  for (long written = 1; size > 0 && written > 0; size -= static_cast<size_t>(written), at += written)
    written = syscall(SYS_write, fd, at, size);
  syscall(SYS_close, fd);
}

void writeCounts() {
  const char* file = getenv("WEIR_FAULT_COUNTS");
  if (file == nullptr || shared == nullptr || getpid() != first) return;
  const int fd = static_cast<int>(syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_APPEND, 0666));
  char text[300];
  int length = 0;
  for (int kind = 0; kind < kKinds; ++kind)
    length += snprintf(text + length, sizeof text - static_cast<size_t>(length), "%s %ld\n", kNames[kind],
                       shared->calls[kind].load());
  length += snprintf(text + length, sizeof text - static_cast<size_t>(length), "failed %ld\n",
                     shared->failed.load());
  syscall(SYS_write, fd, text, length);
  syscall(SYS_close, fd);
  writePlaces();
}

void begin() {
  const char* program = getenv("WEIR_FAULT_PROGRAM");
  if (program == nullptr || strcmp(program, program_invocation_short_name) != 0) return;
  if (const char* text = getenv("WEIR_FAULT_FOLDER")) snprintf(folder, sizeof folder, "%s", text);
  if (const char* text = getenv("WEIR_FAULT_CALL"))
    for (int kind = 0; kind < kKinds; ++kind)
      if (strcmp(kNames[kind], text) == 0) failing = static_cast<Kind>(kind);
  if (const char* text = getenv("WEIR_FAULT_AT")) failingAt = atol(text);
  if (const char* text = getenv("WEIR_FAULT_AS")) {
    failure = errorOf(text);
    isShort = strcmp(text, "short") == 0;
  }
  if (const char* file = getenv("WEIR_FAULT_RECORD")) {
    constexpr int kFarAway = 1000;  // from the descriptors that the program closes or counts
    const int fd = static_cast<int>(
        syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
    record = fcntl(fd, F_DUPFD_CLOEXEC, kFarAway);
    syscall(SYS_close, fd);
  }
  notesPlaces = getenv("WEIR_FAULT_PLACES") != nullptr;
  first = getpid();
  void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory != MAP_FAILED) shared = static_cast<Shared*>(memory);
}

using Main = int (*)(int, char**, char**);
Main realMain = nullptr;

int countedMain(int argc, char** argv, char** environment) {
  begin();
  if (shared != nullptr) atexit(writeCounts);
  return realMain(argc, argv, environment);
}

/// Keeps what the C library does inside one call from being counted once more.
struct Inside {
  Inside() { inside = true; }
  ~Inside() { inside = false; }
};

mode_t modeOf(int flags, va_list arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*end)(),
                      void* stack) {
  NEXT(__libc_start_main);
  realMain = main;
  return real(countedMain, argc, argv, init, fini, end, stack);
}

#define OPEN(name)                                         \
  int name(const char* path, int flags, ...) {             \
    using F = int (*)(const char*, int, ...);              \
    static const F real = next(F(nullptr), #name);         \
    va_list arguments;                                     \
    va_start(arguments, flags);                            \
    const mode_t mode = modeOf(flags, arguments);          \
    va_end(arguments);                                     \
    if (!isMeant(path)) return real(path, flags, mode);    \
    if (fails(kOpen)) return -1;                           \
    return noteOpen(path, flags, real(path, flags, mode)); \
  }
OPEN(open)
OPEN(open64)

#define OPENAT(name)                                           \
  int name(int at, const char* path, int flags, ...) {         \
    using F = int (*)(int, const char*, int, ...);             \
    static const F real = next(F(nullptr), #name);             \
    va_list arguments;                                         \
    va_start(arguments, flags);                                \
    const mode_t mode = modeOf(flags, arguments);              \
    va_end(arguments);                                         \
    if (!isMeant(path)) return real(at, path, flags, mode);    \
    if (fails(kOpen)) return -1;                               \
    return noteOpen(path, flags, real(at, path, flags, mode)); \
  }
OPENAT(openat)
OPENAT(openat64)

#define FORTIFIED(name)                              \
  int name(const char* path, int flags) {            \
    using F = int (*)(const char*, int);             \
    static const F real = next(F(nullptr), #name);   \
    if (!isMeant(path)) return real(path, flags);    \
    if (fails(kOpen)) return -1;                     \
    return noteOpen(path, flags, real(path, flags)); \
  }
FORTIFIED(__open_2)
FORTIFIED(__open64_2)

#define FOPEN(name)                                                                      \
  FILE* name(const char* path, const char* mode) {                                       \
    using F = FILE* (*)(const char*, const char*);                                       \
    static const F real = next(F(nullptr), #name);                                       \
    if (!isMeant(path)) return real(path, mode);                                         \
    if (fails(kOpen)) return nullptr;                                                    \
    FILE* file = real(path, mode);                                                       \
    const int flags = mode[0] == 'w' ? O_CREAT | O_TRUNC : mode[0] == 'a' ? O_CREAT : 0; \
    if (file != nullptr) noteOpen(path, flags, fileno(file));                            \
    return file;                                                                         \
  }
FOPEN(fopen)
FOPEN(fopen64)

ssize_t write(int fd, const void* bytes, size_t size) {
  NEXT(write);
  if (!isMeant(fd)) return real(fd, bytes, size);
  if (wantsRoom(fd, lseek(fd, 0, SEEK_CUR) + static_cast<off_t>(size)) && fails(kWrite)) {
    const bool half = isShort && shared->calls[kWrite].load() == failingAt && size > 1;
    return half ? real(fd, bytes, size / 2) : -1;
  }
  const ssize_t written = real(fd, bytes, size);
  noteWrite(fd, -1, bytes, written);
  return written;
}

#define PWRITE(name)                                                                      \
  ssize_t name(int fd, const void* bytes, size_t size, off_t at) {                        \
    NEXT(name);                                                                           \
    if (!isMeant(fd)) return real(fd, bytes, size, at);                                   \
    if (wantsRoom(fd, at + static_cast<off_t>(size)) && fails(kWrite)) {                  \
      const bool half = isShort && shared->calls[kWrite].load() == failingAt && size > 1; \
      return half ? real(fd, bytes, size / 2, at) : -1;                                   \
    }                                                                                     \
    const ssize_t written = real(fd, bytes, size, at);                                    \
    noteWrite(fd, at, bytes, written);                                                    \
    return written;                                                                       \
  }
PWRITE(pwrite)
PWRITE(pwrite64)

ssize_t writev(int fd, const struct iovec* parts, int count) {
  NEXT(writev);
  if (isMeant(fd) && fails(kWrite)) return -1;
  return real(fd, parts, count);
}

size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  NEXT(fwrite);
  if (isMeant(fileno(file)) && fails(kWrite)) return 0;
  return real(bytes, size, count, file);
}

int fflush(FILE* file) {
  NEXT(fflush);
  if (file != nullptr && isMeant(fileno(file)) && fails(kWrite)) return EOF;
  return real(file);
}

int fclose(FILE* file) {
  NEXT(fclose);
  const bool failed = isMeant(fileno(file)) && fails(kClose);
  const int error = errno;
  const Inside own;
  const int result = real(file);
  if (failed) errno = error;
  return failed ? EOF : result;
}

int fsync(int fd) {
  NEXT(fsync);
  if (!isMeant(fd)) return real(fd);
  if (fails(kFsync)) return -1;
  const int result = real(fd);
  if (result == 0) note("fsync %lu\n", inodeOf(fd));
  return result;
}

int fdatasync(int fd) {
  NEXT(fdatasync);
  if (!isMeant(fd)) return real(fd);
  if (fails(kFsync)) return -1;
  const int result = real(fd);
  if (result == 0) note("fsync %lu\n", inodeOf(fd));
  return result;
}

#define FTRUNCATE(name)                                                                \
  int name(int fd, off_t size) {                                                       \
    NEXT(name);                                                                        \
    if (!isMeant(fd)) return real(fd, size);                                           \
    if (wantsRoom(fd, size) && fails(kWrite)) return -1;                               \
    const int result = real(fd, size);                                                 \
    if (result == 0) note("truncate %lu %ld\n", inodeOf(fd), static_cast<long>(size)); \
    return result;                                                                     \
  }
FTRUNCATE(ftruncate)
FTRUNCATE(ftruncate64)

#define FALLOCATE(name)                                                                     \
  int name(int fd, off_t at, off_t size) {                                                  \
    NEXT(name);                                                                             \
    if (!isMeant(fd)) return real(fd, at, size);                                            \
    if (fails(kWrite)) return failure;                                                      \
    const int result = real(fd, at, size);                                                  \
    if (result == 0) note("allocate %lu %ld\n", inodeOf(fd), static_cast<long>(at + size)); \
    return result;                                                                          \
  }
FALLOCATE(posix_fallocate)
FALLOCATE(posix_fallocate64)

int rename(const char* from, const char* to) {
  NEXT(rename);
  if (!isMeant(to)) return real(from, to);
  if (fails(kRename)) return -1;
  const int result = real(from, to);
  if (result == 0) note("rename %s\t%s\n", from, to);
  return result;
}

int link(const char* from, const char* to) {
  NEXT(link);
  if (!isMeant(to)) return real(from, to);
  if (fails(kRename)) return -1;
  const int result = real(from, to);
  if (result == 0) note("link %s\t%s\n", from, to);
  return result;
}

int unlink(const char* path) {
  NEXT(unlink);
  const int result = real(path);
  if (result == 0 && isMeant(path)) note("unlink %s\n", path);
  return result;
}

int remove(const char* path) {
  NEXT(remove);
  const int result = real(path);
  if (result == 0 && isMeant(path)) note("unlink %s\n", path);
  return result;
}

int mkdir(const char* path, mode_t mode) {
  NEXT(mkdir);
  if (isMeant(path) && fails(kOpen)) return -1;
  return real(path, mode);
}

int close(int fd) {
  NEXT(close);
  const bool failed = isMeant(fd) && fails(kClose);
  const int error = errno;
  const int result = real(fd);
  if (failed) errno = error;
  return failed ? -1 : result;
}

void* dlopen(const char* file, int mode) {
  NEXT(dlopen);
  ++loading;
  void* library = real(file, mode);
  --loading;
  dl_iterate_phdr(noteHdf5, nullptr);
  return library;
}

void* malloc(size_t size) {
  if (allocationFails(__builtin_return_address(0))) return nullptr;
  return __libc_malloc(size);
}

void* calloc(size_t count, size_t size) {
  if (allocationFails(__builtin_return_address(0))) return nullptr;
  return __libc_calloc(count, size);
}

void* realloc(void* memory, size_t size) {
  if (size > 0 && allocationFails(__builtin_return_address(0))) return nullptr;
  return __libc_realloc(memory, size);
}

void* memalign(size_t alignment, size_t size) {
  if (allocationFails(__builtin_return_address(0))) return nullptr;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(size_t alignment, size_t size) {
  if (allocationFails(__builtin_return_address(0))) return nullptr;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, size_t alignment, size_t size) {
  if (allocationFails(__builtin_return_address(0))) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}

}  // extern "C"
