#include "tests/support/scene_mutator.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>

#include "framework/scene/scene_file.h"

namespace weir::test {

std::uint64_t Random::next() {
  std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

namespace {

using Mutation = void (*)(Value& scene, Random& random);

void collect(Value& v, std::vector<Value*>& all) {
  all.push_back(&v);
  if (v.isArray())
    for (Value& item : v.asArray()) collect(item, all);
  if (v.isObject())
    for (auto& [name, member] : v.asObject()) collect(member, all);
}

/// A value anywhere in the scene that is of some kind, or null.
Value* pickValue(Value& scene, Random& random, const std::function<bool(const Value&)>& fits) {
  std::vector<Value*> all;
  collect(scene, all);
  std::erase_if(all, [&](const Value* v) { return !fits(*v); });
  return all.empty() ? nullptr : random.pick(all);
}

bool isAnything(const Value&) {
  return true;
}
bool hasMembers(const Value& v) {
  return v.isObject() && !v.asObject().empty();
}
bool hasElements(const Value& v) {
  return v.isArray() && !v.asArray().empty();
}

Value oddValue(Random& random) {
  static const std::vector<Value> kOdd{
      Value(),
      true,
      false,
      0,
      -1,
      2,
      -0.001,
      1e308,
      -1e308,
      1e39,
      4.9e-324,
      1e15,
      0.1,
      std::numeric_limits<std::int64_t>::max(),
      std::numeric_limits<std::int64_t>::min(),
      std::numeric_limits<std::int32_t>::max(),
      "",
      "nan",
      "NaN",
      "Infinity",
      "0.5",
      "box",
      "Zweitür ✓ 数学 🌊",
      std::string("zero\0byte", 9),
      "line\nbreak\x1b[31m",
      std::string(5000, 'x'),
      "a.b -> c.d",
      "->",
      "/no/such/folder/file.obj",
      "../../../missing.ply",
      Value::array(),
      Value::object(),
      Value::Array{0, 0, 0},
      Value::Array{1, 2},
      Value::Array{0, "a", Value()},
      Value::Array{Value::array(), Value::object()},
      Value(Value::Object{{"type", "Source"}}),
      Value(Value::Object{{"", 1}}),
      Value(Value::Object{{"a", 1}, {"a", 2}}),
  };
  return random.pick(kOdd);
}

std::string misspelled(std::string name, Random& random) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz_ABC019 ./~-\n\"\\";
  switch (random.below(6)) {
    case 0:
      return "";
    case 1:
      return name + name;
    case 2:
      return std::string(random.below(4000), 'n') + name;
    case 3:
      return name + "é数";
    default:
      break;
  }
  if (name.empty()) return "x";
  const std::size_t at = random.below(name.size());
  if (random.chance(0.3))
    name.erase(at, 1);
  else if (random.chance(0.5))
    name.insert(at, 1, random.pick(kLetters));
  else
    name[at] = random.pick(kLetters);
  return name;
}

void replaceValue(Value& scene, Random& random) {
  *pickValue(scene, random, isAnything) = oddValue(random);
}

/// A value that may well be right.
void nudgeNumber(Value& scene, Random& random) {
  Value* number = pickValue(scene, random, [](const Value& v) { return v.isNumber(); });
  constexpr double kFactors[] = {0, 0.1, 0.5, 1.5, 2, 10, -1};
  if (number == nullptr) return;
  const double nudged = number->asDouble() * random.pick(kFactors);
  *number =
      number->isInt() ? Value(static_cast<std::int64_t>(std::clamp(nudged, -9e18, 9e18))) : Value(nudged);
}

void removePart(Value& scene, Random& random) {
  Value* parent = pickValue(scene, random, [](const Value& v) { return hasMembers(v) || hasElements(v); });
  if (parent == nullptr) return;
  if (parent->isArray()) {
    auto& items = parent->asArray();
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(random.below(items.size())));
  } else {
    auto& members = parent->asObject();
    members.erase(members.begin() + static_cast<std::ptrdiff_t>(random.below(members.size())));
  }
}

void misspellKey(Value& scene, Random& random) {
  if (Value* object = pickValue(scene, random, hasMembers)) {
    auto& members = object->asObject();
    std::string& name = members[random.below(members.size())].first;
    name = misspelled(name, random);
  }
}

void misspellText(Value& scene, Random& random) {
  if (Value* text = pickValue(scene, random, [](const Value& v) { return v.isString(); }))
    *text = misspelled(text->asString(), random);
}

void repeatPart(Value& scene, Random& random) {
  constexpr std::size_t kManyElements = 3000;
  Value* parent = pickValue(scene, random, [](const Value& v) { return hasMembers(v) || hasElements(v); });
  if (parent == nullptr) return;
  if (parent->isArray()) {
    auto& items = parent->asArray();
    const Value item = random.pick(items);
    items.insert(items.end(), random.chance(0.2) ? kManyElements : 1, item);
  } else {
    auto& members = parent->asObject();
    auto member = random.pick(members);
    if (random.chance(0.5)) member.first += "2";
    members.push_back(std::move(member));
  }
}

void swapValues(Value& scene, Random& random) {
  Value* a = pickValue(scene, random, [](const Value& v) { return !hasMembers(v); });
  Value* b = pickValue(scene, random, [](const Value& v) { return !hasMembers(v) && !hasElements(v); });
  if (a == nullptr || b == nullptr) return;
  Value copyOfA = *a, copyOfB = *b;  // b may stand inside a
  *b = std::move(copyOfA);
  if (!hasElements(*b)) *a = std::move(copyOfB);
}

void swapKeys(Value& scene, Random& random) {
  Value* a = pickValue(scene, random, hasMembers);
  Value* b = pickValue(scene, random, hasMembers);
  if (a == nullptr) return;
  auto& membersOfA = a->asObject();
  auto& membersOfB = b->asObject();
  std::swap(membersOfA[random.below(membersOfA.size())].first,
            membersOfB[random.below(membersOfB.size())].first);
}

void addOddMember(Value& scene, Random& random) {
  constexpr const char* kKeys[] = {"type",    "params", "modules", "after", "before", "enabled",
                                   "weir",    "world",  "nodes",   "links", "dt",     "spacing",
                                   "comment", "",       "💧",       "a/b~c"};
  if (Value* object = pickValue(scene, random, [](const Value& v) { return v.isObject(); }))
    object->asObject().emplace_back(random.pick(kKeys), oddValue(random));
}

/// A link between ports that exist in some link, in any combination: cycles, self-links, wrong types.
void addLink(Value& scene, Random& random) {
  Value* links = scene.find("links");
  if (links == nullptr || !hasElements(*links)) return;
  const auto end = [&](bool source) -> std::string {
    const Value& link = random.pick(links->asArray());
    if (!link.isString()) return "x.y";
    const std::string& text = link.asString();
    const auto arrow = text.find(" -> ");
    if (arrow == std::string::npos) return text;
    return source ? text.substr(0, arrow) : text.substr(arrow + 4);
  };
  std::string from = end(!random.chance(0.1)), to = end(random.chance(0.1));
  const auto renameNode = [](std::string& port, const std::string& node) {
    const auto dot = port.find('.');
    if (dot != std::string::npos) port = node + port.substr(dot);
  };
  if (random.chance(0.3)) renameNode(from, to.substr(0, to.find('.')));
  if (random.chance(0.2)) from = misspelled(from, random);
  links->push(from + " -> " + to);
}

/// The links, each also the other way round: cycles.
void reverseLinks(Value& scene, Random& random) {
  Value* links = scene.find("links");
  if (links == nullptr || !links->isArray()) return;
  for (Value& link : links->asArray())
    if (link.isString() && random.chance(0.5))
      if (const auto arrow = link.asString().find(" -> "); arrow != std::string::npos)
        link = link.asString().substr(arrow + 4) + " -> " + link.asString().substr(0, arrow);
}

constexpr Mutation kMutations[] = {nudgeNumber, nudgeNumber,  replaceValue, replaceValue, replaceValue,
                                   removePart,  misspellKey,  misspellText, repeatPart,   swapValues,
                                   swapKeys,    addOddMember, addLink,      reverseLinks};

void editBytes(std::string& text, Random& random) {
  for (std::size_t edits = 1 + random.below(6); edits > 0 && !text.empty(); --edits) {
    const std::size_t at = random.below(text.size());
    const char byte = static_cast<char>(random.below(256));
    switch (random.below(4)) {
      case 0:
        text[at] = byte;
        break;
      case 1:
        text.insert(at, 1, byte);
        break;
      case 2:
        text.erase(at, 1 + random.below(3));
        break;
      default:
        std::swap(text[at], text[random.below(text.size())]);
    }
  }
}

void truncate(std::string& text, Random& random) {
  text.resize(random.below(text.size() + 1));
}

void moveBlock(std::string& text, Random& random) {
  if (text.empty()) return;
  const std::size_t from = random.below(text.size());
  const std::string block = text.substr(from, random.below(200));
  if (random.chance(0.5)) text.erase(from, block.size());
  text.insert(random.below(text.size() + 1), block);
}

/// Puts something odd where a value or a separator stands.
void insertToken(std::string& text, Random& random) {
  static const std::string kTokens[] = {"NaN",
                                        "-Infinity",
                                        "// x\n",
                                        "/* x */",
                                        "'x'",
                                        "True",
                                        "None",
                                        "1e999",
                                        "-1e999",
                                        "1e-999",
                                        "01",
                                        "+1",
                                        ".5",
                                        "1.",
                                        "0x10",
                                        "99999999999999999999",
                                        "\"",
                                        "\"\\ud800\"",
                                        "\"\\x\"",
                                        "\xEF\xBB\xBF",
                                        std::string(1, '\0'),
                                        "\xFF\xFE",
                                        "\xC0\x80",
                                        ",",
                                        ",,",
                                        ":",
                                        "[",
                                        "]",
                                        "{",
                                        "}",
                                        "{}",
                                        "[]",
                                        "\"\t\"",
                                        "undefined",
                                        "#",
                                        ";"};
  constexpr std::string_view kSeparators = "[]{},:";
  std::vector<std::size_t> places{0, text.size()};
  for (std::size_t i = 0; i < text.size(); ++i)
    if (kSeparators.find(text[i]) != std::string_view::npos) places.push_back(i + 1);
  text.insert(random.pick(places), random.pick(kTokens));
}

void nestDeeply(std::string& text, Random& random) {
  constexpr std::size_t kDepths[] = {10, 60, 63, 64, 65, 1000, 100000};
  const std::size_t depth = random.pick(kDepths);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == ':') places.push_back(i + 1);
  if (places.empty()) places.push_back(0);
  std::string nested;
  if (random.chance(0.5)) {
    nested = std::string(depth, '[');
    if (random.chance(0.7)) nested += std::string(depth, ']');
  } else {
    for (std::size_t i = 0; i < depth; ++i) nested += "{\"a\":";
    if (random.chance(0.7)) nested += "1" + std::string(depth, '}');
  }
  const std::size_t at = random.pick(places);
  // In place of the value where that is a simple one, so that the nesting alone is wrong.
  const std::size_t end = text.find_first_of(",}]\n", at);
  if (random.chance(0.5) && end != std::string::npos) text.erase(at, end - at);
  text.insert(at, nested);
}

using TextMutation = void (*)(std::string& text, Random& random);
constexpr TextMutation kTextMutations[] = {editBytes,   editBytes,   truncate,  moveBlock,
                                           insertToken, insertToken, nestDeeply};

}  // namespace

SceneMutator::SceneMutator(const std::vector<std::string>& scenes) : texts_(scenes) {
  for (const std::string& text : scenes) scenes_.push_back(parseScene(text, "base scene"));
}

std::string SceneMutator::mutate(std::uint64_t seed) const {
  Random random(seed);
  const std::size_t base = random.below(scenes_.size());
  std::string text = texts_[base];
  const bool editsValues = random.chance(0.65);
  if (editsValues) {
    Value scene = scenes_[base];
    const std::size_t edits = random.chance(0.6) ? 1 : 2 + random.below(3);
    for (std::size_t i = 0; i < edits; ++i) random.pick(kMutations)(scene, random);
    text = writeJson(scene);
  }
  if (!editsValues || random.chance(0.1)) random.pick(kTextMutations)(text, random);
  return text;
}

}  // namespace weir::test
