#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Receives 1920 x 1200 Mono8 from one GigE Vision simulator, in turn with rapidptv's source and with arv-camera-test.

usage: compare_cameras.py BUILD [RATE_HZ...]    as root; BUILD: a build folder of preset release; rates: default 50 100

Needs Debian's aravis-tools. Runs in a network of its own. CPU per frame is that of the whole client process while it streams, as
the kernel's scheduler counts it: median and least of the rounds, since whatever else runs can only add. The load is printed.
"""
import fcntl
import os
import re
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

RUN_S, WARM_S, WINDOW_S, ROUNDS, PACKET = 9, 2, 6, 5, 9000


def set_loopback_up():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, 0x8914, struct.pack("16sh14x", b"lo", 0x1 | 0x40))  # SIOCSIFFLAGS: up, running


def cpu_s(pid):
    """Seconds on a processor of all threads that live."""
    return sum(int((task / "schedstat").read_text().split()[0]) for task in Path(f"/proc/{pid}/task").iterdir()) * 1e-9


def let_run(process, seconds):
    """Waits until the client ends, which it must not do within `seconds`."""
    try:
        status = process.wait(timeout=seconds)
    except subprocess.TimeoutExpired:
        return
    sys.exit(f"{process.args[0]} ended with {status} while it should have streamed; see its output by running it alone")


def run(command, frames_of):
    """(frames per second, CPU microseconds per frame, what it said)"""
    with tempfile.TemporaryFile("w+") as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT)
        let_run(process, WARM_S)
        started, used = time.monotonic(), cpu_s(process.pid)
        let_run(process, WINDOW_S)
        share = (cpu_s(process.pid) - used) / (time.monotonic() - started)
        status = process.wait(timeout=60)
        out.seek(0)
        text = out.read()
    if status != 0:
        sys.exit(f"{command[0]} ended with {status}:\n{text}")
    fps = float(re.search(frames_of, text)[1]) / RUN_S
    return fps, 1e6 * share / fps, text


def ours(build, rate):
    return run([build / "tests/bench/rptv_bench_camera", "127.0.0.1", str(rate), str(RUN_S), str(PACKET)], r"frames (\d+)")


def theirs(_, rate):
    return run(["arv-camera-test-0.8", "-n", "127.0.0.1", "-w", "1920", "-h", "1200", "-f", str(rate), "-i", str(PACKET),
                f"--duration={RUN_S}"], r"n_completed_buffers\s*=\s*(\d+)")


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    if os.environ.get("RPTV_OWN_NETWORK") is None:
        os.environ["RPTV_OWN_NETWORK"] = "yes"
        os.execvp("unshare", ["unshare", "-n", sys.executable, *sys.argv])
    set_loopback_up()
    build, rates = Path(sys.argv[1]).resolve(), [float(rate) for rate in sys.argv[2:]] or [50, 100]
    simulator = subprocess.Popen(["arv-fake-gv-camera-0.8", "-i", "127.0.0.1"], stdout=subprocess.DEVNULL)
    try:
        print("client, asked fps: got fps; CPU us/frame median, least; load")
        for rate in rates:
            rounds = [(ours(build, rate), theirs(build, rate)) for _ in range(ROUNDS)]
            for who, name in enumerate(("rapidptv", "arv-camera-test")):
                fps, cpu = ([r[who][what] for r in rounds] for what in (0, 1))
                print(f"{name:15}, {rate:3.0f}: {statistics.median(fps):5.1f}; {statistics.median(cpu):4.0f}, {min(cpu):4.0f}; "
                      f"{os.getloadavg()[0]:.1f}")
            print("  rapidptv's last: " + rounds[-1][0][2].strip().replace("\n", "\n  "), flush=True)
    finally:
        simulator.terminate()
        simulator.wait()


if __name__ == "__main__":
    main()
