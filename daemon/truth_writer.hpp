// SPDX-License-Identifier: MIT
// Writes the truth of a simulated run in the order of its frames, whichever thread has rendered them.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "core/csv.hpp"
#include "simulation/optics.hpp"
#include "simulation/render_light_field.hpp"

namespace rptv {

/// One particle in one frame. Image positions: image space, mm; not a number when no light comes through.
struct TruthRecord {
  TruthRow row;
  Vector3 image;          ///< paraxial, eq. (8), (9) or (11)
  Vector3 real;           ///< where the real rays converge
  double photoelectrons;  ///< expected, through the lens
};

/// truth.csv: a tracks table with in_view, image_x … real_z, photoelectrons behind it. deliver() from any thread.
class TruthWriter {
 public:
  explicit TruthWriter(const std::filesystem::path& file);

  /// All particles of one frame; every frame from 0 on must come once.
  void deliver(std::uint64_t frame, std::vector<TruthRecord> records);
  /// Throws Error(io) when something could not be written.
  void close();
  std::uint64_t lit() const noexcept { return lit_; }
  std::uint64_t in_view() const noexcept { return in_view_; }

 private:
  void write(const TruthRecord& record);
  std::mutex access_;
  CsvWriter csv_;
  std::uint64_t next_ = 0, lit_ = 0, in_view_ = 0;
  std::map<std::uint64_t, std::vector<TruthRecord>> waiting_;  ///< as many as there are threads
};

/// The records of the frame that `renderer` has just rendered from `tracers`.
std::vector<TruthRecord> truth_records(const LightFieldRenderer& renderer, std::span<const Tracer> tracers,
                                       std::uint64_t frame, double time_s);

/// volume_truth.csv: a grid of points over the lit volume and where their real rays converge, columns
/// image_x,image_y,image_z,object_x,object_y,object_z, mm. Points whose light does not come through are left out.
void write_volume_truth(const std::filesystem::path& file, const ScenarioSettings& scenario,
                        const LightFieldOptics& optics);

}  // namespace rptv
