#include "apps/studio/session/number_history.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace weir::studio {

namespace {

using Values = std::map<std::string, double>;

bool isVector(const Value& value) {
  constexpr std::size_t kAxes = 3;
  return value.isArray() && value.asArray().size() == kAxes &&
         std::all_of(value.asArray().begin(), value.asArray().end(),
                     [](const Value& v) { return v.isNumber(); });
}

void collect(const std::string& name, const Value& value, Values& into) {
  if (value.isNumber()) {
    into[name] = value.asDouble();
  } else if (isVector(value)) {
    const Value::Array& v = value.asArray();
    into[name] = std::hypot(v[0].asDouble(), v[1].asDouble(), v[2].asDouble());
  } else if (value.isObject()) {
    for (const auto& [key, inner] : value.asObject()) collect(name + "." + key, inner, into);
  }
}

Values valuesOf(const Value& numbers) {
  Values values;
  if (const Value* nodes = numbers.find("nodes"))
    for (const auto& [node, report] : nodes->asObject()) collect(node, report, values);
  if (const Value* step = numbers.find("step_ms")) values["step (ms)"] = step->find("median")->asDouble();
  if (const Value* particles = numbers.find("particles")) values["particles"] = particles->asDouble();
  return values;
}

}  // namespace

void NumberHistory::add(const Value& numbers) {
  const double time = numbers.find("simulated_seconds")->asDouble();
  while (!samples_.empty() && samples_.back().time >= time) samples_.pop_back();
  if (samples_.size() >= max_) thin();
  samples_.push_back({time, valuesOf(numbers)});
  last_ = numbers;
}

void NumberHistory::thin() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples_.size(); i += 2) samples_[kept++] = std::move(samples_[i]);
  samples_.resize(kept);
}

Value NumberHistory::value() const {
  std::set<std::string> names;
  Value times = Value::array();
  for (const Sample& sample : samples_) {
    times.push(sample.time);
    for (const auto& [name, unused] : sample.values) names.insert(name);
  }
  Value values = Value::object();
  for (const std::string& name : names) {
    Value row = Value::array();
    for (const Sample& sample : samples_) {
      const auto found = sample.values.find(name);
      row.push(found == sample.values.end() || !std::isfinite(found->second) ? Value()
                                                                             : Value(found->second));
    }
    values[name] = std::move(row);
  }
  Value v = Value::object();
  v["times"] = std::move(times);
  v["values"] = std::move(values);
  return v;
}

}  // namespace weir::studio
