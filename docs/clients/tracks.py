# SPDX-License-Identifier: MIT
"""Live 3D tracks as numpy arrays: `for frame, t, tracks in live_tracks(endpoint): tracks["x"]` (mm, mm/s)."""
import sys

import numpy as np
import zmq
from rapidptv_pb2 import Envelope  # protoc --python_out=. rapidptv.proto

COLUMNS = {"id": "<u8", "x": "<f4", "y": "<f4", "z": "<f4", "vx": "<f4", "vy": "<f4", "vz": "<f4",
           "residual": "<f4", "age": "<u4"}


def live_tracks(endpoint):
    """Yields (frame, exposure end in s, dict of arrays of equal length) for every frame from now on."""
    socket = zmq.Context.instance().socket(zmq.SUB)
    socket.subscribe(b"tracks")
    socket.connect(endpoint)
    expected = None
    while True:
        message = Envelope.FromString(socket.recv_multipart()[1])
        if expected is not None and message.sequence > expected:
            print(f"{message.sequence - expected} frames lost: this client is too slow", file=sys.stderr)
        expected = message.sequence + 1
        columns = {name: np.frombuffer(getattr(message.tracks, name), dtype) for name, dtype in COLUMNS.items()}
        yield message.frame, message.exposure_end_ns * 1e-9, columns


if __name__ == "__main__":
    for frame, t, tracks in live_tracks(sys.argv[1] if len(sys.argv) > 1 else "ipc:///run/rapidptv/tracks.sock"):
        print(f"frame {frame}  t {t:.6f} s  {len(tracks['id'])} tracks", flush=True)
