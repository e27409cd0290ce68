#include "input/files/raster_file.hpp"

#include <cmath>
#include <limits>
#include <map>

#include "common/text.hpp"
#include "common/text_file.hpp"

namespace mpm {
namespace {

constexpr double k_largest = 1e9;  // m, and of a value

/// The lines before the values. Stops at the first word that is no key, which it returns.
std::string read_header(Words& words, std::map<std::string, double>& header, std::string& fault) {
  static const char* const k_keys[] = {"ncols",     "nrows",     "xllcorner", "xllcenter",
                                       "yllcorner", "yllcenter", "cellsize",  "nodata_value"};
  for (;;) {
    const std::string word(words.next()), key = lower_case(word);
    bool known = false;
    for (const char* name : k_keys) known = known || key == name;
    if (!known) return word;
    const auto number = words.number();
    if (!number || header.count(key)) {
      fault =
          formatted("an ESRI ASCII grid: line %ld takes %s and a number, once", words.line(), key.c_str());
      return "";
    }
    header[key] = *number;
  }
}

/// Takes the header, checked against the size of the file.
std::string take_header(const std::map<std::string, double>& header, double bytes, Raster& raster) {
  const auto value = [&](const char* key) { return header.count(key) ? header.at(key) : NAN; };
  for (const char* key : {"ncols", "nrows", "cellsize"})
    if (!header.count(key)) return std::string("an ESRI ASCII grid, whose header has ") + key;
  for (const char* axis : {"x", "y"})
    if (header.count(std::string(axis) + "llcorner") + header.count(std::string(axis) + "llcenter") != 1)
      return std::string("an ESRI ASCII grid, whose header has ") + axis + "llcorner or " + axis + "llcenter";
  const double columns = value("ncols"), rows = value("nrows"), cell = value("cellsize");
  for (const double count : {columns, rows})
    if (!(count >= 1 && count <= 2147483647 && count == std::floor(count)))
      return "an ESRI ASCII grid, whose ncols and nrows are whole numbers of 1 or more";
  if (columns * rows > (bytes + 1) / 2)
    return formatted("an ESRI ASCII grid with as many values as its header says, %.0f", columns * rows);
  if (!(cell > 0 && cell <= k_largest)) return "an ESRI ASCII grid, whose cellsize is greater than 0 m";
  raster.columns = static_cast<long>(columns), raster.rows = static_cast<long>(rows), raster.cell = cell;
  raster.x = header.count("xllcorner") ? value("xllcorner") : value("xllcenter") - cell / 2;
  raster.y = header.count("yllcorner") ? value("yllcorner") : value("yllcenter") - cell / 2;
  if (!(std::abs(raster.x) <= k_largest && std::abs(raster.y) <= k_largest))
    return "an ESRI ASCII grid within 1e9 m of the origin; scripts/terrain gives one a local origin";
  return "";
}

/// Lines of a surface along an axis: sides, and middles of blocks of cells.
std::vector<double> lines_of(double from, double cell, long count, long block) {
  std::vector<double> lines{from};
  for (long k = 0; k < count; k += block)
    lines.push_back(from + static_cast<double>(k + std::min(k + block, count)) / 2 * cell);
  lines.push_back(from + static_cast<double>(count) * cell);
  return lines;
}

}  // namespace

std::string read_raster(const std::string& path, Raster& raster) {
  std::string text;
  constexpr double k_copies = 8;  // of a value's text: as a number, in the raster and in its surface
  std::string fault = read_whole(path, k_copies, text);
  if (!fault.empty()) return fault;
  Words words(text);
  std::map<std::string, double> header;
  std::string word = read_header(words, header, fault);
  if (fault.empty()) fault = take_header(header, static_cast<double>(text.size()), raster);
  if (!fault.empty()) return fault;
  const double no_data = header.count("nodata_value") ? header["nodata_value"] : -9999;
  raster.values.resize(raster.columns * raster.rows);
  Words first(word);
  for (long row = raster.rows - 1; row >= 0; --row)
    for (long column = 0; column < raster.columns; ++column) {
      const bool is_first = row == raster.rows - 1 && column == 0;
      const auto value = is_first ? first.number() : words.number();
      if (!value || !(std::abs(*value) <= k_largest || *value == no_data))
        return formatted("an ESRI ASCII grid of %ld x %ld numbers; number %ld of row %ld, line %ld, is none",
                         raster.columns, raster.rows, column + 1, raster.rows - row, words.line());
      raster.values[row * raster.columns + column] =
          *value == no_data ? std::numeric_limits<double>::quiet_NaN() : *value;
    }
  if (!words.next().empty())
    return formatted("an ESRI ASCII grid of %ld x %ld numbers; line %ld has more", raster.columns,
                     raster.rows, words.line());
  return "";
}

namespace {

/// Mean of the values of a block of cells; NaN where one is.
double mean_of_block(const Raster& raster, long i, long j, long block) {
  const long right = std::min((i + 1) * block, raster.columns),
             above = std::min((j + 1) * block, raster.rows);
  double sum = 0;
  for (long row = j * block; row < above; ++row)
    for (long column = i * block; column < right; ++column)
      sum += raster.values[row * raster.columns + column];
  return sum / static_cast<double>((right - i * block) * (above - j * block));
}

}  // namespace

long block_under_mesh(const Raster& raster, double spacing) {
  constexpr double k_in_cell = 16;  // blocks along the edge of a cell of the mesh
  const double block = spacing / (k_in_cell * raster.cell);
  const double most = static_cast<double>(std::max(raster.columns, raster.rows));
  return block >= 2 ? static_cast<long>(std::min(block, most)) : 1;
}

std::shared_ptr<const HeightSurface> surface_of(const Raster& raster, long block) {
  const long columns = (raster.columns + block - 1) / block, rows = (raster.rows + block - 1) / block;
  std::vector<double> values;
  values.reserve(columns * rows);
  for (long j = 0; j < rows; ++j)
    for (long i = 0; i < columns; ++i) values.push_back(mean_of_block(raster, i, j, block));
  const auto within = [](long k, long count) { return std::min(std::max(k - 1, 0L), count - 1); };
  std::vector<double> heights;
  heights.reserve((columns + 2) * (rows + 2));
  for (long j = 0; j < rows + 2; ++j)
    for (long i = 0; i < columns + 2; ++i)
      heights.push_back(values[within(j, rows) * columns + within(i, columns)]);
  return std::make_shared<const HeightSurface>(lines_of(raster.x, raster.cell, raster.columns, block),
                                               lines_of(raster.y, raster.cell, raster.rows, block),
                                               std::move(heights));
}

}  // namespace mpm
