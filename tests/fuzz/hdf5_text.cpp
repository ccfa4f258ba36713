#include "tests/fuzz/hdf5_text.h"

#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace weir::fuzz {

namespace {

constexpr std::size_t kMostStored = 4096;  // numbers of a data set that has values

hid_t typeOf(const std::string& name) {
  static const std::map<std::string, hid_t> types{{"float", H5T_NATIVE_FLOAT}, {"double", H5T_NATIVE_DOUBLE},
                                                  {"int8", H5T_NATIVE_INT8},   {"uint8", H5T_NATIVE_UINT8},
                                                  {"int", H5T_NATIVE_INT32},   {"uint", H5T_NATIVE_UINT32},
                                                  {"int64", H5T_NATIVE_INT64}};
  const auto found = types.find(name);
  return found != types.end() ? found->second : -1;
}

/// The numbers behind one another; what no number is ends them.
template <class T>
std::vector<T> numbersOf(std::istringstream& words) {
  std::vector<T> numbers;
  for (T number; numbers.size() < kMostStored && words >> number;) numbers.push_back(number);
  return numbers;
}

std::vector<hsize_t> shapeOf(const std::string& text) {
  std::vector<hsize_t> shape;
  std::istringstream in(text);
  for (std::string part; shape.size() < 4 && std::getline(in, part, 'x');) {
    char* end = nullptr;
    shape.push_back(std::strtoull(part.c_str(), &end, 10));
  }
  return shape;
}

/// An attribute or a data set gets numbers of the memory type that keeps them all.
template <class T>
void writeNumbers(hid_t to, hid_t memoryType, bool isAttribute, std::istringstream& words,
                  std::size_t count) {
  std::vector<T> numbers = numbersOf<T>(words);
  if (numbers.empty() || count > kMostStored) return;
  for (std::size_t k = numbers.size(); k < count; ++k) numbers.push_back(numbers[k % numbers.size()]);
  if (isAttribute)
    H5Awrite(to, memoryType, numbers.data());
  else
    H5Dwrite(to, memoryType, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
}

void fill(hid_t to, const std::string& type, bool isAttribute, std::istringstream& words, std::size_t count) {
  if (type == "float" || type == "double")
    writeNumbers<double>(to, H5T_NATIVE_DOUBLE, isAttribute, words, count);
  else
    writeNumbers<std::int64_t>(to, H5T_NATIVE_INT64, isAttribute, words, count);
}

hid_t textType(const std::string& text) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, text.empty() ? 1 : text.size());
  return type;
}

void addAttribute(hid_t file, std::istringstream& words) {
  std::string path, name, type;
  words >> path >> name >> type;
  const hid_t object = H5Oopen(file, path.c_str(), H5P_DEFAULT);
  if (object < 0) return;
  if (type == "text") {
    std::string text;
    words >> text;
    const hid_t string = textType(text), space = H5Screate(H5S_SCALAR);
    const hid_t made = H5Acreate2(object, name.c_str(), string, space, H5P_DEFAULT, H5P_DEFAULT);
    if (made >= 0) H5Awrite(made, string, text.data()), H5Aclose(made);
    H5Sclose(space), H5Tclose(string);
  } else if (typeOf(type) >= 0) {
    const std::istringstream::pos_type at = words.tellg();
    const hsize_t count = numbersOf<double>(words).size();
    words.clear(), words.seekg(at);
    const hid_t space = count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr);
    const hid_t made = H5Acreate2(object, name.c_str(), typeOf(type), space, H5P_DEFAULT, H5P_DEFAULT);
    if (made >= 0) fill(made, type, true, words, count), H5Aclose(made);
    H5Sclose(space);
  }
  H5Oclose(object);
}

void addData(hid_t file, std::istringstream& words) {
  std::string path, type, dimensions;
  words >> path >> type >> dimensions;
  const std::vector<hsize_t> shape = shapeOf(dimensions);
  if (typeOf(type) < 0) return;
  double count = 1;
  for (const hsize_t size : shape) count *= static_cast<double>(size);
  const hid_t space = shape.empty() ? H5Screate(H5S_SCALAR)
                                    : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
  if (!shape.empty()) {  // in chunks, so that what is not stored takes no room
    std::vector<hsize_t> chunk;
    for (const hsize_t size : shape) chunk.push_back(std::clamp<hsize_t>(size, 1, 2));
    H5Pset_chunk(create, static_cast<int>(chunk.size()), chunk.data());
  }
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t made =
      space < 0 ? -1 : H5Dcreate2(file, path.c_str(), typeOf(type), space, links, create, H5P_DEFAULT);
  if (made >= 0) {
    if (count <= kMostStored) fill(made, type, false, words, static_cast<std::size_t>(count));
    H5Dclose(made);
  }
  if (space >= 0) H5Sclose(space);
  H5Pclose(create), H5Pclose(links);
}

void addText(hid_t file, std::istringstream& words) {
  std::string path, text, word;
  words >> path;
  while (words >> word) text += (text.empty() ? "" : " ") + word;
  const hid_t type = textType(text), space = H5Screate(H5S_SCALAR), links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t made = H5Dcreate2(file, path.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT);
  if (made >= 0) H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), H5Dclose(made);
  H5Pclose(links), H5Sclose(space), H5Tclose(type);
}

void addGroup(hid_t file, std::istringstream& words) {
  std::string path;
  words >> path;
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t made = H5Gcreate2(file, path.c_str(), links, H5P_DEFAULT, H5P_DEFAULT);
  if (made >= 0) H5Gclose(made);
  H5Pclose(links);
}

}  // namespace

void writeHdf5(std::string_view text, const std::filesystem::path& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  std::istringstream lines{std::string(text)};
  for (std::string line, item; std::getline(lines, line);) {
    std::istringstream words(line);
    words >> item;
    if (item == "attr") addAttribute(file, words);
    if (item == "data") addData(file, words);
    if (item == "text") addText(file, words);
    if (item == "group") addGroup(file, words);
  }
  H5Fclose(file);
}

}  // namespace weir::fuzz
