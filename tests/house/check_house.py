#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The house rules that a machine can check: who includes whom, sizes, names, licence lines, leftovers.

usage: check_house.py ROOT    prints one line per violation, `file:line: what; next step`, and exits 1 when there is any.
"""
import re
import sys
from pathlib import Path

# folder -> what it may include besides itself. `daemon` joins the stages; `tests` may include everything but the viewer.
MAY_INCLUDE = {
    "core": set(),
    "calibration": {"core"},
    "acquisition": {"core"},
    "reconstruct": {"core", "calibration"},
    "tracking": {"core"},
    "proto": {"core"},
    "replay": {"core", "proto", "acquisition/source.hpp"},
    "simulation": {"core", "calibration", "acquisition/source.hpp"},
    "daemon": {"core", "calibration", "acquisition", "reconstruct", "tracking", "proto", "replay", "simulation"},
    "viewer": {"proto"},
    "tests": {"core", "calibration", "acquisition", "reconstruct", "tracking", "proto", "replay", "simulation", "daemon"},
}
FOLDERS = set(MAY_INCLUDE) | {"systemd", "docs", "cmake", "scripts"}
SKIPPED = {"build", "demo-out", "__pycache__", "node_modules"}

CUDA_PLACES = (r"reconstruct/(\w+/)*\w+_cuda\.cu|reconstruct/cuda_\w+\.(cu|hpp)|core/frame_pool\.\w+"
               r"|tests/cuda_host/.*|tests/.*_cuda_host_test\.cpp")

# Libraries that stay behind one door: header pattern -> where it may be included.
DOORS = [
    (r"cuda|cub/|thrust/", CUDA_PLACES, "CUDA"),
    (r"arv\.h|aravis", r"acquisition/aravis_\w+\.cpp|tests/acquisition/.*", "Aravis"),
    (r"linux/videodev2\.h", r"acquisition/v4l2_\w+\.cpp|tests/acquisition/.*", "V4L2"),
    (r"libudev\.h", r"acquisition/v4l2_watch\.cpp", "libudev"),
    (r"systemd/", r"daemon/supervisor\.cpp", "libsystemd"),
]
CUDA_CODE = re.compile(r"\bcuda[A-Z]\w*\s*\(|\b__global__\b|<<<")

LINES = {".hpp": 100, ".cpp": 250, ".cu": 250, ".py": 250}
CODE = {".hpp", ".cpp", ".cu", ".py", ".proto", ".cmake", ".sh"}
LEFTOVERS = re.compile(r"\b(" + "|".join(["TO" + "DO", "FIX" + "ME", "XX" + "X"]) + r")\b")
SOMEBODYS_PATH = re.compile(r"(?<![\w.$}/-])/(work|home|Users)/\w")
NAME = re.compile(r"[a-z0-9_]+(\.[a-z0-9_]+)*")
EMPTY_NAMES = {"utils", "util", "common", "helpers", "helper", "misc", "manager"}
INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)[">]')


def files_of(root):
    """Every file below root, tracked or not, except build outputs and hidden folders other than .ci."""
    for entry in sorted(root.iterdir()):
        if entry.name.startswith(".") and entry.name != ".ci":
            continue
        if entry.is_file():
            yield entry
        elif entry.is_dir() and entry.name not in SKIPPED:
            yield from files_of(entry)


def check_include(root, path, bracket, target):
    """Yields what is wrong with one #include of `path` (relative to root)."""
    name, folder = path.as_posix(), path.parts[0]
    for header, door, library in DOORS:
        if re.match(header, target) and not re.fullmatch(door, name):
            yield f"{library} header <{target}>; it may appear only in {door}"
    if bracket == "<" and target.split("/")[0] not in MAY_INCLUDE:
        return
    if target.endswith(".pb.h"):
        target = "proto/" + target.split("/")[-1]
    elif not (root / target).is_file():
        yield f"include '{target}' is not a path from the root of the tree; write folder/file.hpp"
        return
    other = target.split("/")[0]
    allowed = MAY_INCLUDE.get(folder, set())
    if other != folder and other not in allowed and target not in allowed:
        permitted = ", ".join(sorted(allowed | {folder}))
        yield f"{folder}/ may not include {target}; it may include: {permitted}"


def check_text(root, path, lines):
    """Yields (line number, what) for one text file."""
    name, folder, suffix = path.as_posix(), path.parts[0], path.suffix
    is_code = suffix in CODE or path.name == "CMakeLists.txt" or lines[0:1] and lines[0].startswith("#!")
    if is_code and not any("SPDX-License-Identifier: MIT" in line for line in lines[:3]):
        yield 1, "no 'SPDX-License-Identifier: MIT' in the first three lines; add it"
    elif suffix in {".hpp", ".cpp", ".cu"} and not (len(lines) > 1 and lines[1].startswith("// ")):
        yield 2, "no sentence after the licence line that says what the file is for; write one"
    if len(lines) > LINES.get(suffix, len(lines)):
        yield len(lines), f"{len(lines)} lines; {suffix} files have at most {LINES[suffix]}: split it"
    if suffix == ".cu" and not re.fullmatch(CUDA_PLACES, name):
        yield 1, "CUDA source outside reconstruct/*_cuda.cu; move it"
    for number, line in enumerate(lines, 1):
        if LEFTOVERS.search(line):
            yield number, f"leftover '{LEFTOVERS.search(line).group()}'; do it or file an issue"
        if SOMEBODYS_PATH.search(line):
            yield number, "a path of one particular machine; make it relative or an option"
        if suffix not in {".hpp", ".cpp", ".cu"}:
            continue
        if CUDA_CODE.search(line) and not re.fullmatch(CUDA_PLACES, name):
            yield number, f"CUDA code; it may appear only in {CUDA_PLACES}"
        if match := INCLUDE.match(line):
            for what in check_include(root, path, *match.groups()):
                yield number, what


def check_name(path):
    """Yields what is wrong with a file's place and name."""
    if len(path.parts) > 1 and path.parts[0] not in FOLDERS | {".ci"}:
        yield f"top-level folder '{path.parts[0]}'; the tree has: {', '.join(sorted(FOLDERS))}"
    if EMPTY_NAMES & {part.split(".")[0] for part in path.parts}:
        yield "a name that says nothing; name it after what it holds"
    if path.suffix in {".hpp", ".cpp", ".cu", ".py"} and not NAME.fullmatch(path.name):
        yield "file name is not snake_case; rename it"


def check(root):
    """All violations below root, as printable lines."""
    found = []
    for file in files_of(root):
        path = file.relative_to(root)
        found += [f"{path}:1: {what}" for what in check_name(path)]
        if "corpus" in path.parts or "data" in path.parts:
            continue
        try:
            lines = file.read_text(encoding="utf-8").splitlines()
        except UnicodeDecodeError:
            continue
        found += [f"{path}:{number}: {what}" for number, what in check_text(root, path, lines)]
    return found


def main():
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_dir():
        sys.exit(f"usage: check_house.py ROOT    (got {sys.argv[1:]}, which is no folder)")
    found = check(Path(sys.argv[1]).resolve())
    print("\n".join(found) if found else "the house is in order")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
