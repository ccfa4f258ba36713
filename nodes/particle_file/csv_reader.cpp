#include "nodes/particle_file/csv_reader.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/table_text.h"
#include "framework/base/text.h"
#include "nodes/particle_file/particle_columns.h"

namespace weir {

namespace {

std::vector<std::string> headerNames(std::string_view line, int number) {
  std::vector<std::string> names;
  TableFields fields(line, number);
  while (fields.next()) names.emplace_back(fields.field());
  return names;
}

float readNumber(const TableFields& fields, std::size_t slot) {
  std::string_view text = fields.field();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  const auto found = [&] {
    return std::string(ParticleColumns::nameOfSlot(slot)) + " is " + inQuotes(fields.field());
  };
  if (code == std::errc::invalid_argument || end != text.data() + text.size())
    throw fields.error(found(), "a number");
  const auto value = static_cast<float>(number);
  if (code != std::errc() || !std::isfinite(value))
    throw fields.error(found(), "a finite single-precision number");
  return value;
}

ParticleRow readRow(std::string_view line, int number, const ParticleColumns& columns) {
  ParticleRow row{};
  TableFields fields(line, number);
  std::size_t column = 0;
  for (; fields.next(); ++column) {
    if (column == columns.size())
      throw fields.error("there are more fields than the header has columns",
                         std::to_string(columns.size()) + " fields");
    if (const auto slot = columns.slot(column)) row[*slot] = readNumber(fields, *slot);
  }
  if (column < columns.size())
    throw fields.error("the line ends after " + std::to_string(column) + " fields",
                       std::to_string(columns.size()) + " fields, as in the header");
  return row;
}

ParticleData readTable(std::string_view text) {
  TableLines lines(text);
  if (!lines.next()) throw ioError("the file is empty", "a line of column names, then one line a particle");
  std::optional<ParticleColumns> columns;
  try {
    columns.emplace(headerNames(lines.line(), lines.number()));
  } catch (Error& error) {
    throw error.at({.line = lines.number(), .column = 1});
  }
  ParticleData data{.positions = {}, .velocities = {}, .unused = columns->unused()};
  while (lines.next()) addParticle(readRow(lines.line(), lines.number(), *columns), data);
  if (data.positions.empty()) throw ioError("there are no particles behind the header", "one line or more");
  return data;
}

}  // namespace

ParticleData CsvReader::read(const std::filesystem::path& file) const {
  const std::string text = readParticleFile(file);
  try {
    return readTable(text);
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
