#include "plugins/usd/crate_file.h"

#include <bit>
#include <utility>

#include "framework/base/check.h"

namespace weir::rendering {

static_assert(std::endian::native == std::endian::little);

/// As crateDataTypes.h numbers them.
enum class CrateFile::Type : std::uint64_t {
  kInt = 3,
  kInt64 = 5,
  kFloat = 8,
  kToken = 11,
  kVec3f = 24,
  kTokenVector = 41,
  kSpecifier = 42,
  kTimeSamples = 46,
  kDoubleVector = 48
};

namespace {

constexpr std::uint64_t kArray = std::uint64_t{1} << 63, kInlined = std::uint64_t{1} << 62;
constexpr int kTypeShift = 48;
constexpr int kAttribute = 1, kPrim = 6, kRoot = 7;  // SdfSpecType
constexpr int kOver = 1;                             // SdfSpecifier
constexpr int kEndOfSet = -1;

template <class... Numbers>
std::string bytesOf(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

template <class T>
std::string bytesOfAll(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// One block of LZ4, of literals, behind the number of further blocks.
std::string packed(const std::string& bytes) {
  constexpr std::size_t kInToken = 15, kMost = 255;
  std::string block(1, '\0');
  if (bytes.size() < kInToken) {
    block += static_cast<char>(bytes.size() << 4);
  } else {
    block += static_cast<char>(kInToken << 4);
    std::size_t rest = bytes.size() - kInToken;
    for (; rest >= kMost; rest -= kMost) block += static_cast<char>(kMost);
    block += static_cast<char>(rest);
  }
  return block + bytes;
}

std::string withSize(const std::string& bytes) {
  return bytesOf(std::uint64_t{bytes.size()}) + bytes;
}

/// Whole numbers as differences, all of the widest kind, whose code is 3 in two bits.
std::string packedNumbers(const std::vector<int>& numbers) {
  std::string bytes = bytesOf(std::int32_t{0});
  bytes.append((2 * numbers.size() + 7) / 8, '\xff');
  std::uint32_t last = 0;
  for (const int number : numbers) {
    const auto present = static_cast<std::uint32_t>(number);
    bytes += bytesOf(present - std::exchange(last, present));
  }
  return withSize(packed(bytes));
}

}  // namespace

/// What the sections at the end of the file hold, in the order of the paths.
struct CrateFile::Tables {
  std::vector<int> paths, names, jumps;  // names are below 0 for attributes
  std::vector<int> sets, kinds;  // of each path: where its fields begin in fieldSets, and its SdfSpecType
  std::vector<int> fieldSets, fieldNames;
  std::vector<Rep> fieldValues;
};

CrateFile::CrateFile(double time) : time_(time), content_(88, '\0') {
  nodes_.push_back({.token = tokenOf("")});  // 0, as a name below 0 marks an attribute
  open_.push_back(0);
}

int CrateFile::tokenOf(std::string_view text) {
  const auto found = tokens_.find(text);
  if (found != tokens_.end()) return found->second;
  const int token = static_cast<int>(texts_.size());
  tokens_.emplace(text, token);
  texts_.emplace_back(text);
  return token;
}

std::uint64_t CrateFile::append(std::string_view bytes) {
  constexpr std::size_t kUnit = 8;
  content_.append((kUnit - content_.size() % kUnit) % kUnit, '\0');
  const std::uint64_t place = content_.size();
  content_ += bytes;
  return place;
}

CrateFile::Rep CrateFile::valueOf(std::string_view token) {
  return kInlined | std::uint64_t(Type::kToken) << kTypeShift | static_cast<std::uint64_t>(tokenOf(token));
}

CrateFile::Rep CrateFile::listOf(const std::vector<int>& tokens) {
  const std::string list = bytesOf(std::uint64_t{tokens.size()}) + bytesOfAll(tokens);
  return std::uint64_t(Type::kTokenVector) << kTypeShift | append(list);
}

/// Both lists of samples stand behind how far it is to them.
CrateFile::Rep CrateFile::samplesOf(Rep value) {
  constexpr std::int64_t kNext = 8;
  const Rep times =
      std::uint64_t(Type::kDoubleVector) << kTypeShift | append(bytesOf(std::uint64_t{1}, time_));
  return std::uint64_t(Type::kTimeSamples) << kTypeShift |
         append(bytesOf(kNext, times, kNext, std::uint64_t{1}, value));
}

void CrateFile::beginPrim(std::string_view name) {
  const std::size_t prim = nodes_.size();
  nodes_.push_back({.token = tokenOf(name)});
  nodes_[open_.back()].children.push_back(prim);
  open_.push_back(prim);
}

void CrateFile::endPrim() {
  WEIR_CHECK(open_.size() > 1u);
  open_.pop_back();
}

void CrateFile::addArray(std::string_view name, std::string_view type, Type element,
                         std::span<const std::byte> bytes, std::size_t count) {
  Rep value = kArray | std::uint64_t(element) << kTypeShift;
  if (count > 0) {
    value |= append(bytesOf(std::uint64_t{count}));
    content_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  const std::size_t attribute = nodes_.size();
  nodes_.push_back(
      {.token = tokenOf(name), .isAttribute = true, .type = std::string(type), .samples = samplesOf(value)});
  nodes_[open_.back()].children.push_back(attribute);
}

void CrateFile::add(std::string_view name, std::string_view type, std::span<const Vec3f> values) {
  addArray(name, type, Type::kVec3f, std::as_bytes(values), values.size());
}
void CrateFile::add(std::string_view name, std::string_view type, std::span<const float> values) {
  addArray(name, type, Type::kFloat, std::as_bytes(values), values.size());
}
void CrateFile::add(std::string_view name, std::string_view type, std::span<const std::int32_t> values) {
  addArray(name, type, Type::kInt, std::as_bytes(values), values.size());
}
void CrateFile::add(std::string_view name, std::string_view type, std::span<const std::int64_t> values) {
  addArray(name, type, Type::kInt64, std::as_bytes(values), values.size());
}

std::vector<std::pair<int, CrateFile::Rep>> CrateFile::fieldsOf(const Node& node) {
  if (node.isAttribute)
    return {{tokenOf("typeName"), valueOf(node.type)}, {tokenOf("timeSamples"), node.samples}};
  std::vector<int> prims, attributes;
  for (const std::size_t child : node.children)
    (nodes_[child].isAttribute ? attributes : prims).push_back(nodes_[child].token);
  std::vector<std::pair<int, Rep>> fields;
  if (&node != nodes_.data())
    fields.emplace_back(tokenOf("specifier"),
                        kInlined | std::uint64_t(Type::kSpecifier) << kTypeShift | kOver);
  if (!prims.empty()) fields.emplace_back(tokenOf("primChildren"), listOf(prims));
  if (!attributes.empty()) fields.emplace_back(tokenOf("properties"), listOf(attributes));
  return fields;
}

void CrateFile::collect(std::size_t number, bool hasSibling, Tables& tables) {
  constexpr int kLeaf = -2, kChildOnly = -1, kSiblingOnly = 0;
  const Node& node = nodes_[number];
  const std::size_t place = tables.paths.size();
  tables.paths.push_back(static_cast<int>(place));
  tables.names.push_back(node.isAttribute ? -node.token : node.token);
  tables.jumps.push_back(hasSibling ? kSiblingOnly : kLeaf);
  tables.kinds.push_back(node.isAttribute ? kAttribute : number == 0 ? kRoot : kPrim);
  tables.sets.push_back(static_cast<int>(tables.fieldSets.size()));
  for (const auto& [name, value] : fieldsOf(node)) {
    tables.fieldSets.push_back(static_cast<int>(tables.fieldNames.size()));
    tables.fieldNames.push_back(name);
    tables.fieldValues.push_back(value);
  }
  tables.fieldSets.push_back(kEndOfSet);
  const std::vector<std::size_t> children = node.children;
  for (std::size_t i = 0; i < children.size(); ++i) collect(children[i], i + 1 < children.size(), tables);
  if (children.empty()) return;
  tables.jumps[place] = hasSibling ? static_cast<int>(tables.paths.size() - place) : kChildOnly;
}

std::string CrateFile::finish() && {
  WEIR_CHECK(open_.size() == 1u);
  Tables tables;
  collect(0, false, tables);
  std::string directory;
  std::uint64_t sections = 0;
  const auto section = [&](std::string name, const std::string& bytes) {
    constexpr std::size_t kNameBytes = 16;
    name.resize(kNameBytes, '\0');
    const std::uint64_t place = append(bytes);
    directory += name + bytesOf(place, std::uint64_t{bytes.size()});
    ++sections;
  };
  std::string texts;
  for (const std::string& text : texts_) texts += text + '\0';
  const auto count = [](const auto& list) { return bytesOf(std::uint64_t{list.size()}); };
  section("TOKENS", count(texts_) + bytesOf(std::uint64_t{texts.size()}) + withSize(packed(texts)));
  section("STRINGS", bytesOf(std::uint64_t{0}));
  section("FIELDS", count(tables.fieldNames) + packedNumbers(tables.fieldNames) +
                        withSize(packed(bytesOfAll(tables.fieldValues))));
  section("FIELDSETS", count(tables.fieldSets) + packedNumbers(tables.fieldSets));
  section("PATHS", count(tables.paths) + count(tables.paths) + packedNumbers(tables.paths) +
                       packedNumbers(tables.names) + packedNumbers(tables.jumps));
  section("SPECS", count(tables.paths) + packedNumbers(tables.paths) + packedNumbers(tables.sets) +
                       packedNumbers(tables.kinds));
  const std::uint64_t place = append(bytesOf(sections) + directory);
  content_.replace(0, 24, std::string("PXR-USDC\x00\x08\x00\x00\x00\x00\x00\x00", 16) + bytesOf(place));
  return std::move(content_);
}

}  // namespace weir::rendering
