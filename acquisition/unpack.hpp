// SPDX-License-Identifier: MIT
// Turns the packed pixels of camera protocols into 16-bit grey values.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/instruction_set.hpp"

namespace rptv {

// Each reads exactly the bytes that `pixels` need, writes exactly `pixels` values in 0 … 2^bits − 1, takes any
// alignment, allocates nothing and may run on any thread. `in` and `out` must not overlap. A row begins on a byte: call
// per row where rows are padded. `set` must not exceed best_instruction_set(); every set gives the same values.

constexpr std::size_t bytes_of_mono12p(std::size_t pixels) noexcept { return (pixels * 12 + 7) / 8; }
constexpr std::size_t bytes_of_mono10p(std::size_t pixels) noexcept { return (pixels * 10 + 7) / 8; }
/// Mono12Packed and Mono10Packed alike.
constexpr std::size_t bytes_of_packed(std::size_t pixels) noexcept { return (pixels * 3 + 1) / 2; }
/// Low bits come last in a group, so a group counts whole.
constexpr std::size_t bytes_of_mipi10(std::size_t pixels) noexcept { return (pixels + 3) / 4 * 5; }
constexpr std::size_t bytes_of_mipi12(std::size_t pixels) noexcept { return (pixels + 1) / 2 * 3; }

/// PFNC Mono12p: a little-endian stream of bits, 2 pixels in 3 bytes.
void unpack_mono12p(const std::byte* in, std::uint16_t* out, std::size_t pixels,
                    InstructionSet set = best_instruction_set()) noexcept;
/// PFNC Mono10p: a little-endian stream of bits, 4 pixels in 5 bytes.
void unpack_mono10p(const std::byte* in, std::uint16_t* out, std::size_t pixels,
                    InstructionSet set = best_instruction_set()) noexcept;
/// GigE Vision Mono12Packed: high byte, both low nibbles (the first pixel's below), high byte.
void unpack_mono12_packed(const std::byte* in, std::uint16_t* out, std::size_t pixels,
                          InstructionSet set = best_instruction_set()) noexcept;
/// GigE Vision Mono10Packed: high byte, low bits at 0 and at 4, high byte.
void unpack_mono10_packed(const std::byte* in, std::uint16_t* out, std::size_t pixels,
                          InstructionSet set = best_instruction_set()) noexcept;
/// MIPI RAW10, V4L2's Y10P: four high bytes, then their low bits in one.
void unpack_mipi10(const std::byte* in, std::uint16_t* out, std::size_t pixels,
                   InstructionSet set = best_instruction_set()) noexcept;
/// MIPI RAW12, V4L2's Y12P: two high bytes, then their low nibbles in one.
void unpack_mipi12(const std::byte* in, std::uint16_t* out, std::size_t pixels,
                   InstructionSet set = best_instruction_set()) noexcept;

/// The Y of YUYV, 8 bit. Reads 2 · pixels − 1 bytes.
void extract_yuyv_luma(const std::byte* in, std::uint8_t* out, std::size_t pixels) noexcept;

}  // namespace rptv
