#include "apps/studio/session/particle_values.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "apps/studio/session/on_host.h"
#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/graph/outputs_of.h"
#include "framework/particles/particles.h"

namespace weir::studio {

namespace {

/// A node's particles, or null.
ParticleSet* particlesOf(const Simulation& simulation, const std::string& node) {
  for (const auto& [name, output] : outputsOf<Particles>(simulation.scene().graph))
    if (name == node && (*output)->exist()) return &(*output)->set();
  return nullptr;
}

template <class T>
auto componentOf(const T& element, int component) {
  return reinterpret_cast<const typename AttributeTraits<T>::Number*>(&element)[component];
}

template <class T>
Value valueOf(const T& element) {
  if constexpr (kNumbersIn<T> == 1) {
    return element;
  } else {
    Value numbers = Value::array();
    for (int k = 0; k < kNumbersIn<T>; ++k) numbers.push(componentOf(element, k));
    return numbers;
  }
}

/// The attributes of the particles at these indices, each with as many values.
Value valuesOf(const ParticleSet& particles, const AttributeInfo& info,
               std::span<const std::int64_t> indices) {
  return withAttributeType(info.type, [&]<class T>(std::type_identity<T>) {
    Value values = Value::array();
    for (const T& element : onHost(particles.get<T>(info.name), indices)) values.push(valueOf(element));
    return values;
  });
}

/// A column of numbers.
struct Column {
  static constexpr int kLength = -1;

  std::string name, unit, attribute;
  int component = 0;     // which of the attribute's numbers, or the length of a vector
  bool isWhole = false;  // whole numbers
};

std::vector<Column> columnsOf(const ParticleSet& particles) {
  std::vector<Column> columns{{"id", "", "id", 0, true}};
  for (const AttributeInfo& info : particles.attributes()) {
    if (info.name == "id") continue;
    int at = 0;
    for (const std::string_view component : componentsOf(info.type))
      columns.push_back({component.empty() ? info.name : info.name + "." + std::string(component), info.unit,
                         info.name, at++, isWhole(info.type)});
    if (info.name == "velocity" && particles.find("speed") == nullptr)
      columns.push_back({"speed", info.unit, info.name, Column::kLength});
  }
  return columns;
}

template <class T>
double numberOf(const T& element, int component) {
  if constexpr (std::is_same_v<T, Vec3f>)
    if (component == Column::kLength) return length(element);
  return static_cast<double>(componentOf(element, component));
}

/// The numbers of a column, of all particles or of some.
template <class Which>
std::vector<double> numbersOf(const ParticleSet& particles, const Column& column, Which which) {
  std::vector<double> numbers;
  withAttributeType(particles.find(column.attribute)->type, [&]<class T>(std::type_identity<T>) {
    for (const T& element : onHost(particles.get<T>(column.attribute), which))
      numbers.push_back(numberOf(element, column.component));
  });
  return numbers;
}

/// The particles from … from + count - 1 in the order that is asked for.
std::vector<std::int64_t> windowOf(const std::vector<std::int64_t>& ids, const std::vector<double>& keys,
                                   bool descending, std::int64_t from, std::int64_t count) {
  std::vector<std::int64_t> order(ids.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](std::int64_t a, std::int64_t b) {
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    const bool none = std::isnan(keys[i]), otherNone = std::isnan(keys[k]);
    if (none != otherNone) return otherNone;
    if (!none && keys[i] != keys[k]) return descending ? keys[i] > keys[k] : keys[i] < keys[k];
    return ids[i] < ids[k];
  };
  // Only the page is sorted: the rest is before it or behind it.
  const auto first = order.begin() + from;
  const auto last = first + std::min<std::int64_t>(count, order.end() - first);
  std::nth_element(order.begin(), first, order.end(), before);
  if (last != order.end()) std::nth_element(first, last, order.end(), before);
  std::sort(first, last, before);
  return {first, last};
}

}  // namespace

Value particleValue(const Simulation& simulation, const std::string& node, std::int64_t id) {
  ParticleSet* particles = particlesOf(simulation, node);
  if (particles == nullptr) return {};
  const std::vector<std::int64_t> ids = onHost<std::int64_t>(particles->ids(), particles->refreshCount());
  const auto found = std::find(ids.begin(), ids.end(), id);
  if (found == ids.end()) return {};
  const std::int64_t at = found - ids.begin();
  Value attributes = Value::object();
  for (const AttributeInfo& info : particles->attributes())
    attributes[info.name] = valuesOf(*particles, info, {&at, 1}).asArray().front();
  Value result = Value::object();
  result["node"] = node;
  result["id"] = id;
  result["attributes"] = std::move(attributes);
  return result;
}

Value particlePageValue(const Simulation& simulation, const ParticlePage& page) {
  ParticleSet* particles = particlesOf(simulation, page.node);
  if (particles == nullptr) return {};
  const std::vector<Column> columns = columnsOf(*particles);
  const auto by = std::find_if(columns.begin(), columns.end(),
                               [&](const Column& column) { return column.name == page.sort; });
  if (by == columns.end()) {
    std::vector<std::string> names;
    for (const Column& column : columns) names.push_back(column.name);
    throw usageError("particles have no " + inQuotes(page.sort), joinNames(names),
                     didYouMean(page.sort, names));
  }
  const std::int64_t total = particles->refreshCount();
  const std::int64_t lastPage = std::max<std::int64_t>(0, (total - 1) / page.count * page.count);
  const std::int64_t from = std::min(page.from, lastPage);
  const std::vector<std::int64_t> window =
      windowOf(onHost<std::int64_t>(particles->ids(), total), numbersOf(*particles, *by, total),
               page.descending, from, page.count);
  std::vector<Value> rows(window.size(), Value::array());
  Value named = Value::array();
  for (const Column& column : columns) {
    Value v = Value::object();
    v["name"] = column.name;
    v["unit"] = column.unit;
    named.push(std::move(v));
    const std::vector<double> numbers = numbersOf(*particles, column, std::span<const std::int64_t>(window));
    for (std::size_t i = 0; i < rows.size(); ++i)
      rows[i].push(column.isWhole ? Value(static_cast<std::int64_t>(numbers[i]))
                                  : Value(static_cast<float>(numbers[i])));
  }
  Value result = Value::object();
  result["node"] = page.node;
  result["frame"] = simulation.frame();
  result["time"] = simulation.time();
  result["total"] = total;
  result["from"] = from;
  result["columns"] = std::move(named);
  result["rows"] = Value(Value::Array(rows.begin(), rows.end()));
  return result;
}

}  // namespace weir::studio
