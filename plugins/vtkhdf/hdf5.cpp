#include "plugins/vtkhdf/hdf5.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/text.h"

namespace weir::hdf5 {

namespace {

/// HDF5 is one library for the whole process, so its lock is one for the whole process.
std::recursive_mutex& libraryMutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// Ends the HDF5 library with this plugin or program, unless something could not be closed: the end would
/// come across it, and crash there. HDF5's own clean-up at the program's exit does not make that difference.
class Library {
 public:
  Library() { H5dont_atexit(); }
  ~Library() {
    if (clean_) H5close();
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  static Library& theOne() {
    static Library library;
    return library;
  }
  void somethingStaysOpen() { clean_ = false; }

 private:
  bool clean_ = true;
};

hid_t memoryType(NumberType type) {
  switch (type) {
    case NumberType::kFloat32:
      return H5T_NATIVE_FLOAT;
    case NumberType::kFloat64:
      return H5T_NATIVE_DOUBLE;
    case NumberType::kInt32:
      return H5T_NATIVE_INT32;
    case NumberType::kInt64:
      return H5T_NATIVE_INT64;
    case NumberType::kUint32:
      return H5T_NATIVE_UINT32;
    case NumberType::kUint8:
      return H5T_NATIVE_UINT8;
  }
  return H5I_INVALID_HID;
}

herr_t takeFirst(unsigned, const H5E_error2_t* error, void* text) {
  std::string& message = *static_cast<std::string*>(text);
  if (message.empty() && error->desc) message = error->desc;
  return 0;
}

Handle fixedString(std::size_t length, H5T_cset_t characters) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(length, 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), characters);
  return type;
}

Handle fixedString(std::string_view text) {
  const bool ascii = std::all_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x80; });
  return fixedString(text.size(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
}

/// For data sets that are written: without a cache, rows are in the file when append() returns, so
/// File::flush() has only the index to write.
Handle withoutCache() {
  Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
  return access;
}

/// For data sets that are made. Their times would be all that differs between two files of the same data.
Handle withoutTimes() {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  return properties;
}

Handle accessForWriting() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // The oldest formats of everything: those of LATEST cannot be opened after a kill.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V110);
  // Without a lock other programs can look at the frames that are already there while the run goes on.
  H5Pset_file_locking(access.get(), false, true);
  // Small data would else be written when a data set is closed, where a failure has nobody to be told.
  H5Pset_sieve_buf_size(access.get(), 0);
  return access;
}

void cutAtNull(std::string& text) {
  text.resize(std::min(text.size(), text.find('\0')));
}

}  // namespace

Session::Session() : lock_(libraryMutex()) {
  Library::theOne();
  H5Eget_auto2(H5E_DEFAULT, &print_, &printData_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Session::~Session() {
  H5Eset_auto2(H5E_DEFAULT, print_, printData_);
}

void Session::renewLock() {
  std::construct_at(&libraryMutex());
}

std::string lastMessage() {
  std::string message;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, takeFirst, &message);
  // Messages about files look like "…, errno = 28, error message = 'No space left on device', …".
  constexpr std::string_view kReason = "error message = '";
  if (const auto start = message.find(kReason); start != std::string::npos) {
    const auto from = start + kReason.size();
    return message.substr(from, message.find('\'', from) - from);
  }
  return message.empty() ? "HDF5 gives no reason" : message;
}

hid_t fileType(NumberType type) {
  switch (type) {
    case NumberType::kFloat32:
      return H5T_IEEE_F32LE;
    case NumberType::kFloat64:
      return H5T_IEEE_F64LE;
    case NumberType::kInt32:
      return H5T_STD_I32LE;
    case NumberType::kInt64:
      return H5T_STD_I64LE;
    case NumberType::kUint32:
      return H5T_STD_U32LE;
    case NumberType::kUint8:
      return H5T_STD_U8LE;
  }
  return H5I_INVALID_HID;
}

std::size_t sizeOf(NumberType type) {
  if (type == NumberType::kUint8) return 1;
  return type == NumberType::kFloat64 || type == NumberType::kInt64 ? 8 : 4;
}

Handle::Handle(Handle&& other) noexcept
    : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, H5I_INVALID_HID);
    close_ = other.close_;
  }
  return *this;
}

bool Handle::reset() {
  const hid_t id = std::exchange(id_, H5I_INVALID_HID);
  if (id < 0 || close_(id) >= 0) return true;
  Library::theOne().somethingStaysOpen();
  return false;
}

// ---- Object

Error Object::error(const std::string& what, std::string allowed) const {
  return ioError(path_ + " " + what, std::move(allowed)).at({.file = *file_});
}

void Object::fail(const char* what) const {
  throw ioError("cannot " + std::string(what) + " " + printable(path_) + ": " + lastMessage())
      .at({.file = *file_});
}

bool Object::hasAttribute(const char* name) const {
  return checked(H5Aexists(id(), name), "look for attributes of") > 0;
}

std::vector<std::int64_t> Object::intAttribute(const char* name) const {
  const Handle attribute = checkedHandle(H5Aopen(id(), name, H5P_DEFAULT), H5Aclose, "open an attribute of");
  const Handle type = checkedHandle(H5Aget_type(attribute.get()), H5Tclose, "read an attribute's type of");
  if (H5Tget_class(type.get()) != H5T_INTEGER)
    throw error("has an attribute " + std::string(name) + " that is not an integer");
  const Handle space = checkedHandle(H5Aget_space(attribute.get()), H5Sclose, "read an attribute's size of");
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  constexpr hssize_t kMax = 16;
  if (count < 1 || count > kMax)
    throw error("has an attribute " + std::string(name) + " of " + std::to_string(count) + " values");
  std::vector<std::int64_t> values(static_cast<std::size_t>(count));
  checked(H5Aread(attribute.get(), H5T_NATIVE_INT64, values.data()), "read an attribute of");
  return values;
}

std::string Object::textAttribute(const char* name) const {
  const Handle attribute = checkedHandle(H5Aopen(id(), name, H5P_DEFAULT), H5Aclose, "open an attribute of");
  const Handle type = checkedHandle(H5Aget_type(attribute.get()), H5Tclose, "read an attribute's type of");
  const Handle space = checkedHandle(H5Aget_space(attribute.get()), H5Sclose, "read an attribute's size of");
  if (H5Tget_class(type.get()) != H5T_STRING || H5Sget_simple_extent_npoints(space.get()) != 1)
    throw error("has an attribute " + std::string(name) + " that is not text");
  if (H5Tis_variable_str(type.get()) > 0) {
    char* text = nullptr;
    checked(H5Aread(attribute.get(), type.get(), &text), "read an attribute of");
    const std::unique_ptr<char, herr_t (*)(void*)> owner(text, H5free_memory);
    return text ? text : "";
  }
  std::string text(H5Tget_size(type.get()), '\0');
  checked(H5Aread(attribute.get(), type.get(), text.data()), "read an attribute of");
  cutAtNull(text);
  return text;
}

void Object::setAttribute(const char* name, std::int64_t scalar) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  if (!hasAttribute(name)) return writeAttribute(name, H5T_STD_I64LE, space.get(), &scalar);
  // In place, so that a reader finds either the old or the new number.
  const Handle attribute = checkedHandle(H5Aopen(id(), name, H5P_DEFAULT), H5Aclose, "open an attribute of");
  checked(H5Awrite(attribute.get(), H5T_NATIVE_INT64, &scalar), "write an attribute of");
}

void Object::setAttribute(const char* name, std::span<const std::int64_t> values) {
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  writeAttribute(name, H5T_STD_I64LE, space.get(), values.data());
}

void Object::setAttribute(const char* name, std::string_view text) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type = fixedString(text);
  const std::string padded(text.empty() ? std::string_view("\0", 1) : text);
  writeAttribute(name, type.get(), space.get(), padded.data());
}

void Object::writeAttribute(const char* name, hid_t type, hid_t space, const void* data) {
  if (hasAttribute(name)) checked(H5Adelete(id(), name), "replace an attribute of");
  const Handle attribute = checkedHandle(H5Acreate2(id(), name, type, space, H5P_DEFAULT, H5P_DEFAULT),
                                         H5Aclose, "add an attribute to");
  // Strings have the same type in the file and in memory; integers need the machine's own.
  const hid_t memory = H5Tget_class(type) == H5T_INTEGER ? H5T_NATIVE_INT64 : type;
  checked(H5Awrite(attribute.get(), memory, data), "write an attribute of");
}

// ---- Dataset

Dataset::Dataset(Handle handle, std::shared_ptr<const std::string> file, std::string path)
    : Object(std::move(handle), std::move(file), std::move(path)) {
  const Handle type = checkedHandle(H5Dget_type(id()), H5Tclose, "read the type of");
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) throw error("holds no numbers");
  isInteger_ = kind == H5T_INTEGER;
  const Handle made = checkedHandle(H5Dget_create_plist(id()), H5Pclose, "read the layout of");
  isVirtual_ = H5Pget_layout(made.get()) == H5D_VIRTUAL;

  const Handle space = checkedHandle(H5Dget_space(id()), H5Sclose, "read the shape of");
  dimensions_ = checked(H5Sget_simple_extent_ndims(space.get()), "read the shape of");
  if (dimensions_ != 1 && dimensions_ != 2)
    throw error("has " + std::to_string(dimensions_) + " dimensions", "one or two");
  std::array<hsize_t, 2> size{0, 1};
  checked(H5Sget_simple_extent_dims(space.get(), size.data(), nullptr), "read the shape of");
  constexpr hsize_t kMaxColumns = 1 << 10;
  if (size[0] > static_cast<hsize_t>(kMaxRows) || size[1] > kMaxColumns)
    throw error("claims " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " numbers");
  rows_ = static_cast<std::int64_t>(size[0]);
  columns_ = static_cast<std::int64_t>(size[1]);
}

void Dataset::appendRows(NumberType type, const void* values, std::size_t numbers) {
  const auto columns = static_cast<std::size_t>(columns_);
  WEIR_CHECK(numbers % columns == 0u);
  if (numbers == 0) return;
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(rows_), 0};
  const std::array<hsize_t, 2> count{numbers / columns, columns};
  const std::array<hsize_t, 2> size{start[0] + count[0], columns};
  checked(H5Dset_extent(id(), size.data()), "extend");
  const Handle space = checkedHandle(H5Dget_space(id()), H5Sclose, "read the shape of");
  checked(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
          "select rows of");
  const Handle memory(H5Screate_simple(dimensions_, count.data(), nullptr), H5Sclose);
  checked(H5Dwrite(id(), memoryType(type), memory.get(), space.get(), H5P_DEFAULT, values), "write");
  rows_ = static_cast<std::int64_t>(size[0]);
}

void Dataset::truncate(std::int64_t rows) {
  checkRange(0, rows);
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(rows), static_cast<hsize_t>(columns_)};
  checked(H5Dset_extent(id(), size.data()), "shorten");
  rows_ = rows;
}

void Dataset::checkRange(std::int64_t first, std::int64_t count) const {
  if (first < 0 || count < 0 || first > rows_ || count > rows_ - first)
    throw error("has " + std::to_string(rows_) + " rows, but the file asks for " + std::to_string(count) +
                " from row " + std::to_string(first) + " on");
  // What is elsewhere is checked there.
  if (isVirtual_) return;
  // Of what was never stored HDF5 reads zeros, as many as the file says.
  constexpr std::int64_t kFew = 1 << 16;
  const std::int64_t numbers = count * columns_;
  if (numbers <= kFew) return;
  const double stored = static_cast<double>(H5Dget_storage_size(id()));
  if (static_cast<double>(numbers) > stored * kStrongestCompression)
    throw error("claims " + std::to_string(numbers) + " numbers, more than fit into the file");
}

void Dataset::readRows(NumberType type, std::int64_t first, std::int64_t count, void* values) const {
  if (count == 0 || columns_ == 0) return;
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0};
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(count), static_cast<hsize_t>(columns_)};
  const Handle space = checkedHandle(H5Dget_space(id()), H5Sclose, "read the shape of");
  checked(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr),
          "select rows of");
  const Handle memory(H5Screate_simple(dimensions_, size.data(), nullptr), H5Sclose);
  checked(H5Dread(id(), memoryType(type), memory.get(), space.get(), H5P_DEFAULT, values), "read");
}

// ---- Group

bool Group::has(const std::string& name) const {
  return checked(H5Lexists(id(), name.c_str(), H5P_DEFAULT), "look into") > 0;
}

H5O_type_t Group::typeOf(const std::string& name) const {
  const Handle object = checkedHandle(H5Oopen(id(), name.c_str(), H5P_DEFAULT), H5Oclose, "open a member of");
  switch (H5Iget_type(object.get())) {
    case H5I_GROUP:
      return H5O_TYPE_GROUP;
    case H5I_DATASET:
      return H5O_TYPE_DATASET;
    default:
      return H5O_TYPE_UNKNOWN;
  }
}

bool Group::isDataset(const std::string& name) const {
  return has(name) && typeOf(name) == H5O_TYPE_DATASET;
}

bool Group::isGroup(const std::string& name) const {
  return has(name) && typeOf(name) == H5O_TYPE_GROUP;
}

std::vector<std::string> Group::members() const {
  H5G_info_t info{};
  checked(H5Gget_info(id(), &info), "list");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t length = checked(
        H5Lget_name_by_idx(id(), ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT), "list");
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    checked(
        H5Lget_name_by_idx(id(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT),
        "list");
    name.pop_back();
    names.push_back(std::move(name));
  }
  return names;
}

Group Group::group(const std::string& name) const {
  if (!isGroup(name)) throw error("holds no group " + inQuotes(name));
  return {checkedHandle(H5Gopen2(id(), name.c_str(), H5P_DEFAULT), H5Gclose, "open a group of"), file_,
          below(name)};
}

Dataset Group::dataset(const std::string& name) const {
  if (!isDataset(name)) throw error("holds no data set " + inQuotes(name));
  const Handle file(H5Iget_file_id(id()), H5Fclose);
  unsigned intent = H5F_ACC_RDONLY;
  H5Fget_intent(file.get(), &intent);
  const Handle access =
      (intent & H5F_ACC_RDWR) != 0 ? withoutCache() : Handle(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  return {checkedHandle(H5Dopen2(id(), name.c_str(), access.get()), H5Dclose, "open a data set of"), file_,
          below(name)};
}

Group Group::createGroup(const std::string& name) {
  return {checkedHandle(H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                        "add a group to"),
          file_, below(name)};
}

Dataset Group::createGrowing(const std::string& name, const Growing& layout) {
  const int dimensions = layout.columns > 1 || layout.matrix ? 2 : 1;
  const auto columns = static_cast<hsize_t>(layout.columns);
  const std::array<hsize_t, 2> size{0, columns}, max{H5S_UNLIMITED, columns};
  const std::array<hsize_t, 2> chunk{static_cast<hsize_t>(layout.chunkRows), columns};
  const Handle space(H5Screate_simple(dimensions, size.data(), max.data()), H5Sclose);
  const Handle properties = withoutTimes();
  checked(H5Pset_chunk(properties.get(), dimensions, chunk.data()), "lay out a data set of");
  if (layout.deflate && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
    constexpr unsigned kFastest = 1;
    checked(H5Pset_shuffle(properties.get()), "lay out a data set of");
    checked(H5Pset_deflate(properties.get(), kFastest), "lay out a data set of");
  }
  const Handle access = withoutCache();
  return {checkedHandle(H5Dcreate2(id(), name.c_str(), fileType(layout.type), space.get(), H5P_DEFAULT,
                                   properties.get(), access.get()),
                        H5Dclose, "add a data set to"),
          file_, below(name)};
}

void Group::writeText(const std::string& name, std::string_view text) {
  if (has(name)) checked(H5Ldelete(id(), name.c_str(), H5P_DEFAULT), "replace a text of");
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type = fixedString(text);
  const Handle set = checkedHandle(
      H5Dcreate2(id(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, withoutTimes().get(), H5P_DEFAULT),
      H5Dclose, "add a text to");
  const std::string padded(text.empty() ? std::string_view("\0", 1) : text);
  checked(H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), "write a text of");
}

std::string Group::readText(const std::string& name) const {
  if (!isDataset(name)) throw error("holds no text " + inQuotes(name));
  const Handle set = checkedHandle(H5Dopen2(id(), name.c_str(), H5P_DEFAULT), H5Dclose, "open a text of");
  const Handle type = checkedHandle(H5Dget_type(set.get()), H5Tclose, "read the type of a text of");
  const Handle space = checkedHandle(H5Dget_space(set.get()), H5Sclose, "read the size of a text of");
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0 ||
      H5Sget_simple_extent_npoints(space.get()) != 1)
    throw error("holds " + inQuotes(name) + ", which is not text of fixed length");
  if (H5Tget_size(type.get()) > std::max<hsize_t>(H5Dget_storage_size(set.get()), 1))
    throw error("holds a text " + inQuotes(name) + " that is not all there");
  std::string text(H5Tget_size(type.get()), '\0');
  checked(H5Dread(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read a text of");
  cutAtNull(text);
  return text;
}

// ---- File

File::File(Handle handle, std::string name)
    : handle_(std::move(handle)), name_(std::make_shared<const std::string>(std::move(name))) {}

File::~File() = default;

Error File::error(const char* what) const {
  return ioError("cannot " + std::string(what) + ": " + lastMessage()).at({.file = *name_});
}

File File::create(const std::filesystem::path& file, const std::string& name) {
  const Handle access = accessForWriting();
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  // A compressed chunk that grows moves to another place. Its old place, which the index on the disk still
  // names until the next flush, must not be given to other data.
  H5Pset_file_space_strategy(creation.get(), H5F_FSPACE_STRATEGY_NONE, false, 1);
  File made(Handle(H5Fcreate(file.c_str(), H5F_ACC_EXCL, creation.get(), access.get()), H5Fclose), name);
  if (made.handle_.get() < 0) {
    // Where the disk is full, HDF5 holds on to the file that it could not begin.
    Library::theOne().somethingStaysOpen();
    throw made.error("create the file");
  }
  return made;
}

File File::reopen(const std::filesystem::path& file) {
  const Handle access = accessForWriting();
  File opened(Handle(H5Fopen(file.c_str(), H5F_ACC_RDWR, access.get()), H5Fclose), file.string());
  if (opened.handle_.get() < 0) throw opened.error("open the file for writing");
  return opened;
}

File File::open(const std::filesystem::path& file) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), false, true);
  if (H5Fis_hdf5(file.c_str()) == 0)
    throw ioError("this is not an HDF5 file, or one without its beginning").at({.file = file.string()});
  File opened(Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose), file.string());
  if (opened.handle_.get() < 0) throw opened.error("open the file");
  return opened;
}

Group File::root() const {
  Handle root(H5Gopen2(handle_.get(), "/", H5P_DEFAULT), H5Gclose);
  if (root.get() < 0) throw error("read the file");
  return {std::move(root), name_, "/"};
}

void File::reserve() {
  // HDF5 writes its index in an order of its own and goes on after a failure, which can leave a file that
  // nobody can open. So the room for it is taken first.
  hid_t access = H5P_DEFAULT;
  void* driver = nullptr;
  haddr_t end = 0;
  if (H5Fget_vfd_handle(handle_.get(), access, &driver) < 0 || H5Fget_eoa(handle_.get(), &end) < 0)
    throw error("write the file");
  const int file = *static_cast<int*>(driver);
  struct ::stat status {};
  if (::fstat(file, &status) != 0 || static_cast<haddr_t>(status.st_size) >= end) return;
  if (const int code = ::posix_fallocate(file, status.st_size, static_cast<off_t>(end) - status.st_size))
    throw ioError("cannot write the file: " + std::system_category().message(code)).at({.file = *name_});
}

void File::flush() {
  reserve();
  // A write that failed once stays to be done: without the second attempt a single failure on the way to the
  // disk would leave half an index, which is not a file.
  for (int attempt = 0; H5Fflush(handle_.get(), H5F_SCOPE_LOCAL) < 0; ++attempt)
    if (attempt > 0) throw error("write the file");
}

void File::sync() {
  flush();
  void* driver = nullptr;
  if (H5Fget_vfd_handle(handle_.get(), H5P_DEFAULT, &driver) < 0) throw error("write the file");
  if (::fsync(*static_cast<int*>(driver)) != 0)
    throw ioError("cannot write the file: " + std::system_category().message(errno)).at({.file = *name_});
}

void File::close() {
  // Closing cannot be tried again, so what can fail comes first.
  flush();
  if (!handle_.reset()) throw error("close the file");
}

void File::abandon() {
  // What could not be written may stay in HDF5's caches, and its end would try again and again.
  Library::theOne().somethingStaysOpen();
  // HDF5 cannot close a file without writing what it holds, so that goes to a place where it does no harm.
  void* driver = nullptr;
  if (H5Fget_vfd_handle(handle_.get(), H5P_DEFAULT, &driver) < 0 || !driver) return;
  // Memory and no device, because HDF5 sets the file's size, too. Only the index and the last frame are
  // written.
  const int nowhere = ::memfd_create("abandoned export", MFD_CLOEXEC);
  if (nowhere < 0) return;
  ::dup2(nowhere, *static_cast<int*>(driver));
  ::close(nowhere);
}

}  // namespace weir::hdf5
