#!/usr/bin/env python3
# GPL-2.0-or-later. A map that is computed in parts by the scripts of tools/cluster is the map of one computer.
"""usage: cluster_test.py PROGRAM SOURCE_FOLDER ssh|mpi|slurm

Compiles the demo arena, then runs the vis stage or the light stage with bounces in 1, 2 and 16 parts. In 4 parts, one
process is killed midway, and with ssh, a whole computer is switched off. Skipped (77) where the engine is not installed."""

import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from engines import ENGINES

LIGHT = ["-light", "-shbspx", "-fast", "-bounce", "2", "-bouncegrid"]
VIS = ["-vis", "-saveprt", "-flowrounds", "4"]  # the default in parts, other than on one computer

# A program that dies once in part 2: its process is killed while it computes, or, if MARK.off exists, it names the port of
# its computer and waits for somebody to switch that off.
DIES_ONCE = """#!/bin/sh
case " $* " in
*" -part 2/"*)
    if mkdir '{mark}' 2>/dev/null; then
        [ ! -e '{mark}.off' ] || {{ echo "${{SSH_CONNECTION##* }}" >'{mark}/port'; exec sleep 1000; }}
        '{program}' "$@" >/dev/null & child=$!
        kill -9 $child $$
    fi ;;
esac
exec '{program}' "$@"
"""


def compiled(program, source, folder):
    """The demo arena with portals in a game folder of its own. (path of the map in it, options for game files)."""
    game = folder / "demo"
    shutil.copytree(source / "tools/demo_data/demo_arena", game)
    data = ["-fs_basepath", str(folder), "-fs_basegame", "demo"]
    subprocess.run([program, *data, "-meta", "maps/demo.map"], cwd=game, stdout=subprocess.DEVNULL, check=True)
    return game, data


def check(engine, program, game, words, counts):
    """The stage of one computer, then the same in parts, each time from the same map."""
    bsp = game / "maps/demo.bsp"
    before = bsp.read_bytes()
    subprocess.run([program, *words, "maps/demo.bsp"], cwd=game, stdout=subprocess.DEVNULL, check=True)
    expected, after = bsp.read_bytes(), None
    assert expected != before, f"{words[0]} changes the map"
    for count, name, caller in counts:
        bsp.write_bytes(before)
        after = engine.stage(caller, count, [*words, "maps/demo.bsp"], game)
        assert bsp.read_bytes() == expected, f"{words[0]}, {name}: other bytes than on one computer\n{after}"
        assert not bsp.with_suffix(".parts").exists(), f"{words[0]}, {name}: parts are left"
        print(f"{words[0]}, {name}: same bytes", flush=True)


def dying(folder, program, name):
    """A program that dies once, and the folder that shows that it did."""
    mark, path = folder / f"{name}_died", folder / f"q3map2_{name}"
    path.write_text(DIES_ONCE.format(mark=mark, program=program))
    path.chmod(0o755)
    return path, mark


def main():
    program, source, name = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), sys.argv[3]
    with tempfile.TemporaryDirectory() as scratch, ENGINES[name](Path(scratch) / ".", source / "tools/cluster") as engine:
        folder = Path(scratch)
        game, data = compiled(program, source, folder)
        killed, mark = dying(folder, program, "killed")
        counts = [(count, f"{count} parts", program) for count in (1, 2, 16)]
        if name == "mpi":
            check(engine, program, game, [*VIS, *data], counts[1:2])
        else:  # a round takes seconds: no further rounds of many parts
            check(engine, program, game, [*VIS, "-fast", *data], counts)
            counts = []
        check(engine, program, game, [*LIGHT, *data], [*counts, (4, "4 parts, one killed", killed)])
        assert mark.exists(), "no part was killed"
        if name == "ssh":
            unplugged, mark = dying(folder, program, "unplugged")
            Path(f"{mark}.off").touch()
            plug = threading.Thread(target=engine.switch_off_computer, args=(mark / "port",), daemon=True)
            plug.start()
            check(engine, program, game, [*LIGHT, *data, "-bounce", "1"], [(4, "4 parts, one computer off", unplugged)])
            plug.join()


if __name__ == "__main__":
    main()
