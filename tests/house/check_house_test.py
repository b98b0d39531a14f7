#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The checker must find what it is there to find: every rule is broken once in a tree of its own."""
import tempfile
import unittest
from pathlib import Path

from check_house import check

HEAD = "// SPDX-License-Identifier: MIT\n// What it is for.\n"


class House(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        for header in ["core/frame.hpp", "acquisition/source.hpp", "acquisition/intake.hpp", "tracking/linker.hpp",
                       "proto/encode.hpp", "calibration/cameras/rig.hpp"]:
            self.write(header, HEAD)

    def write(self, name, text):
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def expect(self, *parts):
        """Exactly one violation, whose line holds all the parts."""
        found = check(self.root)
        self.assertEqual(len(found), 1, found)
        for part in parts:
            self.assertIn(part, found[0])

    def test_accepts_a_tree_in_order(self):
        self.write("tracking/linker.cpp", HEAD + '#include "tracking/linker.hpp"\n#include "core/frame.hpp"\n#include <cmath>\n')
        self.write("replay/replay_source.cpp", HEAD + '#include "acquisition/source.hpp"\n#include "proto/encode.hpp"\n')
        self.write("daemon/pipeline.cpp", HEAD + '#include "tracking/linker.hpp"\n#include "acquisition/intake.hpp"\n')
        self.write("viewer/gateway.cpp", HEAD + '#include "rapidptv.pb.h"\n')
        self.write("core/frame_pool.cpp", HEAD + "#include <cuda_runtime.h>\n")
        self.write("reconstruct/light_field_cuda.cu", HEAD + "__global__ void count();\n")
        self.write("reconstruct/light_field/ray_count_cuda.cu", HEAD + "__global__ void count();\n")
        self.write("reconstruct/cuda_probe.cu", HEAD + "#include <cuda_runtime.h>\n")
        self.write("core/long.cpp", HEAD + "\n" * 248)
        inner = "/" + "work/x"  # below another folder it is nobody's path
        self.write("README.md", f"Run `build{inner}` or $HOME{inner}.\n")
        self.write("build/dev/generated.cpp", "nobody reads this\n")
        self.assertEqual(check(self.root), [])

    def test_finds_a_stage_that_includes_another(self):
        self.write("tracking/linker.cpp", HEAD + '#include <vector>\n#include "acquisition/intake.hpp"\n')
        self.expect("tracking/linker.cpp:4:", "tracking/ may not include acquisition/intake.hpp")

    def test_finds_core_that_looks_up(self):
        self.write("core/frame.cpp", HEAD + "#include <calibration/cameras/rig.hpp>\n")
        self.expect("core/ may not include calibration/cameras/rig.hpp")

    def test_finds_replay_beyond_the_source_seam(self):
        self.write("replay/replay_source.cpp", HEAD + '#include "acquisition/intake.hpp"\n')
        self.expect("replay/ may not include acquisition/intake.hpp")

    def test_finds_a_viewer_that_knows_more_than_proto(self):
        self.write("viewer/gateway.cpp", HEAD + '#include "core/frame.hpp"\n')
        self.expect("viewer/ may not include core/frame.hpp")

    def test_finds_sources_that_include_tests(self):
        self.write("tests/core/maker.hpp", HEAD)
        self.write("daemon/main.cpp", HEAD + '#include "tests/core/maker.hpp"\n')
        self.expect("daemon/ may not include tests/core/maker.hpp")

    def test_finds_an_include_that_is_not_from_the_root(self):
        self.write("core/frame.cpp", HEAD + '#include "frame.hpp"\n')
        self.expect("core/frame.cpp:3:", "not a path from the root")

    def test_finds_cuda_outside_its_doors(self):
        self.write("reconstruct/light_field/light_field.cpp", HEAD + "#include <cuda_runtime.h>\n")
        self.expect("CUDA header", "light_field.cpp:3:")
        self.write("reconstruct/light_field/light_field.cpp", HEAD + "void f() { cudaMalloc (nullptr, 0); }\n")
        self.expect("CUDA code")
        self.write("reconstruct/light_field/light_field.cpp", HEAD)
        self.write("tracking/linker_cuda.cu", HEAD)
        self.expect("CUDA source outside")

    def test_finds_camera_libraries_outside_their_doors(self):
        self.write("replay/replay_source.cpp", HEAD + "#include <arv.h>\n")
        self.expect("Aravis header")
        self.write("replay/replay_source.cpp", HEAD + "#include <linux/videodev2.h>\n")
        self.expect("V4L2 header")

    def test_finds_files_that_are_too_long(self):
        self.write("core/clock.hpp", HEAD + "\n" * 99)
        self.expect("core/clock.hpp:101:", "at most 100")
        self.write("core/clock.hpp", HEAD)
        self.write("tests/core/clock_test.cpp", HEAD + "\n" * 249)
        self.expect("tests/core/clock_test.cpp:251:", "at most 250")

    def test_finds_a_missing_licence_line(self):
        for name in ["core/clock.hpp", "cmake/Find.cmake", "core/CMakeLists.txt", "docs/clients/tail.py"]:
            self.write(name, "\n")
            self.expect(name, "SPDX")
            (self.root / name).unlink()
        self.write("scripts/build", "#!/bin/sh\n")
        self.expect("scripts/build:1:", "SPDX")

    def test_finds_a_file_that_does_not_say_what_it_is_for(self):
        self.write("core/clock.hpp", "// SPDX-License-Identifier: MIT\n#pragma once\n")
        self.expect("core/clock.hpp:2:", "what the file is for")

    def test_finds_strange_folders_and_empty_names(self):
        self.write("gui/window.cpp", HEAD)
        self.expect("top-level folder 'gui'")
        (self.root / "gui/window.cpp").unlink()
        self.write("core/utils.hpp", HEAD)
        self.expect("core/utils.hpp:1:", "says nothing")
        (self.root / "core/utils.hpp").unlink()
        self.write("core/FramePool.cpp", HEAD)
        self.expect("snake_case")

    def test_finds_leftovers(self):
        for word in ["TO" + "DO", "FIX" + "ME"]:
            self.write("docs/guide.md", f"first line\n{word}: write this\n")
            self.expect("docs/guide.md:2:", word)

    def test_finds_paths_of_one_machine(self):
        for path in ["/wo" + "rk/data", "/ho" + "me/ada/x.png"]:
            self.write("docs/guide.md", f"open `{path}`\n")
            self.expect("docs/guide.md:1:", "one particular machine")


if __name__ == "__main__":
    unittest.main()
