// Virtual data sets: rows that stand in other files.
#include <array>
#include <limits>

#include "plugins/vtkhdf/hdf5.h"

namespace weir::hdf5 {

namespace {

Handle rowsIn(std::int64_t all, std::int64_t first, std::int64_t count, int columns) {
  const int dimensions = columns > 1 ? 2 : 1;
  const auto wide = static_cast<hsize_t>(columns);
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(all), wide}, start{static_cast<hsize_t>(first), 0},
      some{static_cast<hsize_t>(count), wide};
  Handle space(H5Screate_simple(dimensions, size.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, some.data(), nullptr);
  return space;
}

/// HDF5 takes "%b" in a name for a number of a file.
std::string withoutNumbers(const std::string& name) {
  std::string escaped;
  for (const char c : name) escaped += c == '%' ? std::string("%%") : std::string(1, c);
  return escaped;
}

std::string nameFrom(const Handle& layout, std::size_t index,
                     ssize_t (*get)(hid_t, std::size_t, char*, std::size_t)) {
  const ssize_t length = get(layout.get(), index, nullptr, 0);
  if (length <= 0) return {};
  std::string name(static_cast<std::size_t>(length) + 1, '\0');
  get(layout.get(), index, name.data(), name.size());
  name.pop_back();
  return name;
}

std::string withNumbers(std::string name) {
  for (std::size_t at = 0; (at = name.find("%%", at)) != std::string::npos; ++at) name.erase(at, 1);
  return name;
}

void setMissing(const Handle& layout, NumberType type) {
  if (type == NumberType::kFloat32 || type == NumberType::kFloat64) {
    const double missing = std::numeric_limits<double>::quiet_NaN();
    H5Pset_fill_value(layout.get(), H5T_NATIVE_DOUBLE, &missing);
  } else {
    const std::int64_t missing = -1;
    H5Pset_fill_value(layout.get(), H5T_NATIVE_INT64, &missing);
  }
}

}  // namespace

bool Group::isVirtual(const std::string& name) const {
  if (!isDataset(name)) return false;
  const Handle set = checkedHandle(H5Dopen2(id(), name.c_str(), H5P_DEFAULT), H5Dclose, "open a data set of");
  const Handle layout = checkedHandle(H5Dget_create_plist(set.get()), H5Pclose, "read the layout of");
  return H5Pget_layout(layout.get()) == H5D_VIRTUAL;
}

void Group::createVirtual(const std::string& name, NumberType type, int columns,
                          std::span<const RowsElsewhere> rows) {
  std::int64_t all = 0;
  for (const RowsElsewhere& some : rows) all += some.count;
  if (all == 0) {
    createGrowing(name, {.type = type, .columns = columns});
    return;
  }
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  checked(H5Pset_obj_track_times(layout.get(), false), "lay out a data set of");
  setMissing(layout, type);
  std::int64_t at = 0;
  for (const RowsElsewhere& some : rows) {
    if (some.count == 0) continue;
    const Handle here = rowsIn(all, at, some.count, columns),
                 there = rowsIn(some.first + some.count, some.first, some.count, columns);
    checked(H5Pset_virtual(layout.get(), here.get(), withoutNumbers(some.file).c_str(), some.dataset.c_str(),
                           there.get()),
            "lay out a data set of");
    at += some.count;
  }
  const Handle space = rowsIn(all, 0, all, columns);
  const Handle made = checkedHandle(
      H5Dcreate2(id(), name.c_str(), fileType(type), space.get(), H5P_DEFAULT, layout.get(), H5P_DEFAULT),
      H5Dclose, "add a data set to");
}

std::vector<RowsElsewhere> Dataset::elsewhere() const {
  std::vector<RowsElsewhere> rows;
  if (!isVirtual_) return rows;
  const Handle layout = checkedHandle(H5Dget_create_plist(id()), H5Pclose, "read the layout of");
  std::size_t count = 0;
  checked(H5Pget_virtual_count(layout.get(), &count), "read the layout of");
  for (std::size_t i = 0; i < count; ++i) {
    const Handle space =
        checkedHandle(H5Pget_virtual_srcspace(layout.get(), i), H5Sclose, "read the layout of");
    std::array<hsize_t, H5S_MAX_RANK> first{}, last{};
    if (H5Sget_select_bounds(space.get(), first.data(), last.data()) < 0)
      throw error("has no rows elsewhere");
    if (last[0] >= static_cast<hsize_t>(kMaxRows)) throw error("claims rows that no file has");
    rows.push_back({.file = withNumbers(nameFrom(layout, i, H5Pget_virtual_filename)),
                    .dataset = nameFrom(layout, i, H5Pget_virtual_dsetname),
                    .first = static_cast<std::int64_t>(first[0]),
                    .count = static_cast<std::int64_t>(last[0] - first[0] + 1)});
  }
  return rows;
}

}  // namespace weir::hdf5
