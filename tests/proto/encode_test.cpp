// SPDX-License-Identifier: MIT
// What is encoded is decoded again, without allocation, and damaged messages are refused with a reason.
#include "proto/encode.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <limits>

#include "tests/proto/count_allocations.hpp"
#include "tests/proto/made_result.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<float> as_floats(const std::vector<double>& values) {
  std::vector<float> floats;
  for (const double value : values) floats.push_back(static_cast<float>(value));
  return floats;
}

std::vector<std::byte> copy_of(std::span<const std::byte> bytes) { return {bytes.begin(), bytes.end()}; }

void expect_round_trip_of_tracks(Encoder& encoder, const Result& result) {
  Stamps stamps = result.stamps;
  WireMessage message;
  RC_ASSERT(decode(encoder.tracks(result, stamps), message) == "");
  const auto& tracks = std::get<TracksColumns>(message.content);
  RC_ASSERT(tracks.id == result.tracks.particle);
  RC_ASSERT(tracks.x_mm == as_floats(result.tracks.x_mm));
  RC_ASSERT(tracks.y_mm == as_floats(result.tracks.y_mm));
  RC_ASSERT(tracks.z_mm == as_floats(result.tracks.z_mm));
  RC_ASSERT(tracks.vx_mm_s == as_floats(result.tracks.vx_mm_s));
  RC_ASSERT(tracks.vy_mm_s == as_floats(result.tracks.vy_mm_s));
  RC_ASSERT(tracks.vz_mm_s == as_floats(result.tracks.vz_mm_s));
  RC_ASSERT(tracks.residual_mm == as_floats(result.tracks.residual_mm));
  RC_ASSERT(tracks.age_frames == result.tracks.age_frames);
  RC_ASSERT(message.births == result.tracks.births);
  RC_ASSERT(message.deaths == result.tracks.deaths);
  RC_ASSERT(message.frame == result.frame);
  RC_ASSERT(message.exposure_end_ns == result.exposure_end_ns);
  RC_ASSERT(message.clock == result.clock);
  RC_ASSERT(message.stamps.at_ns == stamps.at_ns);
}

TEST(Encoder, gives_back_what_a_filter_knows_and_what_the_linker_cut) {
  Result result(5, 5);
  fill_result(result, 1, 5, 1, 7, true);
  result.tracks.adapted_subnets = 3;
  result.tracks.cut_subnets = 2;
  Encoder encoder("session", 5, 5);
  WireMessage message;
  ASSERT_EQ(decode(encoder.tracks(result, result.stamps), message), "");
  const auto& tracks = std::get<TracksColumns>(message.content);
  ASSERT_EQ(tracks.acceleration_mm_s2.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const TrackEstimate& e = result.tracks.estimate[i];
    EXPECT_EQ(tracks.acceleration_mm_s2[i][1], static_cast<float>(e.ay_mm_s2));
    for (std::size_t k = 0; k < 6; ++k) {
      EXPECT_EQ(tracks.position_covariance_mm2[i][k], static_cast<float>(e.position_mm2[k]));
      EXPECT_EQ(tracks.velocity_covariance_mm2_s2[i][k], static_cast<float>(e.velocity_mm2_s2[k]));
      EXPECT_EQ(tracks.acceleration_covariance_mm2_s4[i][k], static_cast<float>(e.acceleration_mm2_s4[k]));
    }
  }
  EXPECT_EQ(tracks.adapted_subnets, 3U);
  EXPECT_EQ(tracks.cut_subnets, 2U);
  fill_result(result, 2, 5);
  ASSERT_EQ(decode(encoder.tracks(result, result.stamps), message), "");
  EXPECT_TRUE(std::get<TracksColumns>(message.content).acceleration_mm_s2.empty());
}

TEST(Encoder, gives_back_any_tracks) {
  Encoder encoder("session", 64, 64);
  Result result(64, 64);
  EXPECT_TRUE(rc::check("tracks survive the wire", [&] {
    const auto count = *rc::gen::inRange<std::size_t>(0, 65);
    fill_result(result, *rc::gen::arbitrary<std::uint32_t>(), count, *rc::gen::arbitrary<std::uint64_t>(),
                *rc::gen::arbitrary<unsigned>());
    result.exposure_end_ns = *rc::gen::arbitrary<std::int64_t>();
    result.clock = static_cast<ClockId>(*rc::gen::inRange(0, 5));
    for (const auto id : *rc::gen::container<std::vector<std::uint64_t>>(rc::gen::arbitrary<std::uint64_t>()))
      result.tracks.push_death(id);
    expect_round_trip_of_tracks(encoder, result);
  }));
}

TEST(Encoder, gives_back_particles_with_covariances) {
  Encoder encoder("session", 100, 100);
  Result result(100, 100);
  fill_result(result, 7, 41);
  Stamps stamps = result.stamps;
  WireMessage message;
  ASSERT_EQ(decode(encoder.particles(result, stamps), message), "");
  const auto& particles = std::get<ParticlesColumns>(message.content);
  EXPECT_EQ(particles.x_mm, as_floats(result.particles.x_mm));
  EXPECT_EQ(particles.y_mm, as_floats(result.particles.y_mm));
  EXPECT_EQ(particles.z_mm, as_floats(result.particles.z_mm));
  EXPECT_EQ(particles.residual_mm, as_floats(result.particles.residual_mm));
  EXPECT_EQ(particles.support, as_floats(result.particles.support));
  EXPECT_EQ(particles.ghost, as_floats(result.particles.ghost));
  ASSERT_EQ(particles.covariance_mm2.size(), 41U);
  for (std::size_t i = 0; i < 41; ++i)
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_EQ(particles.covariance_mm2[i][k], static_cast<float>(result.particles.covariance_mm2[i][k]));
}

TEST(Encoder, allocates_nothing_per_frame_at_any_size_up_to_the_capacity) {
  constexpr std::size_t kCapacity = 5000;
  Encoder encoder("session", kCapacity, kCapacity);
  Result result(kCapacity, kCapacity);
  std::size_t bytes = 0;
  std::uint64_t counted = 0;
  for (const std::size_t size : {0U, 17U, 5000U, 1U, 4999U, 5000U}) {
    fill_result(result, 1, size);
    for (std::size_t i = 0; i < size; ++i) result.tracks.push_death(i);
    Stamps stamps = result.stamps;
    const std::uint64_t before = allocations_so_far();
    bytes += encoder.tracks(result, stamps).size();
    bytes += encoder.particles(result, stamps).size();
    counted += allocations_so_far() - before;
  }
  EXPECT_EQ(counted, 0U);
  EXPECT_GT(bytes, 3 * kCapacity * 40);
}

TEST(Encoder, stamps_publication_after_the_other_stages_and_leaves_the_result_alone) {
  Encoder encoder("session", 8, 8);
  Result result(8, 8);
  fill_result(result, 1, 3);
  Stamps stamps = result.stamps;
  encoder.tracks(result, stamps);
  EXPECT_GE(stamps[Stage::published], stamps[Stage::linked]);
  EXPECT_EQ(result.stamps[Stage::published], 0);
}

TEST(Encoder, counts_each_topic_by_itself) {
  Encoder encoder("abc", 8, 8);
  Result result(8, 8);
  fill_result(result, 1, 3);
  Stamps stamps = result.stamps;
  WireMessage message;
  for (std::uint64_t i = 0; i < 3; ++i) {
    ASSERT_EQ(decode(encoder.tracks(result, stamps), message), "");
    EXPECT_EQ(message.sequence, i);
  }
  ASSERT_EQ(decode(encoder.particles(result, stamps), message), "");
  EXPECT_EQ(message.sequence, 0U);
  EXPECT_EQ(message.session, "abc");
  EXPECT_EQ(message.boot_id, read_boot_id());
}

TEST(Encoder, gives_back_texts_longer_than_its_first_buffer) {
  Encoder encoder("s", 1, 1);
  const std::string calibration(100'000, 'c');
  WireMessage message;
  ASSERT_EQ(decode(encoder.rig(calibration, "config"), message), "");
  EXPECT_EQ(std::get<RigTexts>(message.content).calibration, calibration);
  EXPECT_EQ(std::get<RigTexts>(message.content).config, "config");
}

TEST(Decoder, refuses_every_cut_of_a_message) {
  Encoder encoder("session", 8, 8);
  Result result(8, 8);
  fill_result(result, 1, 3);
  Stamps stamps = result.stamps;
  const auto bytes = copy_of(encoder.tracks(result, stamps));
  WireMessage message;
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(decode(std::span(bytes).first(size), message), "") << size << " of " << bytes.size() << " bytes";
}

TEST(Decoder, names_a_newer_schema_and_the_next_step) {
  Encoder encoder("session", 8, 8);
  auto bytes = copy_of(encoder.status(StatusReport{}));
  ASSERT_EQ(bytes[0], std::byte{0x08});  // field 1, varint: schema
  bytes[1] = std::byte{2};
  WireMessage message;
  EXPECT_THAT(decode(bytes, message), ::testing::AllOf(HasSubstr("schema 2"), HasSubstr("update")));
}

TEST(Decoder, refuses_stamps_whose_differences_would_overflow) {
  Encoder encoder("session", 8, 8);
  Result result(8, 8);
  fill_result(result, 1, 3);
  Stamps stamps = result.stamps;
  stamps[Stage::exposure_end] = std::numeric_limits<std::int64_t>::min();
  WireMessage message;
  EXPECT_THAT(decode(encoder.tracks(result, stamps), message), HasSubstr("negative"));
}

TEST(Decoder, refuses_what_somebody_else_publishes) {
  const std::string text = "hello";
  WireMessage message;
  EXPECT_THAT(decode(std::as_bytes(std::span(text)), message), HasSubstr("another program"));
}

}  // namespace
}  // namespace rptv
