// SPDX-License-Identifier: MIT
// Joins images and times by frame index.
#include "replay/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/csv.hpp"
#include "core/error.hpp"
#include "replay/image_error.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

/// An image with its place in time.
struct Taken {
  std::uint64_t index = 0;
  std::int64_t time_ns = 0;
  std::size_t image = 0;
};
using TakenByCamera = std::vector<std::vector<Taken>>;

struct Row {
  std::uint64_t index = 0;
  std::int64_t time_ns = 0;
  std::string file;
};

struct Table {
  fs::path path;
  bool names_files = false;
  std::vector<Row> rows;
};

constexpr double kLatest_s = 9e9;  // 285 years in either direction: what 64 bits of ns can hold

Table read_table(const fs::path& path) {
  enum : std::size_t { kFrame, kTime, kFile };
  CsvReader csv(path, {{"frame"}, {"t"}, {"file", {}, false}});
  Table table{path, csv.has(kFile), {}};
  while (csv.next()) {
    const double t_s = csv.number(kTime);
    if (std::abs(t_s) > kLatest_s) csv.refuse("t is not a time in seconds; write seconds since any fixed instant");
    Row row{csv.index(kFrame), std::llround(t_s * 1e9), table.names_files ? std::string(csv.text(kFile)) : ""};
    if (!table.names_files && !table.rows.empty() &&
        (row.index <= table.rows.back().index || row.time_ns <= table.rows.back().time_ns))
      csv.refuse("frame and t must rise from row to row; sort the rows, or say with a column 'file' whose they are");
    table.rows.push_back(std::move(row));
  }
  return table;
}

Error misfit(const Table& table, const std::string& reason, std::string_view step) {
  return image_error(table.path, reason, step);
}

/// Rows to images by the column `file`; rows of images that are not played are passed over.
TakenByCamera join_by_file(const Table& table, const std::vector<ImageSequence>& cameras) {
  std::map<std::string, const Row*> rows;
  for (const Row& row : table.rows)
    if (!rows.emplace(row.file, &row).second)
      throw misfit(table, "names '" + row.file + "' twice", "keep one row per image");
  TakenByCamera taken(cameras.size());
  for (std::size_t c = 0; c < cameras.size(); ++c)
    for (std::size_t i = 0; i < cameras[c].size(); ++i) {
      const std::string name = cameras[c].file(i).lexically_relative(table.path.parent_path()).generic_string();
      const auto found = rows.find(name);
      if (found == rows.end())
        throw misfit(table, "has no row with file '" + name + "'",
                     "add it, or leave the image out with replay.pattern");
      taken[c].push_back({found->second->index, found->second->time_ns, i});
    }
  return taken;
}

std::set<std::uint64_t> numbers_of(const std::vector<ImageSequence>& cameras) {
  std::set<std::uint64_t> numbers;
  for (const ImageSequence& camera : cameras)
    for (std::size_t i = 0; i < camera.size(); ++i) numbers.insert(camera.number(i));
  return numbers;
}

/// Rows to images by frame number, else in order.
TakenByCamera join_by_number(const Table& table, const std::vector<ImageSequence>& cameras) {
  std::map<std::uint64_t, const Row*> rows;
  for (const Row& row : table.rows) rows.emplace(row.index, &row);
  const std::set<std::uint64_t> numbers = numbers_of(cameras);
  if (!std::all_of(numbers.begin(), numbers.end(), [&](std::uint64_t n) { return rows.count(n) != 0; })) {
    if (numbers.size() != table.rows.size())
      throw misfit(table,
                   "has " + std::to_string(table.rows.size()) + " rows for " + std::to_string(numbers.size()) +
                       " frames, and their numbers differ",
                   "write one row per frame, or add a column 'file'");
    rows.clear();
    auto row = table.rows.begin();
    for (const std::uint64_t number : numbers) rows.emplace(number, &*row++);
  }
  TakenByCamera taken(cameras.size());
  for (std::size_t c = 0; c < cameras.size(); ++c)
    for (std::size_t i = 0; i < cameras[c].size(); ++i) {
      const Row& row = *rows.at(cameras[c].number(i));
      taken[c].push_back({row.index, row.time_ns, i});
    }
  return taken;
}

TakenByCamera join(const Table& table, const std::vector<ImageSequence>& cameras) {
  TakenByCamera taken = table.names_files ? join_by_file(table, cameras) : join_by_number(table, cameras);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    std::sort(taken[c].begin(), taken[c].end(), [](const Taken& a, const Taken& b) { return a.index < b.index; });
    for (std::size_t i = 1; i < taken[c].size(); ++i)
      if (taken[c][i].index <= taken[c][i - 1].index || taken[c][i].time_ns <= taken[c][i - 1].time_ns)
        throw misfit(table,
                     "frame and t do not both rise from '" +
                         cameras[c].file(taken[c][i - 1].image).filename().string() + "' to '" +
                         cameras[c].file(taken[c][i].image).filename().string() + "'",
                     "correct these rows");
  }
  return taken;
}

/// frames.csv of all cameras together or one per camera's folder; nothing when there is none.
std::optional<TakenByCamera> from_tables(const fs::path& path, const std::vector<ImageSequence>& cameras) {
  const fs::path folder = fs::is_directory(path) ? path : path.parent_path();
  const fs::path shared = folder / "frames.csv";
  if (fs::exists(shared)) return join(read_table(shared), cameras);
  TakenByCamera taken;
  for (const ImageSequence& camera : cameras) {
    const fs::path own = camera.file(0).parent_path() / "frames.csv";
    if (!fs::exists(own) && taken.empty()) return std::nullopt;
    taken.push_back(std::move(join(read_table(own), {camera}).front()));
  }
  return taken;
}

TakenByCamera from_rate(const fs::path& path, const std::vector<ImageSequence>& cameras, double rate_hz) {
  if (!(rate_hz > 0))
    throw Error(ExitCode::configuration, path.string() +
                                             ": no frames.csv beside the images and replay.rate_hz is not set; state "
                                             "the frame rate, for instance replay.rate_hz = 100");
  const std::set<std::uint64_t> numbers = numbers_of(cameras);
  const std::uint64_t span = *numbers.rbegin() - *numbers.begin();
  if (span > 1000 * numbers.size())
    throw image_error(path,
                      "the numbers in the images' names (" + std::to_string(*numbers.begin()) + " ... " +
                          std::to_string(*numbers.rbegin()) + ") do not count frames",
                      "rename the images, or put a frames.csv with columns frame, t and file beside them");
  TakenByCamera taken(cameras.size());
  for (std::size_t c = 0; c < cameras.size(); ++c)
    for (std::size_t i = 0; i < cameras[c].size(); ++i) taken[c].push_back({cameras[c].number(i), 0, i});
  return taken;
}

std::int64_t nominal_ns(std::uint64_t index, double rate_hz) {
  return std::llround(static_cast<long double>(index) * 1e9L / static_cast<long double>(rate_hz));
}

/// Mean time from one index to the next; 0 when nobody knows.
double mean_period_ns(const TakenByCamera& taken, double rate_hz) {
  for (const auto& camera : taken)
    if (camera.size() > 1)
      return static_cast<double>(camera.back().time_ns - camera.front().time_ns) /
             static_cast<double>(camera.back().index - camera.front().index);
  return rate_hz > 0 ? 1e9 / rate_hz : 0;
}

/// Puts the shots of all cameras into their instants.
void arrange(const TakenByCamera& taken, Timeline& timeline) {
  std::set<std::uint64_t> indices;
  for (const auto& camera : taken)
    for (const Taken& shot : camera) indices.insert(shot.index);
  timeline.index.assign(indices.begin(), indices.end());
  for (const auto& camera : taken) {
    std::vector<Shot>& shots = timeline.shots.emplace_back(timeline.index.size());
    for (const Taken& shot : camera) {
      const auto at = std::lower_bound(timeline.index.begin(), timeline.index.end(), shot.index);
      shots[static_cast<std::size_t>(at - timeline.index.begin())] = {shot.image, shot.time_ns};
    }
  }
}

}  // namespace

Timeline make_timeline(const fs::path& path, const std::vector<ImageSequence>& cameras, double rate_hz,
                       std::int64_t first_index) {
  Timeline timeline;
  auto taken = from_tables(path, cameras);
  const bool nominal = !taken.has_value();
  if (nominal) taken = from_rate(path, cameras, rate_hz);
  timeline.clock = nominal ? ClockId::nominal : ClockId::recording;
  const double period_ns = nominal ? 1e9 / rate_hz : mean_period_ns(*taken, rate_hz);
  timeline.period_ns = std::llround(period_ns);
  arrange(*taken, timeline);

  timeline.loop_indices = timeline.index.back() - timeline.index.front() + 1;
  timeline.loop_ns = std::llround(period_ns * static_cast<double>(timeline.loop_indices));
  if (first_index >= 0) {
    const std::uint64_t first = timeline.index.front();
    for (std::uint64_t& index : timeline.index) index = index - first + static_cast<std::uint64_t>(first_index);
  }
  if (nominal)
    for (auto& camera : timeline.shots)
      for (std::size_t i = 0; i < camera.size(); ++i) camera[i].time_ns = nominal_ns(timeline.index[i], rate_hz);
  return timeline;
}

}  // namespace rptv
