#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What nvcc makes of the CUDA sources, without a GPU: no spills, no stack, little shared memory, nothing fused.

usage: check_nvcc_output.py NVCC HOST_COMPILER ROOT SOURCE...    SOURCE is relative to ROOT. Prints one line per violation and exits 1 when
there is any; exits 77 when NVCC is empty.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FLAGS = ["-std=c++17", "-O3", "--fmad=false", "--expt-relaxed-constexpr"]
ARCHS = ["sm_75", "sm_90"]
SHARED_BYTES = 48 * 1024
# fmaf() is written out there, so that every backend gives the same integers.
WRITTEN_OUT = {"reconstruct/light_field/ray_count_cuda.cu": {"fma.rn.f32"}}


def compile_source(nvcc, host, root, source, arch, folder):
    """ptxas' report and the PTX of one source."""
    command = [nvcc, "-ccbin", host, *FLAGS, f"-arch={arch}", f"-I{root}", "-Xptxas", "-v", "-cubin", "--keep", f"--keep-dir={folder}"]
    done = subprocess.run([*command, str(root / source), "-o", f"{folder}/kernel.cubin"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return done.stderr, (Path(folder) / Path(source).name).with_suffix(".ptx").read_text()


def check_report(report):
    """(number of kernels, what is wrong with them)."""
    kernel, kernels, wrong = "?", 0, []
    for line in report.splitlines():
        if match := re.search(r"Compiling entry function '(\w+)'", line):
            kernel, kernels = match.group(1), kernels + 1
        if match := re.search(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", line):
            if any(int(count) > 0 for count in match.groups()):
                wrong.append(f"{kernel}: {match.group()}")
        if (match := re.search(r"(\d+) bytes smem", line)) and int(match.group(1)) > SHARED_BYTES:
            wrong.append(f"{kernel}: {match.group()}, more than every GPU has")
    return kernels, wrong


def check_ptx(source, ptx):
    """Arithmetic that a GPU may round in another way than the CPU."""
    fused = set(re.findall(r"\bfma\.[\w.]+", ptx)) - WRITTEN_OUT.get(source, set())
    free = set(re.findall(r"\b(?:mul|add|sub)\.f(?:32|64)\b|\b\w+\.(?:approx|full)[\w.]*|\b\w+(?:\.\w+)*\.ftz[\w.]*", ptx))
    wrong = []
    if fused:
        wrong.append(f"fused: {', '.join(sorted(fused))}; write fma() for all backends, or compile with --fmad=false")
    if free:
        wrong.append(f"rounded freely: {', '.join(sorted(free))}; compile with --fmad=false and without fast math")
    return wrong


def main():
    nvcc, host, root, sources = sys.argv[1], sys.argv[2], Path(sys.argv[3]), sys.argv[4:]
    if not nvcc:
        print("skipped: this build has no nvcc (RPTV_CUDA)")
        sys.exit(77)
    found, all_kernels = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for source in sources:
            for arch in ARCHS:
                report, ptx = compile_source(nvcc, host, root, source, arch, folder)
                kernels, wrong = check_report(report)
                all_kernels += kernels
                found += [f"{source} ({arch}): {what}" for what in wrong + check_ptx(source, ptx)]
    if all_kernels == 0:
        found.append("nvcc reports no kernel; the form of its report has changed")
    print("\n".join(found) if found else f"{all_kernels} kernels in order")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
