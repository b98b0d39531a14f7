#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what `rapidptv demo` measured: tracks in 3D, and the flow above the oscillating wall against theory.

usage: plot_demo.py FOLDER [--output FILE.png]

FOLDER holds tracks.csv and profile.csv (measured) and scenario.toml and truth.csv (simulated). Units: mm, s, mm/s.
"""
import argparse
import sys
import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Line3DCollection

INK, GREY, MEASURED, THEORY = "#1b1f24", "#8b949e", "#c2410c", "#1f4e8c"
LONGEST_TRACKS = 160  # drawn in 3D: more would hide each other

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9.5, "axes.edgecolor": GREY, "axes.labelcolor": INK, "axes.linewidth": 0.8,
    "axes.spines.top": False, "axes.spines.right": False, "axes.titlesize": 10.5, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "xtick.color": INK, "ytick.color": INK, "xtick.direction": "out", "grid.color": "#e6e8eb",
    "legend.frameon": False, "text.color": INK,
})


def read_table(file):
    """A CSV file as a numpy record array with the header's names."""
    try:
        table = np.atleast_1d(np.genfromtxt(file, delimiter=",", names=True))
    except (OSError, ValueError) as error:
        sys.exit(f"plot_demo.py: {file}: {error}; run `rapidptv demo` first")
    if table.size == 0:
        sys.exit(f"plot_demo.py: {file}: no rows; run `rapidptv demo` again")
    return table


def draw_tracks(axes, tracks, colours):
    """The longest tracks as lines coloured by speed; x and z in the horizontal plane, the height y upwards."""
    order = np.lexsort((tracks["frame"], tracks["particle"]))
    rows = np.split(tracks[order], np.flatnonzero(np.diff(tracks["particle"][order])) + 1)
    rows = sorted(rows, key=len, reverse=True)[:LONGEST_TRACKS]
    for track in rows:
        if len(track) < 3:
            continue
        points = np.column_stack([track["x"], track["z"], track["y"]])
        segments = np.stack([points[:-1], points[1:]], axis=1)
        speed = np.linalg.norm([track["vx"], track["vy"]], axis=0)[1:]  # depth is too noisy to colour by
        axes.add_collection3d(Line3DCollection(segments, cmap=colours.cmap, norm=colours.norm, array=speed, linewidth=1.1))
    low, high = -3.5, 3.5
    wall = np.array([[low, low], [high, low], [high, high], [low, high]])
    axes.plot_trisurf(wall[:, 0], wall[:, 1], np.full(4, low), color=GREY, alpha=0.25, linewidth=0)
    axes.text(low, low, low - 0.25, "wall", color=GREY, fontsize=8.5)
    axes.set(xlim=(low, high), ylim=(low, high), zlim=(low, high), xlabel="x, mm", ylabel="z (depth), mm", zlabel="y, mm")
    axes.set_box_aspect((1, 1, 1), zoom=1.02)
    axes.view_init(elev=17, azim=-62)
    axes.set_title(f"{len(rows)} longest of {len(np.unique(tracks['particle']))} tracks", y=0.97)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.pane.set(facecolor="#fafbfc", edgecolor="#e6e8eb")
        axis._axinfo["grid"].update(color="#e6e8eb", linewidth=0.6)


def draw_amplitude(axes, profile, flow):
    height = np.linspace(0, profile["height_mm"].max() * 1.05, 300)
    axes.plot(1e3 * flow["wall_amplitude_mm"] * np.exp(-height / flow["stokes_layer_mm"]), height, color=THEORY, lw=1.6,
              label="Stokes' solution")
    axes.errorbar(1e3 * profile["amplitude_mm"], profile["height_mm"], xerr=2e3 * profile["amplitude_sigma_mm"], fmt="o",
                  ms=4.5, color=MEASURED, lw=1, label="measured, ±2 σ")
    axes.set_xscale("log")
    axes.set(xlim=(0.1, 1.6e3 * flow["wall_amplitude_mm"]), ylim=(0, 7), xlabel="amplitude of x, µm", ylabel="height above the wall, mm",
             title="Amplitude")
    axes.grid(True, which="major", lw=0.6)
    axes.legend(loc="lower left", fontsize=8.5, handlelength=1.4)


def draw_phase(axes, profile, flow):
    height = np.linspace(0, 7, 50)
    axes.plot(-height / flow["stokes_layer_mm"], height, color=THEORY, lw=1.6)
    amplitude = np.maximum(profile["amplitude_mm"], 1e-9)
    sigma = np.minimum(2 * profile["amplitude_sigma_mm"] / amplitude, np.pi)
    axes.errorbar(profile["phase_rad"], profile["height_mm"], xerr=sigma, fmt="o", ms=4.5, color=MEASURED, lw=1)
    axes.set(xlim=(-8.5 / flow["stokes_layer_mm"], 0.4), ylim=(0, 7), xlabel="phase against the wall, rad", ylabel="height above the wall, mm", title="Phase lag")
    axes.grid(True, lw=0.6)


def draw_velocity(axes, tracks, flow):
    """u(y) at about eight phases of the wall that were sampled: points of tracks, and the theory as a line."""
    omega = 2 * np.pi * flow["frequency_hz"]
    speed = omega * flow["wall_amplitude_mm"]
    seen = tracks[tracks["age"] > 0]
    height = seen["y"] - flow["wall_y_mm"]
    time = seen["t"] - 0.5 * np.median(np.diff(np.unique(tracks["t"])))  # a difference belongs to the middle of its frames
    phase = np.mod(omega * time, 2 * np.pi)
    y = np.linspace(0, 7, 300)
    sampled = np.unique(np.round(phase, 2))
    labels = []
    for i in range(8):
        centre = sampled[np.argmin(np.abs(np.mod(sampled - 2 * np.pi * i / 8 + np.pi, 2 * np.pi) - np.pi))]
        labels.append(f"{np.degrees(centre):.0f}°")
        near = np.abs(np.mod(phase - centre + np.pi, 2 * np.pi) - np.pi) < 0.06
        offset = 2.3 * speed * i
        axes.axvline(offset / speed, color="#e6e8eb", lw=0.8, zorder=0)
        axes.plot((offset + seen["vx"][near] - flow["drift_x_mm_s"]) / speed, height[near], ".", ms=2, color=MEASURED, alpha=0.3,
                  rasterized=True)
        layer = y / flow["stokes_layer_mm"]
        axes.plot((offset + speed * np.exp(-layer) * np.cos(centre - layer)) / speed, y, color=THEORY, lw=1.4)
    axes.set(ylim=(0, 7), xlim=(-1.5, 2.3 * 7 + 1.5), ylabel="height above the wall, mm", title="Velocity u(y) through one period")
    axes.set_xticks([2.3 * i for i in range(8)], labels)
    axes.set_xlabel(f"phase of the wall (its speed is at most U = {speed:.1f} mm/s)")


def errors_of(tracks, truth):
    """Measured minus true positions, µm, shape (3, n): true particles fully in view and the nearest measured one."""
    errors = []
    for frame in np.unique(tracks["frame"])[::5]:
        real = truth[(truth["frame"] == frame) & (truth["in_view"] == 1)]
        seen = tracks[tracks["frame"] == frame]
        if not len(real) or not len(seen):
            continue
        gap = np.stack([seen[c][:, None] - real[c][None, :] for c in "xyz"])
        nearest = np.argmin((gap[0] ** 2 + gap[1] ** 2) / 0.1**2 + gap[2] ** 2 / 0.5**2, axis=0)
        errors.append(gap[:, nearest, np.arange(len(real))])
    errors = 1e3 * np.concatenate(errors, axis=1)
    return errors[:, (np.abs(errors[:2]) < 100).all(axis=0) & (np.abs(errors[2]) < 500)]


def draw_errors(across, depth, errors):
    """Histograms of the position error: x and y in one panel, the depth z in another with its own scale."""
    for axes, rows, reach in ((across, (0, 1), 40), (depth, (2,), 500)):
        for row in rows:
            axes.hist(errors[row], bins=np.linspace(-reach, reach, 101), histtype="stepfilled", alpha=0.5,
                      color=(MEASURED, "#d4a017", THEORY)[row], label=f"{'xyz'[row]}: rms {np.sqrt(np.mean(errors[row]**2)):.0f} µm")
        axes.set(xlim=(-reach, reach), ylim=(0, 1.35 * axes.get_ylim()[1]), yticks=[])
        axes.spines["left"].set_visible(False)
        axes.legend(loc="upper left", fontsize=8.5, handlelength=0.8, borderaxespad=0)
    across.set_title("Error against the truth")
    depth.set_xlabel("measured − true, µm")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--output", type=Path, help="default: FOLDER/demo.png")
    options = parser.parse_args()
    tracks, profile, truth = (read_table(options.folder / name) for name in ("tracks.csv", "profile.csv", "truth.csv"))
    with open(options.folder / "scenario.toml", "rb") as file:
        flow = tomllib.load(file)["flow"]

    figure = plt.figure(figsize=(15.2, 8.6), facecolor="white")
    grid = figure.add_gridspec(2, 3, width_ratios=(1.75, 1, 1), height_ratios=(1, 1), left=0.005, right=0.98, top=0.9, bottom=0.075,
                               wspace=0.24, hspace=0.32)
    fastest = 2 * np.pi * flow["frequency_hz"] * flow["wall_amplitude_mm"]
    colours = plt.cm.ScalarMappable(plt.Normalize(0, 0.8 * fastest), "plasma_r")
    space = figure.add_subplot(grid[:, 0], projection="3d")
    draw_tracks(space, tracks, colours)
    bar = figure.colorbar(colours, ax=space, orientation="horizontal", shrink=0.42, aspect=34, pad=0.03)
    bar.set_label("speed across the view, mm/s")
    bar.outline.set_visible(False)
    draw_amplitude(figure.add_subplot(grid[0, 1]), profile, flow)
    draw_phase(figure.add_subplot(grid[0, 2]), profile, flow)
    bottom = grid[1, 1:].subgridspec(1, 2, width_ratios=(1.75, 1), wspace=0.16)
    draw_velocity(figure.add_subplot(bottom[0]), tracks, flow)
    panels = bottom[1].subgridspec(2, 1, hspace=0.35)
    draw_errors(figure.add_subplot(panels[0]), figure.add_subplot(panels[1]), errors_of(tracks, truth))
    frames = len(np.unique(tracks["frame"]))
    figure.suptitle(f"rapidptv: light-field particle tracking above a wall that oscillates at {flow['frequency_hz']:g} Hz "
                    f"({frames} frames, {len(tracks) / frames:.0f} particles each)", x=0.02, ha="left", fontsize=14, fontweight="bold")
    output = options.output or options.folder / "demo.png"
    try:
        figure.savefig(output, dpi=110)
    except OSError as error:
        sys.exit(f"plot_demo.py: {error}; choose another file with --output")
    print(output)


if __name__ == "__main__":
    main()
