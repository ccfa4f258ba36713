#include "apps/studio/session/number_history.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
  shorten(std::size_t(std::lower_bound(times_.begin(), times_.end(), time) - times_.begin()));
  if (times_.size() >= max_) thin();
  constexpr double kNotTold = std::numeric_limits<double>::quiet_NaN();
  for (auto& [name, row] : values_) row.push_back(kNotTold);
  times_.push_back(time);
  for (const auto& [name, value] : valuesOf(numbers)) {
    std::vector<double>& row = values_[name];
    row.resize(times_.size(), kNotTold);  // of a name that is new
    row.back() = value;
  }
  last_ = numbers;
}

void NumberHistory::shorten(std::size_t count) {
  times_.resize(count);
  for (auto& [name, row] : values_) row.resize(count);
}

void NumberHistory::thin() {
  const auto everySecond = [](std::vector<double>& row) {
    for (std::size_t i = 0; i < row.size(); i += 2) row[i / 2] = row[i];
  };
  everySecond(times_);
  for (auto& [name, row] : values_) everySecond(row);
  shorten((times_.size() + 1) / 2);
}

Value NumberHistory::value() const {
  const auto asValue = [](const std::vector<double>& row) {
    Value::Array array(row.begin(), row.end());
    for (Value& value : array)
      if (!std::isfinite(value.asDouble())) value = Value();
    return Value(std::move(array));
  };
  Value values = Value::object();
  for (const auto& [name, row] : values_) values[name] = asValue(row);
  Value v = Value::object();
  v["times"] = asValue(times_);
  v["values"] = std::move(values);
  return v;
}

}  // namespace weir::studio
