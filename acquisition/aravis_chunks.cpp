// SPDX-License-Identifier: MIT
// Chunk values by Aravis' parser, which works on a copy of the camera's description of its own.
#include "acquisition/aravis_chunks.hpp"

#include <arv.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace rptv {

AravisChunks::Chunk::Chunk(const std::string& n, Kind k)
    : name(n), feature("Chunk" + n), kind(k), value(std::numeric_limits<double>::quiet_NaN()) {}

AravisChunks::AravisChunks(ArvCamera* camera, const std::string& camera_name, const std::vector<std::string>& names) {
  if (names.empty()) return;
  parser_.reset(arv_camera_create_chunk_parser(camera));
  for (const std::string& name : names) {
    ArvGcNode* node = arv_device_get_feature(arv_camera_get_device(camera), ("Chunk" + name).c_str());
    if (!ARV_IS_GC_BOOLEAN(node) && !ARV_IS_GC_FLOAT(node) && !ARV_IS_GC_INTEGER(node))
      throw Error(ExitCode::configuration, "camera " + camera_name + " describes no number Chunk" + name + "; take '" +
                                               name + "' out of aravis.chunks");
    const Kind kind = ARV_IS_GC_BOOLEAN(node) ? Kind::truth : ARV_IS_GC_FLOAT(node) ? Kind::real : Kind::integer;
    chunks_.push_back(std::make_unique<Chunk>(name, kind));
  }
}

double AravisChunks::value_of(const Chunk& chunk, ArvBuffer* buffer) const noexcept {
  ArvFailure failure;
  double value = 0;
  const char* feature = chunk.feature.c_str();
  if (chunk.kind == Kind::real) value = arv_chunk_parser_get_float_value(parser_.get(), buffer, feature, failure.out());
  if (chunk.kind == Kind::integer)
    value = static_cast<double>(arv_chunk_parser_get_integer_value(parser_.get(), buffer, feature, failure.out()));
  if (chunk.kind == Kind::truth)
    value = arv_chunk_parser_get_boolean_value(parser_.get(), buffer, feature, failure.out()) ? 1 : 0;
  return failure ? std::numeric_limits<double>::quiet_NaN() : value;
}

void AravisChunks::read(ArvBuffer* buffer, std::uint64_t index) noexcept {
  asked_.store(false, std::memory_order_relaxed);
  const bool has_any = arv_buffer_has_chunks(buffer);
  writes_.fetch_add(1);
  for (const auto& chunk : chunks_)
    chunk->value.store(has_any ? value_of(*chunk, buffer) : std::numeric_limits<double>::quiet_NaN());
  frame_.store(index);
  writes_.fetch_add(1);
}

DeviceReadings AravisChunks::latest() const {
  for (;;) {
    const std::uint64_t before = writes_.load();
    DeviceReadings all{frame_.load(), {}};
    for (const auto& chunk : chunks_)
      if (const double value = chunk->value.load(); !std::isnan(value)) all.values.push_back({chunk->name, value});
    if (before % 2 == 0 && writes_.load() == before) return all;
  }
}

}  // namespace rptv
