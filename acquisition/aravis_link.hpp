// SPDX-License-Identifier: MIT
// How a GigE Vision stream receives its packets, and what the kernel granted it; for the aravis_*.cpp files only.
#pragma once

#include <string>

#include "acquisition/aravis_handle.hpp"
#include "acquisition/aravis_settings.hpp"

namespace rptv {

/// Which socket the next stream of the camera uses, and whether it asks for lost packets again. Before
/// arv_camera_create_stream().
void choose_socket(ArvCamera* camera, const AravisSettings& settings);

/// Sets buffer and resend of a new stream; returns what came of it, for DeviceStatus::link: ", packet socket, resend
/// on". Empty for other buses. Before the acquisition starts; takes a look at every open file, so not per frame.
std::string tune_stream(ArvCamera* camera, ArvStream* stream, const AravisSettings& settings);

/// A packet socket whose link went down stays in error, and Aravis' receiving thread would spin on it for ever. Clears
/// the errors of this process's packet sockets. From time to time; any thread but a real-time one.
void clear_packet_socket_errors() noexcept;

}  // namespace rptv
