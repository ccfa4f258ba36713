#include "plugins/views/plot_history.h"

#include <algorithm>
#include <limits>

#include "framework/base/text.h"
#include "framework/run/statistics.h"

namespace weir::rendering {

namespace {

/// The numbers in an object by their names, those of objects in it behind a point.
void collect(const Value& object, const std::string& prefix, std::map<std::string, double>& numbers) {
  for (const auto& [name, value] : object.asObject()) {
    if (value.isNumber()) numbers[prefix + name] = value.asDouble();
    if (value.isObject()) collect(value, prefix + name + ".", numbers);
  }
}

std::map<std::string, double> numbersOf(Simulation& simulation) {
  const Value statistics = frameStatistics(simulation);
  std::map<std::string, double> numbers;
  for (const auto& [name, value] : statistics.asObject())
    if (value.isNumber()) numbers[name] = value.asDouble();
  collect(*statistics.find("nodes"), "", numbers);
  return numbers;
}

Error unknownNumber(const Simulation& simulation, const std::string& name, std::size_t plot,
                    const std::map<std::string, double>& numbers) {
  std::vector<std::string> names;
  for (const auto& [known, number] : numbers) names.push_back(known);
  Error e = sceneError("the statistics have no number " + inQuotes(name), joinNames(names),
                       didYouMean(name, names));
  return e.at({.file = simulation.scene().file, .pointer = "/render/plots/" + std::to_string(plot) + "/of"});
}

}  // namespace

std::vector<double> plottedNumbers(const GroupList<PlotSettings>& settings, Simulation& simulation) {
  std::vector<double> plotted;
  if (settings.empty()) return plotted;
  if (simulation.isReplay()) {
    simulation.log().warnOnce("the plots are empty: exported particles say nothing of other numbers");
    return std::vector<double>(settings.size(), std::numeric_limits<double>::quiet_NaN());
  }
  const std::map<std::string, double> numbers = numbersOf(simulation);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const auto found = numbers.find(settings[i].of);
    if (found == numbers.end() && simulation.frame() == 0)
      throw unknownNumber(simulation, settings[i].of, i, numbers);
    plotted.push_back(found != numbers.end() ? found->second : std::numeric_limits<double>::quiet_NaN());
  }
  return plotted;
}

PlotHistory::PlotHistory(const GroupList<PlotSettings>& settings, double lastTime) {
  for (std::size_t i = 0; i < settings.size(); ++i)
    plots_.push_back({.caption = settings[i].caption(), .points = {}, .lastTime = lastTime});
}

void PlotHistory::add(double time, const std::vector<double>& numbers) {
  for (std::size_t i = 0; i < plots_.size(); ++i) plots_[i].points.push_back({time, numbers.at(i)});
}

void PlotHistory::save(const StateWriter& to) const {
  for (std::size_t i = 0; i < plots_.size(); ++i) {
    std::vector<double> times, values;
    for (const PlotPoint& point : plots_[i].points) {
      times.push_back(point.time);
      values.push_back(point.value);
    }
    const StateWriter plot = to.in(std::to_string(i));
    plot.put("times", std::span<const double>(times));
    plot.put("values", std::span<const double>(values));
  }
}

void PlotHistory::restore(const StateReader& from) {
  for (std::size_t i = 0; i < plots_.size(); ++i) {
    const StateReader plot = from.in(std::to_string(i));
    if (!plot.has("times")) continue;  // of a run without this plot, which begins here
    const std::vector<double> times = plot.getAll<double>("times"), values = plot.getAll<double>("values");
    for (std::size_t k = 0; k < std::min(times.size(), values.size()); ++k)
      plots_[i].points.push_back({times[k], values[k]});
  }
}

}  // namespace weir::rendering
