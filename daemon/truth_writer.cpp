// SPDX-License-Identifier: MIT
// Truth rows of frames, and the grid of corresponding points.
#include "daemon/truth_writer.hpp"

#include <limits>
#include <utility>

namespace rptv {

namespace {
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kGridSteps = 10;  // per axis: 11 points

void put(CsvWriter& csv, const Vector3& point) { csv.number(point.x).number(point.y).number(point.z); }
}  // namespace

TruthWriter::TruthWriter(const std::filesystem::path& file)
    : csv_(file,
           "frame,particle,x,y,z,vx,vy,vz,residual,age,t,in_view,image_x,image_y,image_z,real_x,real_y,real_z,"
           "photoelectrons") {}

void TruthWriter::write(const TruthRecord& record) {
  const TruthRow& row = record.row;
  csv_.index(row.frame).index(row.particle);
  for (const double value : {row.x_mm, row.y_mm, row.z_mm, row.vx_mm_s, row.vy_mm_s, row.vz_mm_s, row.residual_mm})
    csv_.number(value);
  csv_.index(row.age).number(row.t_s).index(row.in_view);
  put(csv_, record.image);
  put(csv_, record.real);
  csv_.number(record.photoelectrons).end_row();
  ++lit_;
  in_view_ += row.in_view;
}

void TruthWriter::deliver(std::uint64_t frame, std::vector<TruthRecord> records) {
  const std::lock_guard lock(access_);
  waiting_.emplace(frame, std::move(records));
  for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_; first = waiting_.begin()) {
    for (const TruthRecord& record : first->second) write(record);
    waiting_.erase(first);
    ++next_;
  }
}

void TruthWriter::close() { csv_.close(); }

std::vector<TruthRecord> truth_records(const LightFieldRenderer& renderer, std::span<const Tracer> tracers,
                                       std::uint64_t frame, double time_s) {
  std::vector<TruthRecord> records;
  records.reserve(tracers.size());
  for (std::size_t i = 0; i < tracers.size(); ++i) {
    TruthRecord record{truth_row(tracers[i], frame, time_s), renderer.optics().image_of(tracers[i].position),
                       renderer.optics().convergence(tracers[i].position).value_or(Vector3{kNone, kNone, kNone}),
                       renderer.lights()[i].photoelectrons};
    record.row.in_view = renderer.lights()[i].in_view;
    records.push_back(record);
  }
  return records;
}

void write_volume_truth(const std::filesystem::path& file, const ScenarioSettings& scenario,
                        const LightFieldOptics& optics) {
  CsvWriter csv(file, "image_x,image_y,image_z,object_x,object_y,object_z");
  const auto at = [](int step, double half) { return half * (2.0 * step / kGridSteps - 1); };
  for (int k = 0; k <= kGridSteps; ++k)
    for (int j = 0; j <= kGridSteps; ++j)
      for (int i = 0; i <= kGridSteps; ++i) {
        const Vector3 object{at(i, 0.5 * scenario.seeding.volume_x_mm), at(j, 0.5 * scenario.seeding.volume_y_mm),
                             at(k, half_depth_mm(scenario))};
        const auto image = optics.convergence(object);
        if (!image) continue;
        put(csv, *image);
        put(csv, object);
        csv.end_row();
      }
  csv.close();
}

}  // namespace rptv
