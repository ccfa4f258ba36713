// A small wrapper over the HDF5 C API: handles that close themselves, and failures as weir io Errors that
// carry the file's name and HDF5's own innermost message. Only this folder includes it.
//
// Everything here, destructors included, must run inside a Session.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/error.h"

namespace weir::hdf5 {

/// Makes this thread the only one of Weir's that uses the HDF5 library, which need not be thread-safe, and
/// keeps HDF5 from printing its error stack to stderr; both end with the object. It may be nested.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// For a process that was just forked by a thread with a session: nobody has the lock there any more, as it
  /// would belong to a thread of the parent.
  static void renewLock();

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* printData_ = nullptr;
};

/// The innermost message on HDF5's error stack, which says what really happened: "No space left on device".
std::string lastMessage();

/// Owns one HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&& other) noexcept;
  ~Handle() { reset(); }

  hid_t get() const { return id_; }
  /// Closes it; false if HDF5 could not.
  bool reset();

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

enum class NumberType { kFloat32, kFloat64, kInt32, kInt64, kUint32, kUint8 };

template <class T>
constexpr NumberType kNumberType = T::unknown;
template <>
inline constexpr NumberType kNumberType<float> = NumberType::kFloat32;
template <>
inline constexpr NumberType kNumberType<double> = NumberType::kFloat64;
template <>
inline constexpr NumberType kNumberType<std::int32_t> = NumberType::kInt32;
template <>
inline constexpr NumberType kNumberType<std::int64_t> = NumberType::kInt64;
template <>
inline constexpr NumberType kNumberType<std::uint32_t> = NumberType::kUint32;
template <>
inline constexpr NumberType kNumberType<std::uint8_t> = NumberType::kUint8;

std::size_t sizeOf(NumberType type);
/// How HDF5 calls what stands in a file.
hid_t fileType(NumberType type);

/// A group or a data set of a file, with its attributes.
class Object {
 public:
  /// Its place in the file, "/VTKHDF/Points".
  const std::string& path() const { return path_; }

  bool hasAttribute(const char* name) const;
  std::vector<std::int64_t> intAttribute(const char* name) const;
  std::string textAttribute(const char* name) const;
  /// Each replaces an attribute of that name. A scalar is one value of `values`.
  void setAttribute(const char* name, std::int64_t scalar);
  void setAttribute(const char* name, std::span<const std::int64_t> values);
  /// As a null-padded ASCII or UTF-8 string of fixed length.
  void setAttribute(const char* name, std::string_view text);

  /// An io Error about this object: "/VTKHDF/Points has 3 dimensions".
  Error error(const std::string& what, std::string allowed = {}) const;

 protected:
  Object(Handle handle, std::shared_ptr<const std::string> file, std::string path)
      : handle_(std::move(handle)), file_(std::move(file)), path_(std::move(path)) {}

  hid_t id() const { return handle_.get(); }
  /// Passes results of HDF5 calls through; a negative one becomes an io Error "cannot <what>: <HDF5's
  /// message>".
  template <class R>
  R checked(R result, const char* what) const {
    if (result < 0) fail(what);
    return result;
  }
  Handle checkedHandle(hid_t result, Handle::Close close, const char* what) const {
    return {checked(result, what), close};
  }
  [[noreturn]] void fail(const char* what) const;

  Handle handle_;
  std::shared_ptr<const std::string> file_;
  std::string path_;

 private:
  void writeAttribute(const char* name, hid_t type, hid_t space, const void* data);
};

/// Of a data set; more are taken for damage.
inline constexpr std::int64_t kMaxRows = std::int64_t{1} << 48;
/// Deflate cannot shrink data further than this, so a file that claims more is damaged.
inline constexpr double kStrongestCompression = 1032;

/// Rows of a data set of another file, of which a virtual data set consists. The file's name is taken from
/// the folder of the file that names it.
struct RowsElsewhere {
  std::string file, dataset;
  std::int64_t first = 0, count = 0;
};

/// An array of numbers whose first dimension counts rows.
class Dataset : public Object {
 public:
  /// One or two dimensions of numbers (an io Error otherwise).
  std::int64_t rows() const { return rows_; }
  /// Numbers in a row: 1 for one dimension.
  std::int64_t columns() const { return columns_; }
  bool isInteger() const { return isInteger_; }
  /// Whether its rows stand in other files.
  bool isVirtual() const { return isVirtual_; }
  /// Where; none if it is not virtual. Rows that are in no file are left out.
  std::vector<RowsElsewhere> elsewhere() const;

  /// Adds rows behind the last one; `values` holds whole rows. They reach the file at once, but count only
  /// after File::flush().
  template <class T>
  void append(std::span<const T> values) {
    appendRows(kNumberType<T>, values.data(), values.size());
  }
  template <class T>
  void append(T value) {
    append(std::span<const T>(&value, 1));
  }
  /// Leaves out all rows from this one on.
  void truncate(std::int64_t rows);
  /// Rows first … first + count − 1, converted to T; an io Error if there are no such rows.
  template <class T>
  std::vector<T> read(std::int64_t first, std::int64_t count) const {
    checkRange(first, count);
    std::vector<T> values(static_cast<std::size_t>(count * columns_));
    readRows(kNumberType<T>, first, count, values.data());
    return values;
  }
  template <class T>
  std::vector<T> readAll() const {
    return read<T>(0, rows_);
  }

 private:
  friend class Group;
  Dataset(Handle handle, std::shared_ptr<const std::string> file, std::string path);

  void appendRows(NumberType type, const void* values, std::size_t numbers);
  void readRows(NumberType type, std::int64_t first, std::int64_t count, void* values) const;
  void checkRange(std::int64_t first, std::int64_t count) const;

  int dimensions_ = 1;
  std::int64_t rows_ = 0, columns_ = 1;
  bool isInteger_ = false, isVirtual_ = false;
};

/// How a growing data set is laid out in the file.
struct Growing {
  NumberType type = NumberType::kFloat32;
  int columns = 1;
  bool matrix = false;         ///< two dimensions even for one column
  std::int64_t chunkRows = 1;  ///< rows that are stored together
  bool deflate = false;
};

class Group : public Object {
 public:
  bool has(const std::string& name) const;
  bool isDataset(const std::string& name) const;
  bool isGroup(const std::string& name) const;
  bool isVirtual(const std::string& name) const;  ///< a data set whose rows stand in other files
  std::vector<std::string> members() const;

  Group group(const std::string& name) const;
  Dataset dataset(const std::string& name) const;
  Group createGroup(const std::string& name);
  /// The group of that name, made if it is not there.
  Group openGroup(const std::string& name) { return has(name) ? group(name) : createGroup(name); }
  /// Without rows; append() adds them.
  Dataset createGrowing(const std::string& name, const Growing& layout);
  /// The data set of that name, made if it is not there.
  Dataset openGrowing(const std::string& name, const Growing& layout) {
    return has(name) ? dataset(name) : createGrowing(name, layout);
  }
  /// Of these rows, one after the other, in data sets of such numbers. Where a file or its rows are missing,
  /// readers find NaN, or -1.
  void createVirtual(const std::string& name, NumberType type, int columns,
                     std::span<const RowsElsewhere> rows);
  /// A UTF-8 text of any length, as a scalar string of fixed length; replaces one of that name.
  void writeText(const std::string& name, std::string_view text);
  std::string readText(const std::string& name) const;

 private:
  friend class File;
  using Object::Object;
  std::string below(const std::string& name) const {
    return path_ == "/" ? path_ + name : path_ + "/" + name;
  }
  H5O_type_t typeOf(const std::string& name) const;
};

class File {
 public:
  /// Makes a file, which must not exist, that HDF5 1.10.1 and later can read, also when the program that
  /// writes it was killed after a flush. `name` is what errors call it.
  static File create(const std::filesystem::path& file, const std::string& name);
  /// For writing more to a file that create() made.
  static File reopen(const std::filesystem::path& file);
  /// For reading only.
  static File open(const std::filesystem::path& file);

  File(File&&) noexcept = default;
  ~File();

  Group root() const;
  /// Hands everything to the operating system. If there is no room for it, the file stays as the last flush
  /// left it.
  void flush();
  /// flush(), and waits until all is on the disk.
  void sync();
  /// Flushes and closes. All objects of the file must be gone.
  void close();
  /// Gives the file up after an error: from now on nothing that HDF5 still holds reaches the disk, so that
  /// what an earlier flush wrote stays as it was.
  void abandon();

 private:
  File(Handle handle, std::string name);
  Error error(const char* what) const;
  /// Takes the room on the disk that the next flush needs.
  void reserve();

  Handle handle_;
  std::shared_ptr<const std::string> name_;
};

}  // namespace weir::hdf5
