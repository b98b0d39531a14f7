// SPDX-License-Identifier: MIT
// How a GigE Vision stream receives its packets, and what the kernel granted it; for the aravis_*.cpp files only.
#pragma once

#include <string>
#include <vector>

#include "acquisition/aravis_handle.hpp"
#include "acquisition/aravis_settings.hpp"

namespace rptv {

/// Which socket the next stream of the camera uses, and whether it asks for lost packets again. Before
/// arv_camera_create_stream().
void choose_socket(ArvCamera* camera, const AravisSettings& settings);

/// Sets buffer and resend of a new stream; returns what came of it, for DeviceStatus::link: ", packet socket, resend
/// on". Empty for other buses. Before the acquisition starts; takes a look at every open file, so not per frame.
std::string tune_stream(ArvCamera* camera, ArvStream* stream, const AravisSettings& settings);

/// The packet sockets that this process has open. Looks at every open file, so not per frame.
std::vector<int> packet_sockets();

/// A packet socket whose link went down stays in error, and Aravis' receiving thread would spin on it for ever. Clears
/// the errors of those of `descriptors` that still are packet sockets. From time to time; any thread but a real-time
/// one.
void clear_errors(const std::vector<int>& descriptors) noexcept;

}  // namespace rptv
