#include "framework/graph/state.h"

#include <fmt/format.h>

#include <cstring>

#include "framework/base/error.h"

namespace weir {

std::size_t sizeOf(StateKind kind) {
  switch (kind) {
    case StateKind::kFloat:
    case StateKind::kInt:
      return 4;
    case StateKind::kDouble:
    case StateKind::kInt64:
      return 8;
    case StateKind::kByte:
      break;
  }
  return 1;
}

void StateWriter::put(std::string_view name, StateKind kind, int columns,
                      std::span<const std::byte> data) const {
  StateArray array{kind, 0, columns, {data.begin(), data.end()}};
  array.rows = static_cast<std::int64_t>(data.size() / (sizeOf(kind) * static_cast<std::size_t>(columns)));
  const bool added = to_->emplace(prefix_ + std::string(name), std::move(array)).second;
  WEIR_CHECK(added);
}

bool StateReader::has(std::string_view name) const {
  return from_->find(prefix_ + std::string(name)) != from_->end();
}

const StateArray& StateReader::find(std::string_view name, StateKind kind, int columns) const {
  const std::string path = prefix_ + std::string(name);
  const auto found = from_->find(path);
  if (found == from_->end())
    throw ioError("the checkpoint has no '" + path + "'", "one that this program and its plugins wrote",
                  "resume it with those that wrote it, or run the scene from the start");
  const StateArray& array = found->second;
  if (array.kind != kind || array.columns != columns || array.data.size() != array.bytes())
    throw ioError("the checkpoint's '" + path + "' is not what this program would write",
                  "one of the same version of the program and its plugins",
                  "resume it with those that wrote it, or run the scene from the start");
  return array;
}

void StateReader::refuse(std::string_view name, std::string_view found, std::string_view expected) const {
  throw ioError(fmt::format("the checkpoint's '{}{}' is {}", prefix_, name, found), std::string(expected));
}

void StateReader::checkRows(std::string_view name, const StateArray& array, std::int64_t rows) const {
  if (array.rows != rows)
    throw ioError(fmt::format("the checkpoint's '{}{}' has {} rows", prefix_, name, array.rows),
                  fmt::format("{} rows", rows));
}

void StateReader::copyTo(const StateArray& array, void* to) {
  if (!array.data.empty()) std::memcpy(to, array.data.data(), array.data.size());
}

StateMember::StateMember(Stateful& owner, std::string_view name) : name_(name) {
  // "modules" is where the states of a node's modules stand, beside its own.
  WEIR_CHECK((!name.empty() && name.find('/') == std::string_view::npos && name != "modules"));
  for (const StateMember* other : owner.states()) WEIR_CHECK(other->name() != name);
  owner.states_.push_back(this);
}

void Stateful::saveState(const StateWriter& to) const {
  for (const StateMember* state : states_) state->save(to);
  save(to);
}

void Stateful::restoreState(const StateReader& from) {
  for (StateMember* state : states_) state->restore(from);
  restore(from);
}

}  // namespace weir
