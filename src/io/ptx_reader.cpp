// PTX, the scans of Leica Cyclone: for each the size of its grid, where the scanner stood, a matrix, and a line a cell.
// Source: Leica Geosystems, "PTX file format", and how CloudCompare and PDAL understand it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/parsed_columns.hpp"
#include "io/readers.hpp"
#include "io/scans.hpp"

namespace pointskin::io {
namespace {

constexpr char kAgain[] = "copy or export it again";
constexpr std::int64_t kHeaderRows = 10;

/// The scan's own coordinates to those of the world: rows as in the file, a point is a row before the matrix.
using Matrix = std::array<std::array<double, 4>, 4>;

struct PtxScan {
  std::int64_t first = 0;  ///< row of its first cell
  std::int64_t cells = 0;
  std::size_t values = 0;  ///< of a cell: x, y, z, then intensity, then red, green, blue; 0 if there is no cell
  Vec3d sensor;
  Matrix matrix{};

  [[nodiscard]] bool has_intensity() const { return values >= 4; }
  [[nodiscard]] bool has_colour() const { return values == 7; }
  [[nodiscard]] Vec3d to_world(const Vec3d& p) const {
    Vec3d world{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      world[axis] = p[0] * matrix[0][axis] + p[1] * matrix[1][axis] + p[2] * matrix[2][axis] + matrix[3][axis];
    return world;
  }
};

/// Goes through the rows of a text, forwards only. What is passed over is hardly looked at.
class RowCursor {
 public:
  explicit RowCursor(const LineIndex& index) : index_(index) {}

  /// @param row  in [0, rows), behind those asked for before
  Line line_of(std::int64_t row) {
    enter_block_of(row);
    Line found;
    for_each_line(rest_, [&](std::string_view text) {
      ++line_;
      rest_.remove_prefix(std::min(text.size() + 1, rest_.size()));
      if (!is_row(text) || row_++ != row) return true;
      found = {text, line_ - 1, row};
      return false;
    });
    return found;
  }

 private:
  void enter_block_of(std::int64_t row) {
    const auto is_behind = [](std::int64_t r, const LineBlock& block) { return r < block.first_row; };
    const auto next = std::upper_bound(index_.blocks.begin(), index_.blocks.end(), row, is_behind);
    const auto block = next - index_.blocks.begin() - 1;
    if (block == block_) return;
    block_ = block;
    const LineBlock& in = index_.blocks[static_cast<std::size_t>(block)];
    rest_ = in.text;
    line_ = in.first_line;
    row_ = in.first_row;
  }

  const LineIndex& index_;
  std::ptrdiff_t block_ = -1;
  std::string_view rest_;
  std::int64_t line_ = 0, row_ = 0;  ///< of the first line of the rest
};

/// Finds the scans of a file.
class ScanFinder {
 public:
  ScanFinder(const Source& source, const LineIndex& index) : source_(source), index_(index), cursor_(index) {}

  std::vector<PtxScan> find() {
    std::vector<PtxScan> scans;
    for (std::int64_t row = 0; row < index_.rows; row = scans.back().first + scans.back().cells)
      scans.push_back(scan_at(row));
    if (scans.empty()) fail(source_, "holds no scan", "check the program that wrote it");
    return scans;
  }

 private:
  PtxScan scan_at(std::int64_t row) {
    if (index_.rows - row < kHeaderRows) fail_short("the ten lines before a scan");
    const std::int64_t columns = count_at(row);
    const std::int64_t rows = count_at(row + 1);
    PtxScan scan;
    scan.first = row + kHeaderRows;
    scan.sensor = vector_at(row + 2);
    for (std::int64_t axis = 3; axis < 6; ++axis) vector_at(row + axis);
    for (std::size_t i = 0; i < 4; ++i) scan.matrix[i] = numbers_at<4>(row + 6 + static_cast<std::int64_t>(i));
    check_affine(scan, row);
    // Where nothing was written, points are seen from their own origin.
    if (scan.sensor == Vec3d{}) scan.sensor = scan.to_world({0, 0, 0});
    const std::int64_t left = index_.rows - scan.first;
    if (rows > 0 && columns > left / rows) fail_short(fmt::format("{} x {} points", columns, rows));
    scan.cells = columns * rows;
    if (scan.cells > 0) scan.values = width_at(scan.first);
    return scan;
  }

  template <std::size_t kCount>
  std::array<double, kCount> numbers_at(std::int64_t row) {
    const Line line = cursor_.line_of(row);
    Values values(source_, line);
    std::array<double, kCount> numbers{};
    for (double& number : numbers) {
      number = values.number();
      if (!(std::abs(number) <= kLargestCoordinate))
        fail_at_line(source_, "the header of a scan has a number that is not finite", line.number, kAgain);
    }
    values.expect_end();
    return numbers;
  }

  Vec3d vector_at(std::int64_t row) {
    const std::array<double, 3> v = numbers_at<3>(row);
    return {v[0], v[1], v[2]};
  }

  std::int64_t count_at(std::int64_t row) {
    const Line line = cursor_.line_of(row);
    Values values(source_, line);
    const std::int64_t count = values.whole();
    values.expect_end();
    if (count < 0) fail_at_line(source_, "a scan has a negative number of columns or rows", line.number, kAgain);
    return count;
  }

  void check_affine(const PtxScan& scan, std::int64_t row) {
    const Matrix& m = scan.matrix;
    if (m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1) return;
    fail(source_, fmt::format("the matrix of the scan in row {} does not end in 0, 0, 0 and 1", row + 1), kAgain);
  }

  std::size_t width_at(std::int64_t row) {
    const Line line = cursor_.line_of(row);
    Values values(source_, line);
    std::size_t count = 0;
    for (; !values.at_end(); ++count) values.number();
    if (count != 3 && count != 4 && count != 7)
      fail_at_line(source_, fmt::format("a point has {} values", count), line.number,
                   "write x, y, z, then the intensity, then red, green and blue");
    return count;
  }

  [[noreturn]] void fail_short(const std::string& what) const {
    fail(source_, fmt::format("is truncated, {} are promised, but the file ends before", what), kAgain);
  }

  const Source& source_;
  const LineIndex& index_;
  RowCursor cursor_;
};

/// The cells of all scans as columns; the first three are x, y and z.
class PtxPoints {
 public:
  PtxPoints(const Source& source, const std::vector<PtxScan>& scans) : source_(source), scans_(scans) {
    for (const char* axis : {"x", "y", "z"}) columns_.add(axis, AttributeType::float64);
    if (has_any(&PtxScan::has_intensity)) add("intensity", AttributeType::float32, intensity_);
    if (has_any(&PtxScan::has_colour)) {
      add("red", AttributeType::uint8, colour_);
      for (const char* name : {"green", "blue"}) columns_.add(name, AttributeType::uint8);
    }
    std::int64_t rows = 0;
    for (const PtxScan& scan : scans) {
      starts_.push_back(rows);
      rows += scan.cells;
    }
    constexpr std::size_t kSmall = std::size_t{1} << 20;
    if (!fits(static_cast<std::uint64_t>(rows), 6, std::max(kSmall, source.bytes.size() + 1)))
      fail(source, "most lines have fewer values than a point", kAgain);
    columns_.allocate(rows);
  }

  void read(exec::Cpu& ex, const LineIndex& index) {
    for_each_row(ex, index, 0, index.rows, [&](const Line& line, std::size_t) {
      const auto next = std::upper_bound(scans_.begin(), scans_.end(), line.row,
                                         [](std::int64_t row, const PtxScan& scan) { return row < scan.first; });
      if (next == scans_.begin()) return;
      const auto s = static_cast<std::size_t>(next - scans_.begin()) - 1;
      const std::int64_t cell = line.row - scans_[s].first;
      if (cell < scans_[s].cells) read_cell(scans_[s], line, starts_[s] + cell);
    });
  }

  [[nodiscard]] PointTable table() const { return columns_.table(); }

  [[nodiscard]] std::vector<Scan> scans() const {
    std::vector<Scan> all;
    for (const PtxScan& scan : scans_) {
      Scan& out = all.emplace_back(Scan{scan.cells, scan.sensor, {}});
      if (intensity_ && !scan.has_intensity()) out.lacking = {"intensity"};
      if (colour_ && !scan.has_colour()) out.lacking.insert(out.lacking.end(), {"red", "green", "blue"});
    }
    return all;
  }

 private:
  [[nodiscard]] bool has_any(bool (PtxScan::*has)() const) const {
    return std::any_of(scans_.begin(), scans_.end(), [&](const PtxScan& scan) { return (scan.*has)(); });
  }

  void add(const char* name, AttributeType type, std::optional<std::size_t>& place) {
    place = columns_.size();
    columns_.add(name, type);
  }

  void read_cell(const PtxScan& scan, const Line& line, std::int64_t row) {
    Values values(source_, line);
    Vec3d p{};
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = values.number();
    // A direction from which nothing came back.
    const bool is_empty = p == Vec3d{};
    const Vec3d world = scan.to_world(p);
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    constexpr double kBad = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis)
      columns_.set(axis, row, is_empty ? kNone : std::isnan(world[axis]) ? kBad : world[axis]);
    if (scan.has_intensity()) columns_.set(*intensity_, row, values.number());
    if (scan.has_colour())
      for (std::size_t c = 0; c < 3; ++c) columns_.set(*colour_ + c, row, colour(values, line));
    values.expect_end();
  }

  double colour(Values& values, const Line& line) const {
    const std::int64_t value = values.whole();
    if (value < 0 || value > 255)
      fail_at_line(source_, fmt::format("the colour {} is not in 0 to 255", value), line.number, kAgain);
    return static_cast<double>(value);
  }

  const Source& source_;
  const std::vector<PtxScan>& scans_;
  std::vector<std::int64_t> starts_;  ///< the row of the table at which each scan begins
  ParsedColumns columns_;
  std::optional<std::size_t> intensity_, colour_;
};

}  // namespace

Cloud parse_ptx(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const Source text{source.name, without_byte_order_mark(source.bytes)};
  const LineIndex index = index_lines(ex, text.bytes);
  const std::vector<PtxScan> scans = ScanFinder(text, index).find();
  PtxPoints points(text, scans);
  points.read(ex, index);
  return assemble_scans(ex, text, points.table(), points.scans(), options.shift);
}

}  // namespace pointskin::io
